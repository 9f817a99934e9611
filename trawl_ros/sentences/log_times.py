# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Times of the sentences of a log, of which only some state one.

A sentence of the ship with a time has that time; the date comes from RMC or ZDA. A sentence without
a time has the last stated time. If the same sentence comes several times before the next stated
time, as headings do, its stamps spread evenly over the interval.
"""

from collections import Counter, defaultdict
from collections.abc import Hashable, Sequence
from itertools import pairwise
from statistics import median

from trawl_ros.core.stamps import DAY_NS, END_NS
from trawl_ros.core.time import SECOND
from trawl_ros.sentences.codec import Spoken
from trawl_ros.sentences.fields import SaidTime


class ShipTimes:
    """Clock that follows the times in the ship's sentences.

    Parameters
    ----------
    start
        Midnight (ns) of the day of the first time, where no sentence says it; None without one.
    """

    def __init__(self, start: int | None) -> None:
        # Every time of day is nearest to noon on that same day.
        self._near = None if start is None else start + DAY_NS // 2
        self.moments: list[int] = []
        """Stamps (ns) in the order in which they were said, each once."""
        self.unused: Counter[str] = Counter()
        """Sentences whose time is not used, by reason."""
        self.impossible: Counter[str] = Counter()
        """Sentences whose time cannot be, by reason."""
        self.undated = 0
        """Sentences that say a time of day before any date."""

    def hear(self, spoken: Spoken, kind: str) -> int | None:
        """Update by a sentence of some kind (as RMC); return its own stamp (ns) or None."""
        if spoken.time is None:
            return None
        if not spoken.valid and spoken.time.day is not None:
            # Without a fix the date may be the one the receiver was made with.
            self.unused[f'{kind} without a fix'] += 1
            return None
        stamp = spoken.time.stamp(self._near)
        if stamp is None:
            self.undated += 1
            self.unused[f'{kind} with a time of day and no date'] += 1
            return None
        if not 0 <= stamp < END_NS:
            self.impossible[f'{kind} of an impossible year'] += 1
            return None
        self._near = stamp
        if not self.moments or self.moments[-1] != stamp:
            self.moments.append(stamp)
        return stamp


def stamps_by_own_times(
    times: Sequence[SaidTime | None], given: Sequence[int | None], start: int | None
) -> list[int | None]:
    """Assign stamps to sentences where the ship says no time.

    Parameters
    ----------
    times
        Time that each sentence says, or None.
    given
        Stamp (ns) that it has already, or None.
    start
        Midnight (ns) before the log begins, for times of day without any other date.

    Returns
    -------
    list of int or None
        Stamps, ns: the time that a sentence says, or the time said last; None before the first.
    """
    near = None if start is None else start + DAY_NS // 2
    last: int | None = None
    stamps: list[int | None] = []
    for time, stamp in zip(times, given, strict=True):
        if stamp is None and time is not None:
            said = time.stamp(near)
            if said is not None and 0 <= said < END_NS:
                near = last = said
        stamps.append(last if stamp is None else stamp)
    return stamps


def spread_stamps(moments: Sequence[int], heard: Sequence[tuple[int, Hashable]]) -> list[int]:
    """Assign stamps to sentences without a time.

    Parameters
    ----------
    moments
        All times said, ns.
    heard
        For each sentence, which of these was said last, and what kind of sentence it is.

    Returns
    -------
    list of int
        Stamps, ns: that of the moment, and where the same kind came several times, evenly
        between it and the next. An interval longer than usual counts as the usual one.
    """
    steps = [after - before for before, after in pairwise(moments) if after > before]
    usual = round(median(steps)) if steps else SECOND
    totals = Counter(heard)
    counted: dict[tuple[int, Hashable], int] = defaultdict(int)
    stamps = []
    for key in heard:
        number = key[0]
        step = moments[number + 1] - moments[number] if number + 1 < len(moments) else usual
        step = min(step, usual) if step > 0 else usual
        stamps.append(moments[number] + step * counted[key] // totals[key])
        counted[key] += 1
    return stamps
