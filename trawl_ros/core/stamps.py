# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Validation of stamps: which stamp can be the time of a measurement, and which cannot.

Times are ns since 1970-01-01 UTC. A simulation counts from zero, so stamps within the first year
are valid. Measurements lie between 1990 and tomorrow. Other times come from receivers without a
fix, loggers without a battery, drivers that never stamp, a GPS week rollover (1024 weeks), and a
date that changes a second late.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from itertools import pairwise
from time import time_ns
from typing import Generic, TypeVar

import numpy as np

from trawl_ros.core.arrays import BoolArray, StampArray
from trawl_ros.core.time import SECOND

MessageT = TypeVar('MessageT')

DAY_NS = 86_400 * SECOND

END_NS = 2**31 * SECOND
"""Stamps (ns) end here: messages count seconds in 32 bits."""

SIMULATED_UNTIL = 365 * DAY_NS
"""Stamps (ns) below this may be of a simulation, which counts from zero."""

EARLIEST_NS = 631_152_000 * SECOND
"""1990-01-01: no log of sentences or bag is older."""

MARGIN_NS = DAY_NS
"""Largest advance of a stamp over the clock of this machine: clocks and time zones differ."""

BAG_APART_NS = 30 * DAY_NS
"""Longest pause in one recording."""

LOG_APART_NS = 730 * DAY_NS
"""Longest pause in one log: a log book may contain two seasons."""

FAR_NS = 60 * SECOND
"""Difference from the last stamp of a topic from which a stamp may be false."""

CONFIRMING_READINGS = 3
"""Number of consecutive stamps that confirm a leap."""

UNSTAMPED = '0, as of a driver that never stamps'
FUTURE = 'in the future, by the clock of this machine'
ELSEWHERE = 'far from the rest'
EXCURSION = 'of another hour or day than those before and behind'
MAX_LEAPS = 10
"""Number of leaps above which few stamps are in no order; many stamps may have a 50th."""

MIN_UNSTAMPED = 3
"""Number of zero stamps, without any others, that cannot come from a simulation."""


def when(stamp: int) -> str:
    """Format a stamp (ns) as UTC date and time, or in seconds if it is no valid date."""
    try:
        time = datetime(1970, 1, 1) + timedelta(microseconds=stamp // 1000)
    except OverflowError:
        return f'{stamp // SECOND} s'
    return f'{time:%Y-%m-%d %H:%M:%S}'


def lasting(ns: int) -> str:
    """Format a time span (ns) in a suitable unit."""
    seconds = abs(ns) / SECOND
    for size, unit in ((365.25 * 86_400, 'years'), (86_400, 'days'), (3600, 'h'), (60, 'min')):
        if seconds >= 2 * size:
            return f'{seconds / size:.4g} {unit}'
    return f'{seconds:.4g} s'


def impossible_time(stamp: int) -> str | None:
    """Return why a stamp (ns) cannot be the time of a measurement; None if it can."""
    if stamp < 0:
        return 'before 1970'
    if SIMULATED_UNTIL <= stamp < EARLIEST_NS:
        return 'before 1990'
    if stamp >= EARLIEST_NS and stamp > time_ns() + MARGIN_NS:
        return FUTURE
    return None


@dataclass(frozen=True)
class StampJudgement:
    """Validation of the stamps of one recording.

    ``false`` (n,) marks invalid stamps and ``reasons`` counts them. ``span`` is the first and last
    valid stamp (ns), None without any. ``set_back`` are backward steps of the clock, each with the
    stamps (ns) before and after it.
    """

    false: BoolArray
    reasons: Mapping[str, int]
    span: tuple[int, int] | None
    set_back: tuple[tuple[int, int], ...] = ()

    def sentences(self) -> list[str]:
        """Describe the findings, one sentence for each reason."""
        usual = f'; the others are of {when(self.span[0])}' if self.span else ''
        found = [f'{count} stamps are {why}{usual}' for why, count in self.reasons.items()]
        for before, after in self.set_back:
            found.append(f'the clock was set back by {lasting(before - after)} at {when(before)}')
        return found


def judge_stamps(
    stamps: StampArray, *, apart_ns: int = BAG_APART_NS, in_order: bool = False
) -> StampJudgement:
    """Validate the stamps (n,) of one recording, by possible times and by the majority.

    Parameters
    ----------
    stamps
        Stamps, ns.
    apart_ns
        Longest pause between them.
    in_order
        True if they are in the order of writing. Short runs that leap away and back are then false
        too.
    """
    false = np.zeros(len(stamps), dtype=bool)
    reasons: Counter[str] = Counter()
    for chosen, why, usual in _by_era(stamps, apart_ns):
        if why:
            false[chosen] = not usual
            reasons[why] += len(chosen)
    if in_order and (excursions := _excursions(stamps[~false])).any():
        false[np.flatnonzero(~false)[excursions]] = True
        reasons[EXCURSION] += int(np.count_nonzero(excursions))
    true = stamps[~false]
    span = (int(true.min()), int(true.max())) if len(true) else None
    return StampJudgement(false, reasons, span, _set_back(true) if in_order else ())


def _by_era(stamps: StampArray, apart_ns: int) -> list[tuple[StampArray, str, bool]]:
    """Split stamps at long pauses; return indices, fault or '', and True for the recording.

    The recording is the possible part with most stamps. There is none if no part is possible.
    """
    if not len(stamps):
        return []
    order = np.argsort(stamps, kind='stable')
    # As floats, because differences of extreme 64-bit numbers overflow.
    pauses = np.diff(stamps[order].astype(float))
    parts = np.split(order, np.flatnonzero(pauses > apart_ns) + 1)
    judged = []
    for part in parts:
        first, last = int(stamps[part[0]]), int(stamps[part[-1]])
        unstamped = last == 0 == first and (len(parts) > 1 or len(part) >= MIN_UNSTAMPED)
        judged.append((part, UNSTAMPED if unstamped else impossible_time(last) or ''))
    # If all stamps are in the future, the clock of this machine may be wrong.
    possible = [part for part, why in judged if why in ('', FUTURE)]
    possible = [part for part, why in judged if not why] or possible
    usual = max(possible, key=len) if possible else None
    return [
        (part, why or ('' if part is usual else ELSEWHERE), part is usual) for part, why in judged
    ]


def _excursions(stamps: StampArray) -> BoolArray:
    """Mark runs of stamps (n,) that leap by more than `FAR_NS` and back again.

    Of three runs the middle one is an excursion if it is shorter than both others and the third
    continues the first. With too many leaps the stamps are in no order, and none is marked.
    """
    away = np.zeros(len(stamps), dtype=bool)
    leaps = np.flatnonzero(abs(np.diff(stamps)) > FAR_NS) + 1
    if not 2 <= len(leaps) <= max(MAX_LEAPS, len(stamps) // 50):
        return away
    bounds = [0, *leaps.tolist(), len(stamps)]
    runs = list(pairwise(bounds))
    before = runs[0]
    for here, behind in zip(runs[1:], [*runs[2:], None], strict=True):
        if behind is not None:
            last, first = int(stamps[before[1] - 1]), int(stamps[behind[0]])
            leap = abs(int(stamps[here[0]]) - last)
            size = here[1] - here[0]
            shorter = size < before[1] - before[0] and size < behind[1] - behind[0]
            if shorter and 0 <= first - last < leap / 2:
                away[here[0] : here[1]] = True
                continue
        before = here
    return away


def _set_back(stamps: StampArray) -> tuple[tuple[int, int], ...]:
    """Return the backward steps of more than `FAR_NS`; none if stamps are in no order."""
    places = np.flatnonzero(np.diff(stamps) < -FAR_NS)
    if len(places) > max(MAX_LEAPS, len(stamps) // 50):
        return ()
    return tuple((int(stamps[place]), int(stamps[place + 1])) for place in places)


class Leaps(Generic[MessageT]):
    """Filter of leaping stamps, which holds back messages until enough stamps agree.

    Parameters
    ----------
    far_ns
        Largest difference of agreeing stamps, ns.
    """

    def __init__(self, far_ns: int = FAR_NS) -> None:
        self._far = far_ns
        self._newest: int | None = None
        self._held: list[tuple[int, MessageT]] = []

    def take(self, stamp: int, message: MessageT) -> tuple[list[MessageT], list[MessageT]]:
        """Filter the next message.

        Returns
        -------
        list
            Messages that can be used now, in order of arrival.
        list
            Held messages that turned out to have false stamps.
        """
        held, self._held = self._held, []
        if self._newest is None or abs(stamp - self._newest) <= self._far:
            self._newest = stamp
            return [message], [waiting for _, waiting in held]
        agreeing = [waiting for waiting in held if abs(stamp - waiting[0]) <= self._far]
        false = [waiting[1] for waiting in held if abs(stamp - waiting[0]) > self._far]
        self._held = [*agreeing, (stamp, message)]
        if len(self._held) < CONFIRMING_READINGS:
            return [], false
        self._newest = stamp
        messages, self._held = [message for _, message in self._held], []
        return messages, false

    def give_up(self) -> list[MessageT]:
        """Return the held messages, which no other stamp has confirmed."""
        held, self._held = self._held, []
        return [message for _, message in held]
