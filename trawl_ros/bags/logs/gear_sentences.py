"""Sentences of fishing gear in a log: heard in their order, stamped and assembled at its end."""

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from statistics import median

from trawl_ros.bags.logs.nmea_times import spread_stamps
from trawl_ros.core.time import SECOND
from trawl_ros.records.fields import WaterColumn
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import Sample
from trawl_ros.sentences.assembly import SampleAssembly, samples_of
from trawl_ros.sentences.codec import SentenceReader, Spoken
from trawl_ros.sentences.framing import Frame, Unreadable
from trawl_ros.sentences.table import SentenceTable
from trawl_ros.sentences.times import DAY

FALSE_TIME = 'a reading whose time cannot be'

TOLD_NS = SECOND // 2
"""Difference (ns) of two clocks in a log from which on it is told."""


@dataclass(frozen=True)
class _Heard:
    """Sentence, its recorder's stamp (ns) or None, and the number of the moment before it."""

    spoken: Spoken
    stamp: int | None
    moment: int


class GearListening:
    """Listener for the sentences of tables among the lines of a log.

    Of the systems that tell a topic the first one named that the log has is used.

    Parameters
    ----------
    tables
        Systems, in the order of preference.
    water
        By which depths become pressures.
    left
        Counts of lines left out, by reason; added to.
    """

    def __init__(
        self, tables: Sequence[SentenceTable], water: WaterColumn, left: Counter[str]
    ) -> None:
        self._tables = tables
        self._reader = SentenceReader(tables)
        self._assembly = SampleAssembly(tables, water)
        self._left = left
        self._heard: list[_Heard] = []

    def knows(self, frame: Frame) -> bool:
        """True if a table has the address of a sentence."""
        return self._reader.knows(frame)

    def hear(self, frame: Frame, stamp: int | None, moment: int) -> None:
        """Take a sentence; ``moment`` is the number of the time said last, -1 before the first."""
        try:
            self._heard.append(_Heard(self._reader.read(frame), stamp, moment))
        except Unreadable as reason:
            self._left[str(reason)] += 1

    @property
    def has_times(self) -> bool:
        """True if a sentence says the time and the day."""
        return any(heard.spoken.time and heard.spoken.time.day for heard in self._heard)

    def samples(
        self, moments: list[int], start: int | None, false: Collection[int]
    ) -> tuple[list[Sample], list[str]]:
        """Give all samples, and sentences on clocks that differ.

        Parameters
        ----------
        moments
            Times (ns) that the ship's clock said; where there are none, sentences have their own.
        start
            Midnight (ns) before the log begins, for times of day without any other date.
        false
            Numbers of moments that cannot be.
        """
        heard = [one for one in self._heard if one.moment not in false]
        if len(heard) < len(self._heard):
            self._left[FALSE_TIME] += len(self._heard) - len(heard)
        self._heard = heard
        stamped = self._stamped(moments, start)
        stamped = self._of_one_system_each(stamped)
        samples = samples_of(stamped, self._assembly)
        possible = []
        for sample in samples:
            if why := impossible(sample):
                self._left[f'a reading that cannot be: {why}'] += 1
            else:
                possible.append(sample)
        return possible, _clock_differences(stamped)

    def _stamped(self, moments: list[int], start: int | None) -> list[tuple[Spoken, int]]:
        recorded = [(h.spoken, h.stamp) for h in self._heard if h.stamp is not None]
        if recorded:
            return recorded
        if moments:
            known = [heard for heard in self._heard if heard.moment >= 0]
            if early := len(self._heard) - len(known):
                self._left['before the first time with a date'] += early
            keys = [(heard.moment, (heard.spoken.system, heard.spoken.name)) for heard in known]
            stamps = spread_stamps(moments, keys)
            return [(heard.spoken, stamp) for heard, stamp in zip(known, stamps, strict=True)]
        stamped = []
        near = start
        for heard in self._heard:
            time = heard.spoken.time
            stamp = time.stamp(near) if time else near
            if stamp is None:
                self._left['before the first time with a date'] += 1
                continue
            near = stamp
            stamped.append((heard.spoken, stamp))
        return stamped

    def _of_one_system_each(self, stamped: list[tuple[Spoken, int]]) -> list[tuple[Spoken, int]]:
        order = [table.system for table in self._tables]
        teller: dict[str, str] = {}
        for spoken, _ in stamped:
            for topic in {topic for topic, _ in spoken.readings}:
                present = teller.get(topic, spoken.system)
                teller[topic] = min(present, spoken.system, key=order.index)
        kept = []
        for spoken, stamp in stamped:
            topics = {topic for topic, _ in spoken.readings}
            if not topics:
                self._left['a sentence that is passed over'] += 1
                continue
            if all(teller[topic] != spoken.system for topic in topics):
                topic = min(topics)
                self._left[f'{topic} by {spoken.system}, which {teller[topic]} tells'] += 1
                continue
            kept.append((spoken, stamp))
        return kept


def _clock_differences(stamped: list[tuple[Spoken, int]]) -> list[str]:
    """Tell by how much times in sentences differ from the stamps that they were given."""
    differences: dict[str, list[int]] = {}
    for spoken, stamp in stamped:
        if spoken.time is not None:
            off = (spoken.time.of_day - stamp + DAY // 2) % DAY - DAY // 2
            differences.setdefault(spoken.system, []).append(off)
    told = []
    for system, offs in differences.items():
        # Times of day with whole seconds are cut, and so late by half of one.
        off = round(median(offs))
        if abs(off) > TOLD_NS:
            ahead = 'ahead of' if off > 0 else 'behind'
            told.append(f'the clock of {system} is {abs(off) / SECOND:.1f} s {ahead} the stamps')
    return told
