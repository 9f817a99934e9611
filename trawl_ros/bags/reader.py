# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reader of bags in the order of log times: folders, single MCAP files, and damaged ones.

Everything readable is used; `Bag.problems` lists the faults of the rest.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rosbags.interfaces import Qos
from rosbags.typesys.store import Typestore

from trawl_ros.bags.sources import BagFacts, open_source
from trawl_ros.bags.storage.decoding import BagTypes, Decoder
from trawl_ros.bags.storage.qos import parse_profiles
from trawl_ros.bags.storage.stored import Definition, RawMessage
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.foreign import reading
from trawl_ros.core.time import SECOND
from trawl_ros.records.topics import NAMESPACE, find_topic


@dataclass(frozen=True)
class Received:
    """Decoded message of a bag.

    Attributes
    ----------
    topic, type
        Full topic name and message type.
    log_time
        Time of recording, ns.
    message
        The decoded message.
    channel
        Number of the channel.
    sequence
        Number of arrival, 0 if unknown.
    """

    topic: str
    type: str
    log_time: int
    message: Any
    channel: int = 0
    sequence: int = 0


@dataclass(frozen=True)
class TopicSummary:
    """Summary of a topic: number, type and bytes of its messages, first and last time (ns)."""

    topic: str
    type: str
    count: int
    bytes: int
    start: int
    end: int

    @property
    def rate(self) -> float | None:
        """Mean rate, Hz; None where it is undefined."""
        span = self.end - self.start
        return (self.count - 1) * SECOND / span if span > 0 else None


@dataclass(frozen=True)
class BagSummary:
    """Summary of a bag; ``start`` and ``end`` are log times in ns, None without messages."""

    path: Path
    topics: tuple[TopicSummary, ...]
    count: int
    start: int | None
    end: int | None
    facts: BagFacts
    problems: tuple[str, ...]


class Bag:
    """Bag opened for reading.

    Parameters
    ----------
    path
        A bag's folder, or one MCAP file.
    namespace
        Of the project's topics in this bag.
    lenient
        True to live with metadata and content that disagree, and with topics of the project
        whose type or definition is wrong, and say so in `problems`.

    Attributes
    ----------
    topics : dict
        Type by full topic name.
    problems : list of str
        Faults found so far, one sentence each; complete once messages were read.
    custom_data : dict
        Text by key from ``metadata.yaml``.

    Raises
    ------
    BagError
        If there is no bag, or, unless ``lenient``, its metadata and its content disagree.

    Examples
    --------
    >>> import trawl_ros
    >>> bag = trawl_ros.Bag('bags/sea_trial')
    >>> bag.topics['/trawl/door/spread']
    'sensor_msgs/msg/Range'
    >>> bag.problems
    []
    """

    def __init__(
        self, path: str | Path, *, namespace: str = NAMESPACE, lenient: bool = False
    ) -> None:
        self.path = Path(path)
        self.problems: list[str] = []
        self._namespace = namespace
        self._lenient = lenient
        with reading(self.path, BagError):
            self._source = open_source(self.path, self._report, lenient=lenient)
        # Gathered once: there may be thousands.
        self._definitions = self._source.definitions
        self.topics = {topic: definition.type for topic, definition in self._definitions.items()}
        self.custom_data = self._source.custom_data
        self._types = BagTypes()
        self._decoders_made: dict[str, Decoder] = {}

    @property
    def facts(self) -> BagFacts:
        """Facts on the bag: storage, version, compression, sizes."""
        return self._source.facts

    @property
    def damaged_chunks(self) -> int:
        """Number of chunks with a wrong checksum or content; complete once all was read."""
        return sum(file.damaged_chunks for file in self._source.files)

    @property
    def files_without_index(self) -> list[Path]:
        """Files without index, which are scanned for messages."""
        return [file.path for file in self._source.files if not file.indexed]

    def metadata_faults(self, counts: Mapping[str, int], span: tuple[int, int] | None) -> list[str]:
        """Compare ``metadata.yaml`` with everything that was read; see `metadata_faults`."""
        return self._source.metadata_faults(counts, span)

    def definitions(self) -> dict[str, Definition]:
        """Return the definitions by full topic name."""
        return self._definitions

    def offered(self) -> dict[str, tuple[Qos, ...]]:
        """Return by full topic name the QoS that its publishers offered; empty where unknown.

        Profiles that cannot be understood are said in `problems` and count as unknown.
        """
        by_topic: dict[str, tuple[Qos, ...]] = {}
        for topic, definition in self.definitions().items():
            try:
                by_topic[topic] = parse_profiles(topic, definition.qos)
            except BagError as reason:
                self._report(f'{self.path}: {reason}')
                by_topic[topic] = ()
        return by_topic

    def raw(self, topics: Collection[str] | None = None) -> Iterator[RawMessage]:
        """Yield messages undecoded, of all topics or of those named in full.

        Raises
        ------
        BagError
            If a topic of the project has another type than it should, or there is not one
            readable message in the whole bag.
        """
        self._check_types(topics)
        empty = True
        for stored in self.as_stored():
            empty = False
            if topics is None or stored.topic in topics:
                yield stored
        if empty:
            known = f' ({"; ".join(self.problems)})' if self.problems else ''
            raise BagError(
                f'{self.path}: holds no message that can be read{known}, expected at least one; '
                '`trawl bag repair` saves what is left of a damaged bag'
            )

    def as_stored(self) -> Iterator[RawMessage]:
        """Yield all messages undecoded and unchecked, of any type; there may be none."""
        read = 0
        with reading(self.path, BagError, lambda: f'after {read} messages'):
            for stored in self._source.messages():
                read += 1
                yield stored
        stated = self._source.stated_count
        if read and stated is not None and stated > read:
            self._report(f'{self.path}: {read} of {stated} messages could be read')
        elif read and stated is not None and stated < read:
            self._report(
                f'{self.path}: {read} messages could be read, {read - stated} more than were '
                'counted when the bag was last brought up to date'
            )

    def messages(self, topics: Collection[str] | None = None) -> Iterator[Received]:
        """Yield decoded messages, of all topics or of those named in full.

        Messages that cannot be decoded are left out and counted in `problems`.

        Raises
        ------
        BagError
            As `raw`, and if the definition of one of the project's topics is not understood.
        """
        decoders = self._decoders(topics)
        failed: Counter[str] = Counter()
        for raw in self.raw(decoders):
            try:
                message = decoders[raw.topic](raw.data)
            except MessageError:
                failed[raw.topic] += 1
                continue
            yield Received(raw.topic, raw.type, raw.log_time, message, raw.channel, raw.sequence)
        for topic, count in failed.items():
            self._report(
                f'{self.path}: {count} messages on {topic} are not a {self.topics[topic]} '
                'and were left out'
            )

    def decode(self, raw: RawMessage) -> Any:
        """Decode a message from `raw`, for callers that need few of many.

        Raises
        ------
        BagError
            If the bag's definition of the type is not understood.
        MessageError
            If the bytes are not a message of the type.
        """
        if raw.topic not in self._decoders_made:
            self._decoders_made[raw.topic] = self._types.decoder(
                raw.topic, self._definitions[raw.topic]
            )
        return self._decoders_made[raw.topic](raw.data)

    def types_of(self, topic: str) -> Typestore:
        """Return the types by which a topic's messages are decoded.

        Raises
        ------
        BagError
            If the bag's definition of the type is not understood.
        """
        return self._types.store(topic, self._definitions[topic])

    def summary(self) -> BagSummary:
        """Count all messages by reading through the whole bag."""
        topics = _count_topics(
            (message.topic, message.type, message.log_time, len(message.data))
            for message in self.as_stored()
        )
        if not topics:
            self._report(f'{self.path}: holds no message')
        return BagSummary(
            path=self.path,
            topics=topics,
            count=sum(topic.count for topic in topics),
            start=min((topic.start for topic in topics), default=None),
            end=max((topic.end for topic in topics), default=None),
            facts=self.facts,
            problems=tuple(self.problems),
        )

    def _decoders(self, topics: Collection[str] | None) -> dict[str, Decoder]:
        decoders = {}
        for topic, definition in self.definitions().items():
            if topics is not None and topic not in topics:
                continue
            try:
                decoders[topic] = self._types.decoder(topic, definition)
            except BagError as reason:
                sentence = f'{self.path}: {reason}'
                if find_topic(topic, self._namespace) and not self._lenient:
                    raise BagError(sentence) from reason
                self._report(f'{sentence}; its messages are left out')
        return decoders

    def _check_types(self, topics: Collection[str] | None) -> None:
        for topic, types in sorted(self._source.types()):
            known = find_topic(topic, self._namespace)
            wanted = topics is None or topic in topics
            if known and wanted and types != known.type:
                sentence = (
                    f'{self.path}: {topic} has type {types or "unknown"}; expected {known.type}'
                )
                if not self._lenient:
                    raise BagError(sentence)
                self._report(sentence)

    def _report(self, problem: str) -> None:
        if problem not in self.problems:
            self.problems.append(problem)


def read_messages(
    path: str | Path,
    topics: Collection[str] | None = None,
    *,
    problems: list[str] | None = None,
) -> Iterator[Received]:
    """Read the messages of a bag in the order of their log times.

    Parameters
    ----------
    path
        A bag's folder, or one MCAP file.
    topics
        Full names of the topics wanted; None for all.
    problems
        Takes a sentence for each thing found wrong, once all messages were read.

    Yields
    ------
    Received
        Full ``topic``, ``type``, ``log_time`` (ns) and the decoded ``message``, by log time.

    Raises
    ------
    BagError
        See `Bag`.

    Examples
    --------
    >>> import trawl_ros
    >>> first = next(trawl_ros.read_messages('bags/sea_trial', ['/trawl/winch/joint_states']))
    >>> first.topic, list(first.message.name)
    ('/trawl/winch/joint_states', ['port_warp', 'starboard_warp'])
    """
    bag = Bag(path)
    yield from bag.messages(topics)
    if problems is not None:
        problems.extend(bag.problems)


def summarise(path: str | Path, *, lenient: bool = False) -> BagSummary:
    """Summarise the content of a bag; see `Bag.summary`."""
    return Bag(path, lenient=lenient).summary()


def _count_topics(messages: Iterable[tuple[str, str, int, int]]) -> tuple[TopicSummary, ...]:
    """Count messages, each given as topic, type, log time (ns) and size (bytes)."""
    summaries: dict[tuple[str, str], TopicSummary] = {}
    for topic, type_name, time, size in messages:
        key = topic, type_name
        past = summaries.get(key) or TopicSummary(*key, 0, 0, time, time)
        summaries[key] = TopicSummary(
            *key, past.count + 1, past.bytes + size, min(past.start, time), max(past.end, time)
        )
    return tuple(summaries[key] for key in sorted(summaries))
