# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`view_node`: shows the running graph in Rerun, in a window, on a web page or as a recording."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from trawl_ros.core.network import THIS_MACHINE, is_this_machine
from trawl_ros.gear.load import load_gear
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Number, Text
from trawl_ros.nodes.runtime.qos import offered
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.topics import find_topic
from trawl_ros.view.reading import TOPICS, TowReader

if TYPE_CHECKING:
    from trawl_ros.view.live import LiveView

LOOK_S = 0.5


def open_view(parameters: Any, output: Path | None) -> 'LiveView':
    """Open what shows the records.

    Raises
    ------
    TrawlError
        If Rerun is not installed, or the viewer cannot be opened.
    """
    from trawl_ros.view.live import LiveView

    return LiveView(
        TOPICS,
        parameters['viewer'],
        bind=parameters['host'],
        port=int(parameters['port']) or None,
        memory_mb=int(parameters['memory_mb']),
        output=output,
    )


class ViewNode(TrawlNode):
    """Shows what the project's topics say on one time line, that of their stamps.

    Nobody waits for it: what it does not take in time is given up and counted.
    """

    SPECS: ClassVar = (
        Text('viewer', 'window', 'A window, a web page of this machine, or neither.',
             choices=('window', 'web', 'headless')),
        Text('output', '', 'File (.rrd) to be recorded in place of a viewer; where it exists, a '
             'number is put behind its name.'),
        Text('host', THIS_MACHINE, 'Address at which the viewer listens. Whoever reaches another '
             f'one than {THIS_MACHINE} sees the tow and can add to it.'),
        Number('port', 0, 'TCP', 0, 65_534, 'Of the web page, whose data are at the next one; 0 '
               'takes free ones.', whole=True),
        Number('memory_mb', 2000, 'MB', 100, 1_000_000, 'Memory of the viewer; beyond it the '
               'oldest data are given up.', whole=True),
        Text('gear', 'kaifuha', 'Gear file, or the name of one that comes with the package: its '
             'water turns pressure into depth, and its sizes draw the gear where no markers do.'),
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('view_node', **kwargs)
        self._reader = TowReader(load_gear(self.parameters['gear']))
        self._view = open_view(self.parameters, self.new_path('output', suffix='.rrd'))
        if self._view.page:
            self.get_logger().info(f'{self._view.page} shows it')
        if not is_this_machine(host := self.parameters['host']):
            self.get_logger().warning(f'parameter host: whoever reaches {host} sees the tow')
        for topic in TOPICS:
            self._show(topic)
        self.every(LOOK_S, self._look)

    def statuses(self) -> list[Status]:
        """Return the status of the view."""
        view = self._view
        values = {
            'records shown': str(view.shown),
            'records waiting': str(view.waiting),
            'records given up': str(view.lost),
        }
        problems = [view.trouble] if view.trouble else []
        if view.lost:
            problems.append(f'{view.lost} records were given up, since the viewer is slow')
        message = '; '.join(problems) or 'shows what comes'
        return [Status('view', WARN if problems else OK, message, values)]

    def finish_work(self) -> None:
        """Show what waits, and close the viewer."""
        self._view.close()

    def _show(self, topic: str) -> None:
        def take(message: Any) -> None:
            for record in self._reader.take(topic, message):
                self._view.put(record)

        self.listen(topic, take, offered(find_topic(topic, self.get_namespace())))

    def _look(self) -> None:
        if self._view.closed:
            self.end(0, 'the viewer was closed')
        elif self._view.trouble:
            self.end(1, self._view.trouble)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(ViewNode, args)
