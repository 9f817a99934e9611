# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Samples from a log of sentences: the sentence used for each topic, and its time."""

import math
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from statistics import median
from typing import Annotated, BinaryIO

import numpy as np
from pydantic import Field

from trawl_ros.core.errors import LogError
from trawl_ros.core.foreign import open_file
from trawl_ros.core.foreign import reading as reading_file
from trawl_ros.core.limits import LOG_NULS
from trawl_ros.core.stamps import DAY_NS, LOG_APART_NS, judge_stamps
from trawl_ros.core.time import SECOND
from trawl_ros.records.fields import StatedTopic, WaterColumn
from trawl_ros.records.possible import impossible, impossible_fields
from trawl_ros.records.samples import Sample
from trawl_ros.sentences.assembly import WINCH, SampleAssembly, samples_of
from trawl_ros.sentences.codec import SentenceReader, Spoken
from trawl_ros.sentences.framing import (
    LONGEST_LINE,
    Frame,
    SentenceSplitter,
    Unreadable,
    parse_line,
)
from trawl_ros.sentences.log_times import ShipTimes, spread_stamps, stamps_by_own_times
from trawl_ros.sentences.table import SentenceRow, SentenceTable, load_table

SHIP = 'ship'
"""System of the ship's own sensors, whose sentences state date and time."""

BLOCK_BYTES = 1 << 16
"""Number of bytes of a log that are read at once."""

CLOCK_DIFFERENCE_NS = SECOND // 2
"""Difference (ns) of two clocks in a log from which on a note is made."""

UNDATED = 'before the first time with a date'

_TABLE = re.compile(r'[,;|\t]')
_AROUND = ' \t\r\n,;|[]()<>"'


class TopicChoice(StatedTopic):
    """Choice of the ship's sentences for one topic, and the noise and limits of its messages.

    Of ``sentences`` (such as GGA) the first one in the log is used, so that a position in three
    kinds of sentence gives one message. ``talkers`` (such as ``HE`` for a gyro) selects the
    senders; by default it is the one with most sentences.
    """

    sentences: Annotated[tuple[str, ...], Field(min_length=1)]
    talkers: tuple[str, ...] | None = None


@dataclass(frozen=True)
class SentenceLogOptions:
    """Options for reading a log of sentences.

    Attributes
    ----------
    choices
        Ship's sentences by topic.
    gear
        Tables of other systems, in the order of preference.
    water
        By which depths become pressures.
    keel_depth_m
        Height of the echo sounder's transducer above the keel, where its sentence does not say it.
    need_checksum
        True if the ship's sentences without a checksum are left out.
    start
        Midnight (ns) before the log begins, for times of day without any other date.
    recorder
        Converts the text in front of a sentence into its stamp (ns), or raises `ValueError`;
        None where the sentences' own times count.
    leave_out
        True if a sentence whose recorder's time cannot be understood is counted; by default the
        first one is an error.
    """

    choices: Mapping[str, TopicChoice]
    gear: Sequence[SentenceTable]
    water: WaterColumn
    keel_depth_m: float = 0.0
    need_checksum: bool = True
    start: int | None = None
    recorder: Callable[[str], int] | None = None
    leave_out: bool = False


@dataclass(frozen=True)
class _Heard:
    """Sentence, its stamp (ns) or None, and the number of the ship's time before it, or -1."""

    spoken: Spoken
    stamp: int | None
    moment: int


class SentenceLogReader:
    """Reader of one log.

    Parameters
    ----------
    path
        The log, one sentence per line, each maybe with a recorder's time in front.
    options
        See `SentenceLogOptions`.

    Attributes
    ----------
    rows
        Lines that were read.
    left
        Counts of lines and readings left out, by reason.
    notes
        Sentences on the log's clocks.
    """

    def __init__(self, path: Path, options: SentenceLogOptions) -> None:
        self.rows = 0
        self.left: Counter[str] = Counter()
        self.notes: list[str] = []
        self._path = path
        self._options = options
        checksum = 'yes' if options.need_checksum else 'optional'
        ship = load_table(SHIP)
        rows = {
            name: row.model_copy(update={'checksum': checksum})
            for name, row in ship.sentences.items()
        }
        ship = ship.model_copy(update={'topics': options.choices, 'sentences': rows})
        self._tables = (ship, *(table for table in options.gear if table.system != SHIP))
        self._systems = [table.system for table in self._tables]
        self._reader = SentenceReader(self._tables, keel_depth_m=options.keel_depth_m)
        self._times = ShipTimes(options.start)

    def samples(self) -> list[Sample]:
        """Read the log.

        Raises
        ------
        LogError
            If it cannot be read, nothing in it says the date, or a recorder's time is wrong.
        """
        heard = [one for frame in self._frames() if (one := self._hear(frame))]
        moments = self._times.moments
        self._refuse_undated(heard)
        judged = judge_stamps(
            np.array(moments, dtype=np.int64), apart_ns=LOG_APART_NS, in_order=True
        )
        false = frozenset(np.flatnonzero(judged.false).tolist())
        chosen = self._choose(self._stamp(heard), false)
        self.notes = [*judged.sentences(), *_clock_differences(chosen)]
        assembly = SampleAssembly(self._tables, self._options.water)
        possible = []
        for sample in samples_of(chosen, assembly):
            if why := impossible(sample):
                self.left[f'an impossible reading: {why}'] += 1
            else:
                possible.append(sample)
        return possible

    def _frames(self) -> Iterator[Frame]:
        """Yield the complete sentences, and count the other lines."""
        splitter = SentenceSplitter()
        with reading_file(self._path, LogError), open_file(self._path, LogError) as stream:
            pieces = chain.from_iterable(map(splitter.feed, self._blocks(stream)))
            for piece in chain(pieces, splitter.end()):
                self.rows = max(splitter.line, 1)
                try:
                    if piece.strip():
                        yield parse_line(piece)
                except Unreadable as reason:
                    self.left[str(reason)] += 1
        self.rows = splitter.line
        if splitter.too_long:
            self.left[f'more than {LONGEST_LINE} bytes without a sentence'] += splitter.too_long

    def _blocks(self, stream: BinaryIO) -> Iterator[bytes]:
        nulls = 0
        while block := stream.read(BLOCK_BYTES):
            nulls = 0 if block.strip(b'\0') else nulls + len(block)
            if nulls > LOG_NULS.value:
                raise LogError(f'{self._path}: more than {LOG_NULS} of NULs; expected sentences')
            yield block

    def _hear(self, frame: Frame) -> _Heard | None:
        """Read a sentence; None if it has no reading for any topic."""
        try:
            spoken = self._reader.read(frame)
        except Unreadable as reason:
            self.left[str(reason)] += 1
            return None
        row = self._reader.rows[spoken.system, spoken.name]
        stamp = None
        if self._options.recorder is not None:
            if (stamp := self._recorded(frame, self._options.recorder)) is None:
                return None
        elif spoken.system == SHIP:
            stamp = self._times.hear(spoken, _kind(row))
        if row.is_clock:
            return None
        if row.passed_over:
            self.left['a sentence that is ignored'] += 1
            return None
        topics = [topic for topic in spoken.topics if self._rank(topic, spoken) is not None]
        if not topics:
            self.left[f'sentence {_kind(row)}, which no topic takes'] += 1
            return None
        return _Heard(spoken.restricted(topics), stamp, len(self._times.moments) - 1)

    def _recorded(self, frame: Frame, recorder: Callable[[str], int]) -> int | None:
        """Read the recorder's time; count it and return None if it is not understood."""
        text = frame.tag_text or frame.front.strip(_AROUND)
        expected = ''
        # A device may have its name before or behind the time.
        for part in dict.fromkeys((text, *_TABLE.split(text), *text.split())):
            try:
                return recorder(part.strip(_AROUND))
            except ValueError as reason:
                expected = expected or str(reason)
        if not self._options.leave_out:
            raise LogError(
                f'{self._path}: line {self.rows}: found {text!r} in front of the sentence, '
                f'expected {expected}'
            )
        self.left[f'in front of the sentence: expected {expected}'] += 1
        return None

    def _refuse_undated(self, heard: Sequence[_Heard]) -> None:
        """Raise an error that says there is no date, what was found, and what to do."""
        times, options = self._times, self._options
        self.left.update(times.impossible)
        if times.moments or options.recorder or options.start is not None or not self.rows:
            return
        if any(one.spoken.system != SHIP and _says_date(one.spoken) for one in heard):
            return
        if heard:
            self.left[UNDATED] += len(heard)
        seen = listed(times.unused + self.left)
        # A time of day and a date make a time; without either there is nothing to date.
        if times.undated:
            help_ = 'one, or key date in the mapping, which these times of day then have'
        else:
            help_ = 'one, or time: recorder in the mapping'
        raise LogError(
            f'{self._path}: no valid RMC or ZDA among {self.rows} lines says the date'
            f'{f" ({seen})" if seen else ""}; expected {help_}'
        )

    def _stamp(self, heard: Sequence[_Heard]) -> list[_Heard]:
        """Assign a stamp to each sentence; those before the first date are left out."""
        moments = self._times.moments
        if moments:
            heard_since = [one for one in heard if one.stamp is not None or one.moment >= 0]
            bare = [one for one in heard_since if one.stamp is None]
            keys = [
                (one.moment, (one.spoken.system, one.spoken.name, one.spoken.talker))
                for one in bare
            ]
            spread = iter(spread_stamps(moments, keys))
            stamped = [
                replace(one, stamp=next(spread)) if one.stamp is None else one
                for one in heard_since
            ]
        else:
            # The ship's times were of no use.
            times = [None if one.spoken.system == SHIP else one.spoken.time for one in heard]
            given = [one.stamp for one in heard]
            stamps = stamps_by_own_times(times, given, self._options.start)
            stamped = [
                replace(one, stamp=stamp)
                for one, stamp in zip(heard, stamps, strict=True)
                if stamp is not None
            ]
        if early := len(heard) - len(stamped):
            self.left[UNDATED] += early
        return stamped

    def _choose(self, heard: Sequence[_Heard], false: Collection[int]) -> list[tuple[Spoken, int]]:
        """Select the sentences for each topic; ``false`` are the indices of impossible times."""
        told: dict[str, list[_Heard]] = defaultdict(list)
        for one in heard:
            for topic in one.spoken.topics:
                if (why := _no_reading(topic, one.spoken.of_topic(topic))) is not None:
                    label = self._label(one.spoken)
                    self.left[f'{label} without a valid reading for {topic}{why}'] += 1
                elif one.moment in false:
                    self.left['a reading with an impossible time'] += 1
                else:
                    told[topic].append(one)
        return [
            (one.spoken.restricted([topic]), one.stamp)
            for topic, sentences in told.items()
            for one in self._of_one_source(topic, sentences)
            if one.stamp is not None
        ]

    def _of_one_source(self, topic: str, sentences: Sequence[_Heard]) -> list[_Heard]:
        """Select one system, and of the ship's sentences one kind and its talkers."""
        ranks = [self._rank(topic, one.spoken) for one in sentences]
        best = min(rank for rank in ranks if rank is not None)
        here = [one for one, rank in zip(sentences, ranks, strict=True) if rank == best]
        label = self._label(here[0].spoken)
        for one, rank in zip(sentences, ranks, strict=True):
            if rank != best:
                self.left[f'{self._label(one.spoken)} for {topic}, which {label} reports'] += 1
        if here[0].spoken.system != SHIP:
            return here
        talkers = Counter(one.spoken.talker for one in here)
        wanted = set(self._options.choices[topic].talkers or [talkers.most_common(1)[0][0]])
        for talker, count in talkers.items():
            if talker not in wanted:
                believed = ' and '.join(sorted(wanted))
                self.left[f'{label} of {talker} for {topic}, which {believed} reports'] += count
        return [one for one in here if one.spoken.talker in wanted]

    def _rank(self, topic: str, spoken: Spoken) -> tuple[int, int] | None:
        """Return the rank: the ship's sentences by the mapping, then systems; None if unused."""
        if spoken.system != SHIP:
            return self._systems.index(spoken.system), 0
        choice = self._options.choices.get(topic)
        kind = self._label(spoken)
        if choice is None or kind not in choice.sentences:
            return None
        return 0, choice.sentences.index(kind)

    def _label(self, spoken: Spoken) -> str:
        """Return the source of a sentence: its kind (as GGA) for the ship's, else its system."""
        row = self._reader.rows[spoken.system, spoken.name]
        return _kind(row) if spoken.system == SHIP else spoken.system


def ship_kinds() -> dict[str, tuple[str, ...]]:
    """Return the kinds of the ship's sentences (as GGA) for each topic."""
    kinds: dict[str, dict[str, None]] = defaultdict(dict)
    for row in load_table(SHIP).sentences.values():
        for topic in row.topics:
            kinds[topic][_kind(row)] = None
    return {topic: tuple(names) for topic, names in kinds.items()}


def listed(left_out: Mapping[str, int]) -> str:
    """Return a line that lists what was left out, with the reasons."""
    return '; '.join(f'{count}: {reason}' for reason, count in left_out.items())


def _kind(row: SentenceRow) -> str:
    return row.address.removeprefix('--')


def _says_date(spoken: Spoken) -> bool:
    return spoken.time is not None and spoken.time.day is not None


def _no_reading(topic: str, fields: Mapping[str, float]) -> str | None:
    """Return why fields are no reading of a topic ('' if one is missing); None if they are."""
    missing = [math.isnan(value) for value in fields.values()]
    if all(missing) if topic == WINCH else any(missing):
        return ''
    why = impossible_fields(fields)
    return f': {why}' if why else None


def _clock_differences(stamped: Sequence[tuple[Spoken, int]]) -> list[str]:
    """Yield how far the times in sentences of gear differ from their stamps."""
    differences: dict[str, list[int]] = defaultdict(list)
    for spoken, stamp in stamped:
        if spoken.time is not None and spoken.system != SHIP:
            off = (spoken.time.of_day - stamp + DAY_NS // 2) % DAY_NS - DAY_NS // 2
            differences[spoken.system].append(off)
    notes = []
    for system, offs in differences.items():
        # Times of day with whole seconds are cut, and so late by half of one.
        off = round(median(offs))
        if abs(off) > CLOCK_DIFFERENCE_NS:
            ahead = 'ahead of' if off > 0 else 'behind'
            notes.append(f'the clock of {system} is {abs(off) / SECOND:.1f} s {ahead} the stamps')
    return notes
