"""Import of NMEA 0183 logs as bags: sentences of the ship's sensors and of her gear's."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import date
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from pynmeagps import NMEAReader
from pynmeagps.nmeahelpers import calc_checksum

from trawl_ros.bags.logs.clock import ClockReader
from trawl_ros.bags.logs.gear_sentences import FALSE_TIME, GearListening
from trawl_ros.bags.logs.nmea_mapping import NmeaMapping, load_nmea_mapping
from trawl_ros.bags.logs.nmea_readings import NoReading, SampleAt, misread, sample_of
from trawl_ros.bags.logs.nmea_times import TIMING, SentenceTimes, spread_stamps
from trawl_ros.bags.logs.writing import Imported, listed, write_samples
from trawl_ros.core.errors import LogError
from trawl_ros.core.foreign import open_file
from trawl_ros.core.foreign import reading as reading_file
from trawl_ros.core.limits import LOG_NULS
from trawl_ros.core.stamps import LOG_APART_NS, judge_stamps
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import Sample
from trawl_ros.sentences.framing import (
    LONGEST_LINE,
    Frame,
    SentenceSplitter,
    Unreadable,
    parse_line,
)

BLOCK_BYTES = 1 << 16
"""Bytes of a log that are read at once."""

_NO_LETTER = re.compile(r'[^A-Z0-9]')
_TABLE = re.compile(r'[,;|\t]')
_AROUND = ' \t\r\n,;|[]()<>"'


def import_nmea(
    log_path: str | Path,
    mapping_path: str | Path,
    bag_path: str | Path,
    *,
    leave_out: bool = False,
) -> Imported:
    """Turn a log of NMEA 0183 sentences into a bag.

    Parameters
    ----------
    log_path
        The log, one sentence per line, each maybe with a recorder's time in front.
    mapping_path
        See `NmeaMapping`.
    bag_path
        Folder to be made.
    leave_out
        True if lines whose recorder's time cannot be understood are left out and counted; by
        default the first of them is an error. Damaged sentences always are left out: serial
        lines lose bytes.

    Raises
    ------
    LogError
        If log or mapping are missing or wrong, or nothing in the log says the time.
    BagError
        If the bag exists or cannot be written.
    """
    path = Path(log_path)
    listening = _Listening(path, load_nmea_mapping(mapping_path), leave_out)
    samples = listening.samples()
    done = write_samples(path, samples, bag_path, lambda: (listening.lines, listening.left))
    return replace(done, notes=(*listening.notes, *done.notes))


@dataclass(frozen=True)
class _Heard:
    """Reading: its talker, its own stamp (ns) or None, and the number of the moment before it."""

    talker: str
    kind: str
    stamp: int | None
    moment: int
    sample: SampleAt


class _Listening:
    """Single pass through a log, with counts."""

    def __init__(self, path: Path, mapping: NmeaMapping, leave_out: bool) -> None:
        self.lines = 0
        self.left: Counter[str] = Counter()
        self.notes: list[str] = []
        self._path = path
        self._mapping = mapping
        self._gear = GearListening(mapping.tables(), mapping.water, self.left)
        self._leave_out = leave_out
        self._recorder = ClockReader(mapping.recorder) if mapping.recorder else None
        self._times = SentenceTimes(date.fromisoformat(mapping.date) if mapping.date else None)
        self._takers: dict[str, list[str]] = defaultdict(list)
        for topic, entry in mapping.topics.items():
            for kind in entry.sentences:
                self._takers[kind].append(topic)

    def samples(self) -> list[Sample]:
        heard: dict[str, list[_Heard]] = defaultdict(list)
        for frame in self._frames():
            if self._gear.knows(frame):
                self._hear_gear(frame)
                continue
            if frame.start != '$':
                address = _NO_LETTER.sub('', frame.body.partition(',')[0])[:10]
                self.left[f'sentence {frame.start}{address}, which no topic takes'] += 1
                continue
            sentence = self._parse(frame)
            if sentence is None:
                continue
            kind = str(sentence.msgID)
            if self._recorder is None:
                stamp = self._times.hear(sentence)
            elif (stamp := self._recorded(frame)) is None:
                continue
            if kind not in self._takers:
                if kind not in TIMING:
                    self.left[f'sentence {kind}, which no topic takes'] += 1
                continue
            if stamp is None and not self._times.moments:
                self.left['before the first time with a date'] += 1
                continue
            self._take(heard, sentence, stamp)
        self.left.update(self._times.impossible)
        start = self._mapping.start
        timeless = start is None and not self._gear.has_times
        if self._recorder is None and self.lines and not self._times.moments and timeless:
            raise LogError(self._undated())
        judged = judge_stamps(
            np.array(self._times.moments, dtype=np.int64), apart_ns=LOG_APART_NS, in_order=True
        )
        self._false = frozenset(np.flatnonzero(judged.false).tolist())
        samples = [
            sample
            for topic, sentences in heard.items()
            for sample in self._chosen(topic, sentences)
        ]
        of_gear, notes = self._gear.samples(self._times.moments, start, self._false)
        self.notes = [*judged.sentences(), *notes]
        return samples + of_gear

    def _undated(self) -> str:
        """Say that there is no date, what was seen instead, and what would help."""
        seen = listed(self._times.unused + self.left)
        # A time of day and a date make a time; without either there is nothing to date.
        if self._times.undated:
            help_ = 'one, or key date in the mapping, which these times of day then have'
        else:
            help_ = 'one, or time: recorder in the mapping'
        return (
            f'{self._path}: no valid RMC or ZDA among {self.lines} lines says the date'
            f'{f" ({seen})" if seen else ""}; expected {help_}'
        )

    def _hear_gear(self, frame: Frame) -> None:
        stamp = None
        if self._recorder is not None and (stamp := self._recorded(frame)) is None:
            return
        self._gear.hear(frame, stamp, len(self._times.moments) - 1)

    def _frames(self) -> Iterator[Frame]:
        """Yield the sentences that are whole, and count what is not."""
        splitter = SentenceSplitter()
        with reading_file(self._path, LogError), open_file(self._path, LogError) as stream:
            pieces = chain.from_iterable(map(splitter.feed, self._blocks(stream)))
            for piece in chain(pieces, splitter.end()):
                self.lines = max(splitter.line, 1)
                try:
                    if piece.strip():
                        yield parse_line(piece)
                except Unreadable as reason:
                    self.left[str(reason)] += 1
        self.lines = splitter.line
        if splitter.too_long:
            self.left[f'more than {LONGEST_LINE} bytes without a sentence'] += splitter.too_long

    def _blocks(self, stream: BinaryIO) -> Iterator[bytes]:
        nulls = 0
        while block := stream.read(BLOCK_BYTES):
            nulls = 0 if block.strip(b'\0') else nulls + len(block)
            if nulls > LOG_NULS.value:
                raise LogError(f'{self._path}: more than {LOG_NULS} of NULs; expected sentences')
            yield block

    def _parse(self, frame: Frame) -> Any | None:
        if self._mapping.need_checksum and not frame.checked:
            self.left['a sentence without checksum'] += 1
            return None
        body = frame.body.strip()
        try:
            sentence = NMEAReader.parse(f'${body}*{calc_checksum(body)}'.encode())
            if why := misread(sentence):
                self.left[f'{sentence.msgID}: {why}'] += 1
                return None
        # The library also raises what Python does, by sentences whose checksum is right.
        except Exception:
            sentence = None
        if sentence is None:
            self.left['a sentence that cannot be understood'] += 1
        return sentence

    def _recorded(self, frame: Frame) -> int | None:
        assert self._recorder is not None
        text = frame.tag_text or frame.front.strip(_AROUND)
        expected = ''
        # A device may have its name before or behind the time.
        for part in dict.fromkeys((text, *_TABLE.split(text), *text.split())):
            try:
                return self._recorder.read(part.strip(_AROUND))
            except ValueError as reason:
                expected = expected or str(reason)
        if not self._leave_out:
            raise LogError(
                f'{self._path}: line {self.lines}: found {text!r} in front of the sentence, '
                f'expected {expected}'
            )
        self.left[f'in front of the sentence: expected {expected}'] += 1
        return None

    def _take(self, heard: dict[str, list[_Heard]], sentence: Any, stamp: int | None) -> None:
        kind, talker = str(sentence.msgID), str(sentence.talker)
        for topic in self._takers[kind]:
            entry = self._mapping.topics[topic]
            try:
                sample = sample_of(topic, sentence, entry, self._mapping)
                if why := impossible(sample(0)):
                    raise NoReading(why)
            except (NoReading, AttributeError) as reason:
                # An attribute that is not there is a field that the sentence is too short for.
                why = f': {reason}' if isinstance(reason, NoReading) and reason.args else ''
                self.left[f'{kind} without a valid reading for {topic}{why}'] += 1
                continue
            moment = len(self._times.moments) - 1
            heard[topic].append(_Heard(talker, kind, stamp, moment, sample))

    def _chosen(self, topic: str, sentences: list[_Heard]) -> list[Sample]:
        """Select one kind of sentence from one talker, and give each its time."""
        number = len(sentences)
        sentences = [heard for heard in sentences if heard.moment not in self._false]
        if number > len(sentences):
            self.left[FALSE_TIME] += number - len(sentences)
        if not sentences:
            return []
        entry = self._mapping.topics[topic]
        there = {heard.kind for heard in sentences}
        kind = next(name for name in entry.sentences if name in there)
        talkers = Counter(heard.talker for heard in sentences if heard.kind == kind)
        wanted = set(entry.talkers or [talkers.most_common(1)[0][0]])
        chosen = [heard for heard in sentences if heard.kind == kind and heard.talker in wanted]
        for heard in sentences:
            if heard.kind != kind:
                self.left[f'{heard.kind} for {topic}, which {kind} tells'] += 1
            elif heard.talker not in wanted:
                listened = ' and '.join(sorted(wanted))
                self.left[f'{kind} of {heard.talker} for {topic}, which {listened} tells'] += 1
        bare = [heard for heard in chosen if heard.stamp is None]
        given = iter(
            spread_stamps(self._times.moments, [(heard.moment, heard.talker) for heard in bare])
        )
        return [
            heard.sample(next(given) if heard.stamp is None else heard.stamp) for heard in chosen
        ]
