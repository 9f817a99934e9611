"""Import of NMEA 0183 logs as bags: sentences of the ship's sensors and of her gear's."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path
from typing import Any

from pynmeagps import NMEAReader
from pynmeagps.exceptions import NMEAParseError
from pynmeagps.nmeahelpers import calc_checksum

from trawl_ros.bags.logs.clock import ClockReader
from trawl_ros.bags.logs.gear_sentences import GearListening
from trawl_ros.bags.logs.nmea_mapping import NmeaMapping, load_nmea_mapping
from trawl_ros.bags.logs.nmea_readings import NoReading, SampleAt, sample_of
from trawl_ros.bags.logs.nmea_times import SentenceTimes, spread_stamps
from trawl_ros.bags.logs.writing import Imported, listed, write_samples
from trawl_ros.core.errors import LogError
from trawl_ros.core.foreign import open_file
from trawl_ros.core.foreign import reading as reading_file
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import Sample
from trawl_ros.sentences.framing import Frame

MAX_LINE = 4096
"""Bytes in a line; a sentence has 82 at most, a recorder's mark in front of it some more."""

_TIMING = {'RMC', 'ZDA', 'GGA', 'GLL', 'GNS'}
_TAG_TIME = re.compile(r'c:(\d+)', re.ASCII)
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
    return replace(done, notes=tuple(listening.notes))


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
        for line in self._lines():
            front, text = _front_of(line)
            if (frame := self._gear.frame(line)) is not None:
                self._hear_gear(frame, front)
                continue
            if not text:
                self.left['a line without a sentence ($…)'] += 1
                continue
            sentence = self._parse(text)
            if sentence is None:
                continue
            kind = str(sentence.msgID)
            if self._recorder is None:
                stamp = self._times.hear(sentence)
            elif (stamp := self._recorded(front)) is None:
                continue
            if kind not in self._takers:
                if kind not in _TIMING:
                    self.left[f'sentence {kind}, which no topic takes'] += 1
                continue
            if stamp is None and not self._times.moments:
                self.left['before the first time with a date'] += 1
                continue
            self._take(heard, sentence, stamp)
        start = self._mapping.start
        timeless = start is None and not self._gear.has_times
        if self._recorder is None and self.lines and not self._times.moments and timeless:
            why = f' ({listed(self.left)})' if self.left else ''
            raise LogError(
                f'{self._path}: no valid RMC or ZDA among {self.lines} lines says the date{why}; '
                'expected one, or key date in the mapping, or time: recorder'
            )
        samples = [
            sample
            for topic, sentences in heard.items()
            for sample in self._chosen(topic, sentences)
        ]
        of_gear, self.notes = self._gear.samples(self._times.moments, start)
        return samples + of_gear

    def _hear_gear(self, frame: Frame, front: str) -> None:
        stamp = None
        if self._recorder is not None and (stamp := self._recorded(front)) is None:
            return
        self._gear.hear(frame, stamp, len(self._times.moments) - 1)

    def _lines(self) -> Iterator[bytes]:
        """Yield the lines that are not empty."""
        with reading_file(self._path, LogError), open_file(self._path, LogError) as stream:
            while line := stream.readline(MAX_LINE):
                self.lines += 1
                if len(line) == MAX_LINE:
                    raise LogError(
                        f'{self._path}: line {self.lines} has {MAX_LINE} bytes or more; '
                        'expected sentences of NMEA 0183'
                    )
                if line.strip():
                    yield line

    def _parse(self, text: bytes) -> Any | None:
        if b'*' not in text:
            if self._mapping.need_checksum:
                self.left['a sentence without checksum'] += 1
                return None
            text += b'*' + calc_checksum(text[1:].decode('ascii', 'replace')).encode()
        try:
            sentence = NMEAReader.parse(text)
        except NMEAParseError:
            self.left['a sentence whose checksum is wrong'] += 1
            return None
        # The library also raises what Python does, by sentences whose checksum is right.
        except Exception:
            sentence = None
        if sentence is None:
            self.left['a sentence that cannot be understood'] += 1
        return sentence

    def _recorded(self, front: str) -> int | None:
        assert self._recorder is not None
        tagged = _TAG_TIME.search(front) if front.startswith('\\') else None
        text = tagged[1] if tagged else front.strip(_AROUND)
        try:
            return self._recorder.read(text)
        except ValueError as expected:
            if not self._leave_out:
                raise LogError(
                    f'{self._path}: line {self.lines}: found {text!r} in front of the sentence, '
                    f'expected {expected}'
                ) from None
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


def _front_of(line: bytes) -> tuple[str, bytes]:
    """Split a line into the text in front of its sentence, and the sentence.

    Where a sentence was cut short by the next one, the next one is whole. Those of the ship begin
    with a dollar; a line without one gives an empty sentence.
    """
    sign = b'$' if b'$' in line else b'@' if b'@' in line else b'#'
    front = line[: max(line.find(sign), 0)].decode('ascii', 'replace')
    return front, line[line.rfind(sign) :].strip() if sign == b'$' else b''
