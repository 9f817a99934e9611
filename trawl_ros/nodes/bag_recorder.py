# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`bag_recorder`: writes what is published into a bag, byte by byte."""

from collections.abc import Callable, Iterator, Sequence
from time import monotonic_ns
from typing import Any, ClassVar, NamedTuple

from rclpy.qos import QoSProfile

from trawl_ros.bags.storage.mcap_output import COMPRESSIONS
from trawl_ros.bags.storage.qos import dump_profiles
from trawl_ros.bags.storage.stored import describe
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.stamps import FAR_NS, Leaps, impossible_time
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import STORE, type_hash
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.messages.stamps import header_stamp
from trawl_ros.nodes.graph.source import matching, with_history
from trawl_ros.nodes.playback.recorded_qos import ALL, TopicChoice, profiles_of
from trawl_ros.nodes.runtime.connected_node import DIAGNOSTICS
from trawl_ros.nodes.runtime.credit import ConsumerProgress
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Names, Number, Text
from trawl_ros.nodes.runtime.qos import recorder_profile
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.topics import CLOCK, CONTRACT, INSTRUMENTS, SYNC, TRUTH, absolute

LONGEST_WAIT_NS = 2_000_000_000
"""Wall time (ns) for which messages without a usable stamp wait for one that has."""

MOST_WAITING = 1000
"""Messages that wait for it at most."""


class LogTimes:
    """Choice of log times.

    Stamps and the time of receipt differ by little, or by about the same: where a bag of last
    year is recorded again, by a year. A stamp that differs otherwise, as that of a driver that
    never stamps, is not used; its message is logged at the time of receipt, moved by what others
    differ by.

    Attributes
    ----------
    replaced
        Messages whose stamp was not used.
    """

    def __init__(self) -> None:
        self.replaced = 0
        self._offsets: Leaps[tuple[int, int | None, Any]] = Leaps(FAR_NS)
        self._offset: int | None = None
        self._waiting: list[tuple[int, int | None, Any]] = []
        self._since: int | None = None

    def take(self, stamp: int | None, received: int, message: Any) -> list[tuple[int, Any]]:
        """Take the next message, and give those that can be written, each with its log time.

        Parameters
        ----------
        stamp
            Of its header, ns; None without one.
        received
            Time of receipt, ns.
        message
            Anything that is to be had back.
        """
        if stamp is None or stamp == 0 or impossible_time(stamp):
            self._waiting.append((received, stamp, message))
            ready = []
        else:
            entry = (received, stamp, message)
            believed, false = self._offsets.take(stamp - received, entry)
            self._waiting += false
            ready = [(own, waited) for _, own, waited in believed]
            self._offset = stamp - received if believed else self._offset
        known = self._offset is not None
        return [*ready, *(self._release() if known or len(self._waiting) > MOST_WAITING else ())]

    def give_up(self, now: int, *, whole: bool = False) -> list[tuple[int, Any]]:
        """Give the messages that have waited for too long at a monotonic time (ns), or all."""
        if whole:
            self._waiting += self._offsets.give_up()
        if not self._waiting:
            self._since = None
            return []
        self._since = now if self._since is None else self._since
        return list(self._release()) if whole or now - self._since > LONGEST_WAIT_NS else []

    def _release(self) -> Iterator[tuple[int, Any]]:
        offset = self._offset or 0
        # Latency is no other scale.
        offset = offset if abs(offset) > FAR_NS else 0
        for received, stamp, message in self._waiting:
            log_time = max(received + offset, 0)
            if stamp is not None and 0 <= log_time - stamp <= FAR_NS:
                # The first instant of a simulation is 0.
                log_time = stamp
            elif stamp is not None:
                self.replaced += 1
            yield log_time, message
        self._waiting.clear()


NEVER = (CLOCK.name, '/rosout', '/parameter_events')

FLUSH_S = 0.4
"""A bag is behind by less than a second, so that much remains for a machine that is fully loaded.

Chunks that end early compress less well: at the pace of a ship a bag takes a tenth more than with
0.8 s.
"""

NO_HASH = 'INVALID'


class _Entry(NamedTuple):
    """Message to be written: full topic name, type, bytes, and stamp (ns) by which time goes on."""

    topic: str
    type: str
    data: bytes
    stamp: int | None


class BagRecorder(TrawlNode):
    """Records the project's topics, those that are chosen, or all.

    A message is logged at the stamp of its header, so that a bag replays as things happened
    and not as they arrived; without a header, or with a stamp that cannot be, at the time of
    receipt, which is counted. ``/clock`` is left out: whoever replays the bag makes a new one.
    """

    SPECS: ClassVar = (
        Text('output', '', 'Folder of the bag; where it exists, a number is put behind its '
             'name.', needed=True),
        Names('topics', "Topics to record, or 'all'; by default those of the project."),
        Text('regex', '', 'Topics are recorded too whose full name has a match of this regular '
             'expression.'),
        Text('exclude_regex', '', 'Topics are left out whose full name has a match of this '
             'regular expression.'),
        Text('log_time', 'header', 'Whether messages are logged at the stamp of their header or '
             'at the time of the node\'s clock.', choices=('header', 'clock')),
        Text('compression', 'zstd', 'Of the chunks of messages.', choices=tuple(COMPRESSIONS)),
        Number('max_bag_size', 0, 'bytes', 0, 2**53, 'Size at which a file of the bag is followed '
               'by a next one; 0 is never.', whole=True),
        Number('max_bag_duration', 0.0, 's', 0.0, 1e7, 'Log time after which a file of the bag is '
               'followed by a next one; 0 is never, and the index of a day in one file takes '
               'some hundred megabytes of memory.'),
    )  # fmt: skip
    DRAINS: ClassVar = True

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('bag_recorder', **kwargs)
        self._by_header = self.parameters['log_time'] == 'header'
        self._log_times = LogTimes()
        self._latest: dict[str, int] = {}
        self._jumps = 0
        self._unknown: set[str] = set()
        self._redefined: set[str] = set()
        self._dirty = False
        namespace = self.get_namespace()
        project = {absolute(topic.name, namespace): topic for topic in CONTRACT}
        named = self.parameters['topics']
        self._choice = TopicChoice(
            project,
            {ALL} if named == (ALL,) else {self.full_name(name) for name in named},
            {name: self.parameters[name] for name in ('regex', 'exclude_regex')},
            {*NEVER, self.full_name(SYNC)},
        )
        self._bag = BagWriter(
            self.new_path('output') or '',
            namespace=namespace,
            compression=self.parameters['compression'],
            max_file_bytes=self.parameters['max_bag_size'],
            max_file_ns=round(self.parameters['max_bag_duration'] * SECOND),
        )
        # Started again it may hear readings before truth, of which the rest went by meanwhile: the
        # simulation would wait for it, and it for more truth.
        self._progress = ConsumerProgress(self, idle=lambda: not self._hears_truth())
        # Topics that pace the progress: truth comes at every instant, markers now and then.
        self._pacing = {
            absolute(topic.name, namespace): topic.name for topic in TRUTH if topic.rate != 1.0
        }
        self._timed = {absolute(topic.name, namespace) for topic in (*TRUTH, *INSTRUMENTS)}
        self._recorded: set[str] = set()
        for name, topic in project.items():
            if name in self._choice:
                # Of latched topics, too, all that comes is wanted, and not the last alone.
                profile = recorder_profile(topic.type, topic.rate)
                self._record(name, topic.type, with_history(profile) if topic.latched else profile)
        self.every(FLUSH_S, self._look_after)

    def statuses(self) -> list[Status]:
        """Return the status of the bag."""
        counts = self._bag.counts
        values = {
            'bag': str(self._bag.path),
            'messages': str(sum(counts.values())),
            'files': str(len(self._bag.files)),
            'recorded until': f'{self._progress.stamp / 1e9:.1f}',
            **{f'recorded {topic}': str(count) for topic, count in counts.items()},
        }
        problems = []
        if replaced := self._log_times.replaced:
            problems.append(
                f'{replaced} messages have a stamp that cannot be, and are logged at the time of '
                'receipt'
            )
        if self._jumps:
            problems.append(
                f'time was set back {self._jumps} times, so tows lie over each other in the bag; '
                'expected one tow per bag'
            )
        if self._unknown:
            problems.append(f'of unknown type and not recorded: {", ".join(sorted(self._unknown))}')
        if self._redefined:
            problems.append(
                'published with another definition of the type than the bag carries: '
                f'{", ".join(sorted(self._redefined))}'
            )
        message = '; '.join(problems) or 'recording'
        return [Status('bag', WARN if problems else OK, message, values)]

    def finish_work(self) -> None:
        """Finish the bag."""
        self._write(self._log_times.give_up(monotonic_ns(), whole=True))
        self._bag.close()
        total = sum(self._bag.counts.values())
        self.get_logger().info(f'{self._bag.path}: {total} messages')

    def _record(self, topic: str, type_name: str, profile: QoSProfile) -> None:
        self.listen_raw(topic, type_name, self._taker(topic, type_name), profile)
        self._recorded.add(topic)

    def _taker(self, topic: str, type_name: str) -> Callable[[bytes], None]:
        timed = topic in self._timed
        # A node that reports of itself may go by another clock than the tow.
        by_header = self._by_header and topic != DIAGNOSTICS

        def take(data: bytes) -> None:
            stamp = header_stamp(type_name, data)
            if not self._bag.declared(topic):
                self._declare(topic, type_name)
            entry = _Entry(topic, type_name, data, stamp if timed else None)
            if self._by_header:
                used = stamp if by_header else None
                self._write(self._log_times.take(used, self.now(), entry))
            else:
                self._write([(self.now(), entry)])

        return take

    def _write(self, timed: Sequence[tuple[int, '_Entry']]) -> None:
        for log_time, entry in timed:
            self._bag.write(entry.topic, entry.type, entry.data, log_time)
            self._dirty = True
            if entry.stamp == log_time:
                self._follow(entry.topic, entry.stamp)

    def _declare(self, topic: str, type_name: str) -> None:
        """Fix the definition of a topic, by its publishers when the first message comes."""
        publishers = self.get_publishers_info_by_topic(topic)
        self._bag.declare(topic, describe(type_name, dump_profiles(profiles_of(publishers))))
        hashes = {str(publisher.topic_type_hash) for publisher in publishers}
        if hashes - {type_hash(type_name), NO_HASH}:
            self._redefined.add(topic)

    def _follow(self, topic: str, stamp: int) -> None:
        if stamp < self._latest.get(topic, stamp):
            # The others follow; one jump is not to be counted once per topic.
            self._jumps += 1
            self._latest.clear()
        self._latest[topic] = stamp
        if topic in self._pacing:
            heard = self._latest
            self._progress.done(min(heard[name] for name in self._pacing if name in heard))
        elif not self._hears_truth():
            # A reading may be older than one that came before it.
            self._progress.done(max(self._latest.values()))

    def _hears_truth(self) -> bool:
        return any(name in self._latest for name in self._pacing)

    def _look_after(self) -> None:
        self._write(self._log_times.give_up(monotonic_ns()))
        if self._dirty:
            self._bag.flush()
            self._dirty = False
        self._look_for_others()
        self.match_publishers()

    def _look_for_others(self) -> None:
        for topic, types in self.get_topic_names_and_types():
            if topic in self._recorded or topic not in self._choice:
                continue
            publishers = self.get_publishers_info_by_topic(topic)
            if not publishers:
                continue
            try:
                if len(types) != 1 or types[0] not in STORE.types:
                    raise TrawlError(f'{topic}: types {", ".join(types)}')
                asked = with_history(recorder_profile(types[0]))
                self._record(topic, types[0], matching(publishers, asked))
            except TrawlError:
                self._unknown.add(topic)
            else:
                self._unknown.discard(topic)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(BagRecorder, args)
