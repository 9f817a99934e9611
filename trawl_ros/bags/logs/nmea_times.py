"""Times of NMEA 0183 sentences, of which only some state one.

A sentence with a time has that; the date comes from RMC or ZDA. One without has the time said
last; where the same comes several times before the next time is said, as headings do, they
spread evenly over the interval.
"""

from collections import Counter, defaultdict
from datetime import date, datetime, time, timedelta
from itertools import pairwise
from statistics import median
from typing import Any

from trawl_ros.bags.logs.clock import LATEST
from trawl_ros.core.time import SECOND

TIMING = ('RMC', 'ZDA', 'GGA', 'GLL', 'GNS')
"""Sentences that say a time."""

_EPOCH = datetime(1970, 1, 1)
_DAY = timedelta(days=1)


class SentenceTimes:
    """Clock that follows the times in sentences.

    Parameters
    ----------
    day
        Date of the first time, where no sentence says it; None if there is none.
    """

    def __init__(self, day: date | None) -> None:
        self._now = datetime.combine(day, time(0)) if day else None
        self.moments: list[int] = []
        """Stamps (ns) in the order in which they were said, each once."""
        self.unused: Counter[str] = Counter()
        """Sentences whose time says nothing, by reason."""
        self.impossible: Counter[str] = Counter()
        """Sentences whose time cannot be, by reason."""
        self.undated = 0
        """Sentences that say a time of day before any date."""

    def hear(self, sentence: Any) -> int | None:
        """Update by a sentence; return its own stamp (ns), None if it has none."""
        stated = self._said(sentence)
        if stated is None:
            return None
        stamp = (stated - _EPOCH) // timedelta(microseconds=1) * 1000
        if not 0 <= stamp < LATEST:
            self.impossible[f'{sentence.msgID} of a year that cannot be'] += 1
            return None
        self._now = stated
        if not self.moments or self.moments[-1] != stamp:
            self.moments.append(stamp)
        return stamp

    def _said(self, sentence: Any) -> datetime | None:
        kind = sentence.msgID
        of_day = getattr(sentence, 'time', '')
        if kind not in TIMING or not isinstance(of_day, time):
            return None
        if kind == 'RMC' and sentence.status != 'A':
            # Without a fix the date may be the one the receiver was born with.
            self.unused['RMC without a fix'] += 1
            return None
        if (day := _day_of(sentence)) is not None:
            return datetime.combine(day, of_day)
        if self._now is not None:
            return self._nearest(of_day, self._now)
        self.undated += 1
        self.unused[f'{kind} with a time of day and no date'] += 1
        return None

    def _nearest(self, of_day: time, now: datetime) -> datetime:
        """Give the time of day on the day that brings it nearest to the last one."""
        if not self.moments:
            return datetime.combine(now.date(), of_day)
        days = (now.date() - _DAY, now.date(), now.date() + _DAY)
        return min((datetime.combine(day, of_day) for day in days), key=lambda t: abs(t - now))


def _day_of(sentence: Any) -> date | None:
    """Give the date that an RMC or ZDA says; None without one."""
    if sentence.msgID == 'RMC':
        day = getattr(sentence, 'date', '')
        return day if isinstance(day, date) else None
    try:
        return date(sentence.year, sentence.month, sentence.day)
    except (AttributeError, TypeError, ValueError):
        return None


def spread_stamps(moments: list[int], heard: list[tuple[int, Any]]) -> list[int]:
    """Assign stamps to sentences without a time.

    Parameters
    ----------
    moments
        All times said, ns.
    heard
        For each thing, which of these was said last, and what kind of thing it is.

    Returns
    -------
    list of int
        Stamps, ns: that of the moment, and where the same kind came several times, evenly
        between it and the next. An interval longer than usual counts as the usual one.
    """
    steps = [after - before for before, after in pairwise(moments) if after > before]
    usual = round(median(steps)) if steps else SECOND
    totals: dict[tuple[int, Any], int] = defaultdict(int)
    for key in heard:
        totals[key] += 1
    counted: dict[tuple[int, Any], int] = defaultdict(int)
    stamps = []
    for key in heard:
        number = key[0]
        step = moments[number + 1] - moments[number] if number + 1 < len(moments) else usual
        step = min(step, usual) if step > 0 else usual
        stamps.append(moments[number] + step * counted[key] // totals[key])
        counted[key] += 1
    return stamps
