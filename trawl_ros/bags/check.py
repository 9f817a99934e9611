# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Check of a bag: its content against its own metadata and against the topic table.

A finding is something that every user of the bag must know; a note only describes the bag. A bag
without findings is sound.
"""

from array import array
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

import numpy as np
from rosbags.interfaces import Qos, QosDurability, QosReliability

from trawl_ros.bags.header_stamps import StampReader, stamp_reader
from trawl_ros.bags.reader import Bag
from trawl_ros.bags.sources import BagFacts
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.bags.topic_content import Finding, TopicContent
from trawl_ros.core.errors import BagError
from trawl_ros.core.stamps import judge_stamps
from trawl_ros.core.time import SECOND
from trawl_ros.records.topics import (
    COMMANDS,
    ESTIMATES,
    INSTRUMENTS,
    NAMESPACE,
    TRUTH,
    Topic,
    absolute,
    find_topic,
)

GROUPS = {
    'truth': TRUTH,
    'instruments': INSTRUMENTS,
    'estimates': ESTIMATES,
    'commands': COMMANDS,
}
"""Topics of the topic table by purpose."""

RATE_FACTOR = 12.0
"""Factor between a mean rate and the usual one, up or down, that is a finding.

Winches may report at 1 to 10 Hz and other instruments at 0.2 to 1 Hz, each with some jitter.
"""

GAP_FACTOR = 10.0
"""A pause is a finding if it is this many times the topic's median interval.

It must also be longer than instruments of its kind are silent at sea.
"""

LAG_BOUND_S = 5.0
"""Difference between log time and header stamp that is a finding.

Acoustic links need up to a few seconds; a wrong clock is off by more. A sweep of the sonar may take
its duration in addition.
"""


@dataclass(frozen=True)
class TopicCheck:
    """Check of one topic of a bag.

    ``group`` is '' for a topic of another project. Rates are in Hz, log times in ns. ``lag_s``
    holds the smallest and largest log time after the header's stamp. Unknown values are None.
    """

    topic: str
    type: str
    group: str
    count: int
    bytes: int
    rate: float | None
    usual_rate: float | None
    longest_gap_s: float | None
    gap_start: int | None
    backward: int
    duplicates: int
    lag_s: tuple[float, float] | None
    qos: str


@dataclass(frozen=True)
class BagCheck:
    """Check of a bag."""

    path: Path
    facts: BagFacts
    count: int
    start: int | None
    end: int | None
    damaged_chunks: int
    topics: tuple[TopicCheck, ...]
    missing: dict[str, tuple[str, ...]]
    findings: tuple[Finding, ...]

    @property
    def sound(self) -> bool:
        """True if there are no findings."""
        return not self.findings


def check_bag(
    path: str | Path, *, namespace: str = NAMESPACE, required: Collection[str] = ()
) -> BagCheck:
    """Check a bag by reading through all of it.

    Parameters
    ----------
    path
        A bag's folder, or one file of it; may be damaged.
    namespace
        Of the project's topics in this bag.
    required
        Groups (see `GROUPS`) or topics, relative or in full, that must be there. What else the
        contract has and the bag has not is no finding: nobody records everything.

    Returns
    -------
    BagCheck
        ``sound``, its ``findings``, and counts, rates (Hz), gaps (s) and stamps by topic.

    Raises
    ------
    BagError
        If there is no bag at all, or a required name is no group and no topic's.

    Examples
    --------
    >>> import trawl_ros
    >>> bag = trawl_ros.tow('tow.yaml', 'checked')
    >>> trawl_ros.check_bag(bag.path, required=['truth']).sound
    True
    """
    wanted = _required(required, namespace)
    bag = Bag(path, namespace=namespace, lenient=True)
    records = {topic: _Record(stamp_reader(bag, topic)) for topic in bag.topics}
    contents = {
        topic: TopicContent(known.name)
        for topic, type_name in bag.topics.items()
        if (known := find_topic(topic, namespace)) and known.type == type_name
    }
    for message in bag.as_stored():
        records[message.topic].take(message)
        if message.topic in contents:
            contents[message.topic].take(bag, message)
    log_span = _log_span(records.values())
    span, findings = _judge_times(records.values())
    offered = bag.offered()
    topics = [
        _topic_check(topic, bag.topics[topic], record, _words(offered[topic]), namespace)
        for topic, record in sorted(records.items())
    ]
    findings += _whole(bag, topics)
    for checked in topics:
        known = find_topic(checked.topic, namespace)
        if known is not None:
            findings += _against_contract(
                checked, known, offered[checked.topic], records[checked.topic]
            )
    for topic, content in contents.items():
        findings += content.findings(topic)
    if not bag.problems:
        counts = {topic.topic: topic.count for topic in topics if topic.count}
        faults = bag.metadata_faults(counts, log_span)
        findings += [Finding('content', '', fault) for fault in faults]
    there = {checked.topic for checked in topics if checked.count}
    for name in sorted(wanted - there):
        findings.append(Finding('missing', name, 'is required, and has no message'))
    return BagCheck(
        path=bag.path,
        facts=bag.facts,
        count=sum(checked.count for checked in topics),
        start=span and span[0],
        end=span and span[1],
        damaged_chunks=bag.damaged_chunks,
        topics=tuple(topics),
        missing=_missing(there, namespace),
        findings=tuple(findings),
    )


@dataclass
class _Record:
    """Times of one topic, in order of arrival."""

    stamp_in: StampReader | None
    times: 'array[int]' = field(default_factory=lambda: array('q'))
    stamps: 'array[int]' = field(default_factory=lambda: array('q'))
    count: int = 0
    bytes: int = 0
    backward: int = 0
    duplicates: int = 0
    last_stamp: int | None = None
    lag: tuple[int, int] | None = None
    types: set[str] = field(default_factory=set)

    def take(self, message: RawMessage) -> None:
        self.count += 1
        self.times.append(message.log_time)
        self.bytes += len(message.data)
        self.types.add(message.type)
        stamp = self.stamp_in(message.data) if self.stamp_in else None
        if stamp is None:
            return
        if self.last_stamp is not None:
            self.backward += stamp < self.last_stamp
            self.duplicates += stamp == self.last_stamp
        self.last_stamp = stamp
        self.stamps.append(stamp)
        lag = message.log_time - stamp
        least, greatest = self.lag or (lag, lag)
        self.lag = min(least, lag), max(greatest, lag)

    def median_interval(self) -> float:
        return median(self.intervals() or [0])

    def intervals(self) -> list[int]:
        return [after - before for before, after in zip(self.times, self.times[1:])]


def _judge_times(records: Collection[_Record]) -> tuple[tuple[int, int] | None, list[Finding]]:
    """Check header stamps and log times of all topics, and drop impossible log times."""
    of_headers, judged = (
        judge_stamps(np.concatenate([np.zeros(0, dtype=np.int64), *numbers]))
        for numbers in ([r.stamps for r in records], [r.times for r in records])
    )
    findings = [Finding('stamp', '', f'of headers, {text}') for text in of_headers.sentences()]
    findings += [Finding('stamp', '', f'of the log, {text}') for text in judged.sentences()]
    span = judged.span
    if judged.reasons and span:
        for record in records:
            record.times = array('q', (time for time in record.times if span[0] <= time <= span[1]))
    return span, findings


def _log_span(records: Collection[_Record]) -> tuple[int, int] | None:
    """First and last log time (ns) of all topics; None without messages."""
    ends = [
        time
        for record in records
        if record.times
        for time in record.times[:: len(record.times) - 1 or 1]
    ]
    return (min(ends), max(ends)) if ends else None


def _required(names: Collection[str], namespace: str) -> set[str]:
    wanted: set[str] = set()
    for name in names:
        if name in GROUPS:
            wanted |= {absolute(topic.name, namespace) for topic in GROUPS[name]}
        elif name.startswith('/') or find_topic(name, namespace):
            wanted.add(absolute(name, namespace))
        else:
            raise BagError(
                f'{name}: neither a group nor a topic; expected {", ".join(GROUPS)} or a name such '
                'as winch/joint_states'
            )
    return wanted


def _topic_check(
    topic: str, type_name: str, record: _Record, qos: str, namespace: str
) -> TopicCheck:
    known = find_topic(topic, namespace)
    groups = [group for group, members in GROUPS.items() if known in members]
    intervals = record.intervals()
    span = sum(intervals)
    longest = max(intervals, default=None)
    return TopicCheck(
        topic=topic,
        type=' and '.join(sorted(record.types | {type_name})),
        group=groups[0] if groups else '',
        count=record.count,
        bytes=record.bytes,
        rate=len(intervals) * SECOND / span if span else None,
        usual_rate=known.rate if known else None,
        longest_gap_s=None if longest is None else longest / SECOND,
        gap_start=None if longest is None else record.times[intervals.index(longest)],
        backward=record.backward,
        duplicates=record.duplicates,
        lag_s=record.lag and (record.lag[0] / SECOND, record.lag[1] / SECOND),
        qos=qos,
    )


def _whole(bag: Bag, topics: list[TopicCheck]) -> list[Finding]:
    findings = [Finding('content', '', problem) for problem in bag.problems]
    findings += [
        Finding('index', '', f'{path.name} has no usable index; run `trawl bag repair`')
        for path in bag.files_without_index
    ]  # fmt: skip
    if bag.damaged_chunks:
        text = f'{bag.damaged_chunks} chunks fail their checksum or cannot be decoded'
        findings.append(Finding('crc', '', text))
    if not any(checked.count for checked in topics):
        findings.append(Finding('content', '', f'{bag.path}: holds no message'))
    return findings


def _against_contract(
    checked: TopicCheck, known: Topic, offered: tuple[Qos, ...], record: _Record
) -> list[Finding]:
    findings = []

    def add(kind: str, text: str) -> None:
        findings.append(Finding(kind, checked.topic, text))

    if checked.type != known.type:
        add('type', f'has type {checked.type or "unknown"}; expected {known.type}')
    if any(profile.reliability is QosReliability.BEST_EFFORT for profile in offered):
        add('qos', 'was offered best effort, so messages may be missing; expected reliable')
    if known.latched and any(p.durability is QosDurability.VOLATILE for p in offered):
        add('qos', 'was offered volatile, so late subscribers got none; expected transient local')
    if checked.group not in ('truth', 'instruments'):
        return findings
    if (
        checked.rate
        and known.rate
        and not 1 / RATE_FACTOR < checked.rate / known.rate < RATE_FACTOR
    ):
        add('rate', f'comes at {checked.rate:.3g} Hz; expected about {known.rate:g} Hz')
    if known.rate and (gaps := _gaps(record.intervals(), known.silence)):
        add(
            'gap',
            f'pauses {len(gaps)} times for more than '
            + (f'{known.silence:g} s' if known.silence else f'{GAP_FACTOR:g} median intervals')
            + f', longest {max(gaps) / SECOND:.4g} s',
        )
    if checked.backward:
        add('order', f'has {checked.backward} stamps earlier than the one before; expected none')
    if checked.duplicates:
        add('order', f'has {checked.duplicates} stamps equal to the one before; expected none')
    # A sweep, which comes at no rate of its own, is stamped at its first ping.
    sweep = record.median_interval() / SECOND if known.rate is None else 0.0
    if (
        checked.lag_s
        and not -LAG_BOUND_S <= checked.lag_s[0] <= checked.lag_s[1] <= LAG_BOUND_S + sweep
    ):
        least, greatest = checked.lag_s
        add(
            'stamp',
            f'was logged {least:.4g} to {greatest:.4g} s after its stamps; expected up to '
            f'{LAG_BOUND_S + sweep:g} s',
        )
    return findings


def _gaps(intervals: list[int], silence_s: float) -> list[int]:
    if len(intervals) < 3:
        return []
    usual = median(intervals)
    longest = max(GAP_FACTOR * usual, silence_s * SECOND)
    return [interval for interval in intervals if interval > longest > 0]


def _missing(there: set[str], namespace: str) -> dict[str, tuple[str, ...]]:
    return {
        group: tuple(
            topic.name for topic in members if absolute(topic.name, namespace) not in there
        )
        for group, members in GROUPS.items()
    }


def _words(profiles: tuple[Qos, ...]) -> str:
    """Describe the offered QoS, e.g. ``reliable, volatile, last 100``."""
    profiles_in_words = dict.fromkeys(describe_qos(profile) for profile in profiles)
    return '; '.join(profiles_in_words)


def describe_qos(profile: Qos) -> str:
    """Describe a QoS profile, e.g. ``reliable, volatile, last 100``."""
    words = [
        profile.reliability.name.lower().replace('_', ' '),
        profile.durability.name.lower().replace('_', ' '),
    ]
    history = profile.history.name.lower().replace('_', ' ')
    words.append(f'last {profile.depth}' if history == 'keep last' else history)
    return ', '.join(words)
