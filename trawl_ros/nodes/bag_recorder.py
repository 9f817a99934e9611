"""`bag_recorder`: writes what is published into a bag, byte by byte."""

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from trawl_ros.bags.writer import BagWriter
from trawl_ros.errors import TrawlError
from trawl_ros.messages.cdr import STORE
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.messages.topics import (
    CLOCK,
    COMMANDS,
    ESTIMATES,
    INSTRUMENTS,
    TRUTH,
    Topic,
    absolute,
)
from trawl_ros.nodes.graph_checks import SYNC
from trawl_ros.nodes.node import TrawlNode
from trawl_ros.nodes.parameters import Names, Text
from trawl_ros.nodes.qos import CONSUMER, consumed
from trawl_ros.nodes.runtime import run
from trawl_ros.nodes.stamping import stamp_in
from trawl_ros.nodes.sync import Progress

ALL = 'all'
CONTRACT = (*TRUTH, *INSTRUMENTS, *ESTIMATES, *COMMANDS)
NEVER = (CLOCK.name, '/rosout', '/parameter_events')
SECOND_S = 1.0


class BagRecorder(TrawlNode):
    """Records the project's topics, those that are named, or all.

    A message is logged at the stamp of its header, so that a bag replays as things happened
    and not as they arrived; without a header at the time of the node's clock. ``/clock`` is
    left out: whoever replays the bag makes a new one.
    """

    SPECS: ClassVar = (
        Text('output', '', 'Folder of the bag; nothing may be there yet.', needed=True),
        Names('topics', "Topics to record, or 'all'; by default those of the project."),
        Text('log_time', 'header', 'Whether messages are logged at the stamp of their header or '
             'at the time of the node\'s clock.', choices=('header', 'clock')),
    )  # fmt: skip
    DRAINS: ClassVar = True

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('bag_recorder', **kwargs)
        self._by_header = self.parameters['log_time'] == 'header'
        wanted = self.parameters['topics']
        self._everything = wanted == (ALL,)
        self._latest: dict[str, int] = {}
        self._jumps = 0
        self._unknown: set[str] = set()
        self._dirty = False
        namespace = self.get_namespace()
        self._bag = BagWriter(self.parameters['output'], namespace=namespace)
        self._progress = Progress(self)
        # What paces the progress: truth comes at every instant, markers now and then.
        self._pacing = {
            absolute(topic.name, namespace): topic.name for topic in TRUTH if topic.rate != 1.0
        }
        self._timed = {absolute(topic.name, namespace) for topic in (*TRUTH, *INSTRUMENTS)}
        self._wanted = {self.full_name(name) for name in wanted} if not self._everything else set()
        for name, topic in self._contract().items():
            self._record(name, topic.type, consumed(topic))
        self.every(SECOND_S, self._every_second)

    def statuses(self) -> list[Status]:
        """What is in the bag."""
        counts = self._bag.counts
        values = {
            'bag': str(self._bag.path),
            'messages': str(sum(counts.values())),
            'recorded until': f'{self._progress.stamp / 1e9:.1f}',
            **{f'recorded {topic}': str(count) for topic, count in counts.items()},
        }
        problems = []
        if self._jumps:
            problems.append(
                f'time was set back {self._jumps} times, so tows lie over each other in the bag; '
                'expected one tow per bag'
            )
        if self._unknown:
            problems.append(f'of unknown type and not recorded: {", ".join(sorted(self._unknown))}')
        message = '; '.join(problems) or 'recording'
        return [Status('bag', WARN if problems else OK, message, values)]

    def finish_work(self) -> None:
        """Finish the bag."""
        self._bag.close()
        total = sum(self._bag.counts.values())
        self.get_logger().info(f'{self._bag.path}: {total} messages')

    def _contract(self) -> dict[str, Topic]:
        """The project's topics that are wanted, by full name."""
        named = {absolute(topic.name, self.get_namespace()): topic for topic in CONTRACT}
        chosen = self._everything or not self._wanted
        return {name: topic for name, topic in named.items() if chosen or name in self._wanted}

    def _record(self, topic: str, type_name: str, profile: QoSProfile) -> None:
        self.listen_raw(topic, type_name, self._taker(topic, type_name), profile)

    def _taker(self, topic: str, type_name: str) -> Callable[[bytes], None]:
        timed = topic in self._timed

        def take(data: bytes) -> None:
            stamp = stamp_in(type_name, data)
            logged = self.now() if stamp is None or not self._by_header else stamp
            self._bag.write(topic, type_name, data, logged)
            self._dirty = True
            if timed and stamp is not None:
                self._follow(topic, stamp)

        return take

    def _follow(self, topic: str, stamp: int) -> None:
        if stamp < self._latest.get(topic, stamp):
            # The others follow; one jump is not to be counted once per topic.
            self._jumps += 1
            self._latest.clear()
        self._latest[topic] = stamp
        if topic in self._pacing:
            heard = self._latest
            self._progress.done(min(heard[name] for name in self._pacing if name in heard))
        elif not any(name in self._latest for name in self._pacing):
            self._progress.done(stamp)

    def _every_second(self) -> None:
        if self._dirty:
            self._bag.flush()
            self._dirty = False
        if self._everything or self._wanted - set(self._listeners):
            self._look_for_others()

    def _look_for_others(self) -> None:
        never = {*NEVER, self.full_name(SYNC)}
        for topic, types in self.get_topic_names_and_types():
            wanted = self._everything or topic in self._wanted
            if not wanted or topic in self._listeners or topic in never:
                continue
            if len(types) != 1 or types[0] not in STORE.types:
                self._unknown.add(topic)
                continue
            try:
                self._record(topic, types[0], self._offered(topic))
            except TrawlError:
                self._unknown.add(topic)
            else:
                self._unknown.discard(topic)

    def _offered(self, topic: str) -> QoSProfile:
        """A profile that matches all who publish a topic that is not the project's."""
        infos = self.get_publishers_info_by_topic(topic)
        profiles = [info.qos_profile for info in infos]
        found = QoSProfile(depth=CONSUMER.depth)
        found.reliability = ReliabilityPolicy.RELIABLE
        found.durability = DurabilityPolicy.TRANSIENT_LOCAL
        if any(profile.reliability != found.reliability for profile in profiles):
            found.reliability = ReliabilityPolicy.BEST_EFFORT
        if any(profile.durability != found.durability for profile in profiles):
            found.durability = DurabilityPolicy.VOLATILE
        return found


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(BagRecorder, args)
