# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`foxglove_node`: shows the topics live in Foxglove or Lichtblick, over a WebSocket."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from trawl_ros.core.errors import MessageError, TrawlError
from trawl_ros.core.network import THIS_MACHINE, is_this_machine
from trawl_ros.messages.diagnostics import OK, Status
from trawl_ros.nodes.graph.source import with_history
from trawl_ros.nodes.runtime.incoming import installed, size_limit
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Names, Number, Text
from trawl_ros.nodes.runtime.qos import STREAM
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.topics import TOPICS, Topic

if TYPE_CHECKING:
    from trawl_ros.nodes.links.websocket import ViewerServer

LOOK_S = 0.05
"""Time after which a wish of a viewer is granted at the latest."""


class FoxgloveNode(TrawlNode):
    """Passes messages on to viewers, byte for byte, with the definitions of their types.

    All topics of the project are offered. One is listened to only while a viewer wants it; the
    last message of a latched one is given again when another viewer comes.
    """

    SPECS: ClassVar = (
        Text('host', THIS_MACHINE, 'Address of this machine at which viewers may connect. Whoever '
             f'reaches another one than {THIS_MACHINE} sees all topics.'),
        Number('port', 8765, 'TCP', 1, 65_535, 'Port at which viewers may connect.', whole=True),
        Names('origins', 'Origins of web pages that may connect; those of this machine always may.',
              ('https://app.foxglove.dev', 'file://')),
        Number('backlog', 200, 'messages', 10, 5000, 'Messages that wait for a slow viewer at '
               'most; older ones are given up.', whole=True),
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('foxglove_node', **kwargs)
        host, port = self.parameters['host'], int(self.parameters['port'])
        self._topics = {
            self.full_name(topic.name): topic
            for topic in TOPICS.values()
            # The package index has no tf2_msgs; a full installation has.
            if installed(topic.type)
        }
        self._simulated = bool(self.get_parameter('use_sim_time').value)
        self._server = self._listen_at(host, port)
        for name, topic in self._topics.items():
            self._server.offer(name, topic.type)
        self._heard: set[str] = set()
        self._latest: dict[str, tuple[bytes, int]] = {}
        self._passed: Counter[str] = Counter()
        log = self.get_logger()
        log.info(f'ws://{host}:{port} is open to viewers')
        if not is_this_machine(host):
            log.warning(f'parameter host: whoever reaches {host} sees all topics')
        self.every(LOOK_S, self._look)

    def statuses(self) -> list[Status]:
        """Return the status of the viewers."""
        viewers = self._server.viewers
        values = {
            'viewers': str(viewers),
            'topics wanted': str(len(self._heard)),
            'last refused': self._server.refused,
            'messages passed on': str(self._passed.total()),
            **{f'passed on {topic}': str(count) for topic, count in self._passed.items()},
        }
        message = f'{viewers} viewers' if viewers else 'waits for viewers'
        return [Status('viewers', OK, message, values)]

    def finish_work(self) -> None:
        """Let the viewers go."""
        self._server.close()

    def _listen_at(self, host: str, port: int) -> 'ViewerServer':
        try:
            from trawl_ros.nodes.links.websocket import ViewerServer
        except ImportError as reason:
            raise TrawlError(
                f'foxglove_node needs websockets and found no {reason.name}; expected the extra '
                "`view`: pip install 'trawl_ros[view]'"
            ) from reason
        backlog = int(self.parameters['backlog'])
        name = self.get_fully_qualified_name()
        origins = self.parameters['origins']
        return ViewerServer(host, port, name, backlog, origins, tells_time=self._simulated)

    def _look(self) -> None:
        """Listen to what viewers want, and to nothing else."""
        newly = {wish.topic for wish in self._server.new_requests() if wish.wanted}
        wanted = self._server.wanted
        for name in self._heard - wanted:
            self._leave(name)
            self._latest.pop(name, None)
        for name in newly & self._latest.keys():
            self._server.pass_on(name, *self._latest[name])
        for name in wanted - self._heard:
            self._hear(name)
        if self._simulated:
            self._server.tell_time(self.now())

    def _hear(self, name: str) -> None:
        topic = self._topics[name]
        self._heard.add(name)
        # /tf_static has a last message from each of several nodes.
        profile = with_history(STREAM) if topic.latched else STREAM
        self.listen_raw(name, topic.type, self._passer(name, topic), profile, overridable=False)

    def _leave(self, name: str) -> None:
        self.stop_listening(name)
        self._heard.remove(name)

    def _passer(self, name: str, topic: Topic) -> Callable[[bytes], None]:
        limit = size_limit(topic.type)

        def take(data: bytes) -> None:
            if len(data) > limit.value:
                raise MessageError(f'{name}: a message of {len(data)} bytes; expected {limit}')
            stamp = self.now()
            if topic.latched:
                self._latest[name] = data, stamp
            self._server.pass_on(name, data, stamp)
            self._passed[name] += 1

        return take


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(FoxgloveNode, args)
