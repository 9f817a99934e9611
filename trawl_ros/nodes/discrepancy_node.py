"""`discrepancy_node`: says while a tow goes on where model and measurement disagree, and why."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar

from std_srvs.srv import Trigger

from trawl_ros.diagnosis.diagnosis import Diagnosis, diagnose, unread
from trawl_ros.diagnosis.words import headline
from trawl_ros.diagnosis.writing import write_diagnosis
from trawl_ros.files import empty_folder
from trawl_ros.gear.load import load_gear
from trawl_ros.identification.channels import CHANNELS
from trawl_ros.identification.from_gear import finder_for
from trawl_ros.identification.window_records import RejectedWindow, SteadyWindow, WindowOptions
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status, diagnostic_array
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.nodes.finding_status import CALM, finding_statuses
from trawl_ros.nodes.node import TrawlNode
from trawl_ros.nodes.parameters import Number, Text
from trawl_ros.nodes.qos import CONSUMER
from trawl_ros.nodes.rewinding import Rewinding
from trawl_ros.nodes.runtime import run
from trawl_ros.nodes.sync import Progress
from trawl_ros.nodes.watching import WatchingThread

FINDINGS = 'discrepancy/findings'
FINISH = 'discrepancy/finish'

SAMPLES = tuple(dict.fromkeys(channel.topic for channel in CHANNELS.values()))
"""Topics that feed a channel."""


class DiscrepancyNode(TrawlNode):
    """Diagnoses all steady windows so far after each new one.

    What is found goes out on ``discrepancy/findings`` and as a warning on ``/diagnostics``.
    ``discrepancy/finish``, or the signal to end, writes the report of all tows it has heard.
    """

    SPECS: ClassVar = (
        Text('gear', 'kaifuha', 'Gear file, or the name of one that comes with the package: the '
             'gear as it is believed.'),
        Text('output', '', 'Folder for the report, new or empty; none if empty.'),
        Number('baseline_tows', 0, 'tows', 0, 100, 'So many of the first tows are of a gear in '
               'order.', whole=True),
        Number('settle_s', WindowOptions.settle_s, 's', 0.0, 3600.0, 'Least time the gear is '
               'given after each change of warp length, speed or heading.'),
        Number('settle_passages', WindowOptions.settle_passages, 'times', 0.0, 10.0, 'How often '
               'the ship passes the length of her gear before it counts as settled.'),
        Number('window_s', WindowOptions.window_s, 's', 20.0, 3600.0, 'Length of a steady window.'),
    )  # fmt: skip
    DRAINS: ClassVar = True

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('discrepancy_node', **kwargs)
        parameters = self.parameters
        output = parameters['output']
        self._folder = empty_folder(Path(output), force=False) if output else None
        self._gear = load_gear(parameters['gear'])
        options = WindowOptions(
            settle_s=parameters['settle_s'],
            settle_passages=parameters['settle_passages'],
            window_s=parameters['window_s'],
        )
        self._finder = finder_for(self._gear, options)
        self._windows: list[SteadyWindow] = []
        self._found: Diagnosis | None = None
        self._trouble = ''
        self._stamp = 0
        self._rewinding = Rewinding()
        self.advertise(FINDINGS)
        self._watching = WatchingThread(self._look_at, self._told)
        self._progress = Progress(self, idle=lambda: self._watching.idle)
        for topic in SAMPLES:
            self.listen(topic, self._feeder(topic), CONSUMER)
        self.create_service(Trigger, FINISH, self._finish)
        self._watching.start()

    def statuses(self) -> list[Status]:
        """What was found, or why nothing is known yet."""
        found = self._found
        values = {'windows': str(len(self._windows))}
        if self._trouble:
            return [Status('discrepancy', ERROR, self._trouble, values)]
        if found is None:
            return [Status('discrepancy', OK, 'waiting for a steady window', values)]
        level = OK if found.verdict in CALM else WARN
        return [Status('discrepancy', level, headline(found), values | {'verdict': found.verdict})]

    def finish_work(self) -> None:
        """Decide the windows that are left, diagnose, and write the report."""
        self._take(self._finder.finish())
        self._watching.stop()
        self.get_logger().info(self._write())

    def _feeder(self, topic: str) -> Callable[[Any], None]:
        def feed(message: Any) -> None:
            anew, samples = self._rewinding.take(to_sample(topic, message))
            if anew:
                self._finder.reset()
                self._windows, self._stamp = [], 0
                self.get_logger().warning('stamps of the winch went back; all begins anew')
            for sample in samples:
                self._stamp = max(self._stamp, sample.stamp)
                self._take(self._finder.feed(sample))
                self._progress.done(self._stamp)

        return feed

    def _take(self, decided: Sequence[SteadyWindow | RejectedWindow]) -> None:
        steady = [window for window in decided if isinstance(window, SteadyWindow)]
        if steady:
            self._windows += steady
            self._watching.look_at(tuple(self._windows))

    def _look_at(self, windows: tuple[SteadyWindow, ...]) -> Diagnosis:
        tows = [f'tow {number + 1}' for number in range(1 + max(w.tow for w in windows))]
        baseline = frozenset(range(self.parameters['baseline_tows']))
        return diagnose(self._gear, windows, tows, baseline)

    def _told(self, found: Diagnosis | None, trouble: str) -> None:
        self._trouble = trouble
        if found is None:
            return
        self._found = found
        self.send(FINDINGS, diagnostic_array(self._stamp, finding_statuses(found)))

    def _write(self) -> str:
        found = self._found
        if found is None:
            found = unread(self._gear, (), 'no steady window has been heard')
        if self._folder is None:
            return f'{found.verdict}: {headline(found)}'
        write_diagnosis(found, (), self._folder)
        return f'{self._folder}: {found.verdict}: {headline(found)}'

    def _finish(self, request: Any, response: Any) -> Any:
        self._take(self._finder.finish())
        response.success = self._watching.idle
        response.message = (
            self._write() if self._watching.idle else 'the newest windows are being diagnosed'
        )
        return response


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(DiscrepancyNode, args)
