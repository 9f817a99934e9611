# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Stretches of a tow that goes on: the newest cut out of the readings of the last minutes."""

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.motion.fallen import FallRecorder
from trawl_ros.estimation.motion.series import Series, TowReadings, tow_readings
from trawl_ros.estimation.motion.stretches import (
    FEWEST,
    StretchOptions,
    level_weights,
    moving_tow,
    paid_out,
)
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.records.samples import AttitudeSample, Sample, WinchSample

LIVE = StretchOptions(step_s=3.0, stretch_s=30.0, settling_s=0.0, knot_s=30.0, counter_knot_s=90.0)
"""Stretches as they are watched; nothing is left out at their beginning, see `LastStretch`."""

LAG_S = 15.0
"""Time for which readings of a stretch are waited for."""

MOST_SAMPLES = 200_000
"""Samples that are kept at most: more than all instruments say in the time that is looked back."""

MOST_ATTITUDES = 20_000
"""Readings of an inclinometer that tell whether it is mounted otherwise: hours, for a board may lie
through all of the time that is looked back.
"""

LOST_S = 1800.0
"""A longer silence of the winches ends a tow; stretches within it are not counted one by one."""


RUNNING_M_S, CHANGED_M_S = 0.05, 0.04
"""Warps that are faster run; a speed is another one that is so far from what it was."""

LEAP_S = 10.0
"""Time before the beginning and the end of a stretch whose counts are compared."""

UNSEEN_LEAP_M, PAYOUT_STD = 0.1, 0.003
"""Std of a leap that cannot be seen, m; and of what a winch pays out in a stretch, as a part."""

UNHEARD_LOG = 0.02
"""Standard error (m/s) of the log's mean where it is not heard."""


@dataclass(frozen=True)
class CounterLeap:
    """Leap of a counter in a stretch, beyond what its winch paid out.

    ``length`` and ``std`` are in m.
    """

    length: float = 0.0
    std: float = UNSEEN_LEAP_M


@dataclass(frozen=True)
class LastStretch:
    """Newest stretch of a tow: the ``number``-th since it began.

    ``tow`` has it as its ``place``-th, behind those of the minutes before, and ``log_std`` (m/s) is
    the standard error of the log's mean in it. ``moves`` is true where warps run, and where the
    speed changes in it. The tow is None where there is no such stretch, and ``why_not`` the reason.
    """

    number: int
    start_ns: int
    end_ns: int
    tow: MovingTow | None = None
    place: int = 0
    log_std: float = UNHEARD_LOG
    moves: tuple[bool, bool] = (False, False)
    leaps: tuple[CounterLeap, CounterLeap] = (CounterLeap(), CounterLeap())
    why_not: str = ''

    @property
    def fell(self) -> bool:
        """True where a board fell in it, or in the minutes before: no model may begin there."""
        return self.tow is not None and any(each <= self.place for each in self.tow.fallen)


class StretchCutter:
    """Cutter of stretches from samples as they come in.

    Parameters
    ----------
    pressure_to_depth
        Depth (m) for an absolute pressure (Pa).
    options
        Of stretches.
    """

    def __init__(
        self, pressure_to_depth: Callable[[float], float], options: StretchOptions = LIVE
    ) -> None:
        self._depth, self._options = pressure_to_depth, options
        self._samples: deque[Sample] = deque(maxlen=MOST_SAMPLES)
        self._origin: int | None = None
        self._number = 0
        self._held_speed: float | None = None
        self._falls = FallRecorder(MOST_ATTITUDES)

    def feed(self, sample: Sample) -> Iterator[LastStretch]:
        """Take a sample; yield the stretches that it ends."""
        self._samples.append(sample)
        if isinstance(sample, AttitudeSample):
            self._falls.feed(sample)
        if not isinstance(sample, WinchSample):
            return
        if self._origin is None:
            self._origin = sample.stamp
        length = round(self._options.stretch_s * SECOND)
        if sample.stamp > self._end(self._number) + LOST_S * SECOND:
            self._number = (sample.stamp - self._origin) // length
        while sample.stamp >= self._end(self._number) + LAG_S * SECOND:
            yield self._cut(self._number)
            self._number += 1

    def _end(self, number: int) -> int:
        assert self._origin is not None
        return self._origin + (number + 1) * round(self._options.stretch_s * SECOND)

    def _cut(self, number: int) -> LastStretch:
        length = round(self._options.stretch_s * SECOND)
        end, late = self._end(number), round(LAG_S * SECOND)
        oldest = end - (FEWEST + 1) * length
        while self._samples and self._samples[0].stamp < oldest - late:
            self._samples.popleft()
        last = LastStretch(number, end - length, end)
        near = [one for one in self._samples if oldest <= one.stamp <= end + late]
        try:
            read = tow_readings(near, self._depth, 'the tow')
            begin = oldest
            while begin < read.start_ns:
                begin += length
            fallen = self._falls.stamps(end + late)
            aligned = replace(
                _from(read, begin), fallen=tuple((stamps - begin) / SECOND for stamps in fallen)
            )
            tow = moving_tow(aligned, 'the tow', self._options)
        except TrawlError as reason:
            if number < FEWEST:
                return replace(last, why_not='the tow has just begun')
            return replace(last, why_not=str(reason))
        place = (end - length - begin) // length
        if not 0 <= place < len(tow):
            return replace(last, why_not='counters, log or winches are silent')
        times = aligned.series['speed'].times
        inside = (times >= place * self._options.stretch_s) & (
            times < (place + 1) * self._options.stretch_s
        )
        count = max(int(inside.sum()), 1)
        log_std = aligned.series['speed'].noise / count**0.5
        since = place * self._options.stretch_s
        port, starboard = (
            counter_leap(aligned.series[name], payout, since, since + self._options.stretch_s)
            for name, payout in zip(INPUTS[:2], aligned.payout, strict=True)
        )
        return replace(
            last, tow=tow, place=int(place), log_std=log_std, moves=self._moves(tow, int(place)),
            leaps=(port, starboard),
        )  # fmt: skip

    def _moves(self, tow: MovingTow, place: int) -> tuple[bool, bool]:
        steps = round(tow.stretch_s / tow.inputs.grid_s)
        own = slice(place * steps, (place + 1) * steps + 1)
        running = np.max(np.abs(tow.inputs.rates[own, :2])) > RUNNING_M_S
        speed = float(np.mean(tow.inputs.values[own, 2]))
        changed = self._held_speed is not None and abs(speed - self._held_speed) > CHANGED_M_S
        if changed or self._held_speed is None:
            self._held_speed = speed
        return bool(running), changed


def counter_leap(counter: Series, payout: Series, begin: float, end: float) -> CounterLeap:
    """Leap of a counter between two times (s), beside what its winch paid out."""
    grid = np.arange(begin - LEAP_S, end + 0.5)
    way, _ = paid_out(payout, grid)
    rest = counter.values - np.interp(counter.times, grid, way)
    first, last = (
        rest[(counter.times >= time - LEAP_S) & (counter.times < time)] for time in (begin, end)
    )
    if not len(first) or not len(last):
        return CounterLeap()
    scatter = counter.noise * (1.0 / len(first) + 1.0 / len(last)) ** 0.5
    length = float(np.mean(last) - np.mean(first))
    return CounterLeap(length, float(np.hypot(scatter, PAYOUT_STD * np.ptp(way))))


@cache
def counter_leap_shares(number: int) -> FloatArray:
    """Part (number,) of a counter's leap that the course of each stretch since has followed.

    It leaps in the middle of the first. The level of a course is a mean of the minutes before.
    """
    end = LIVE.stretch_s
    times = np.arange(-FEWEST * LIVE.stretch_s, end + LAG_S) + 0.5
    weights = level_weights(times - 0.5 * end)
    leapt = 0.5 * end - end * np.arange(number)
    after = times >= leapt[:, None]
    return np.asarray((after * weights).sum(axis=1) / weights.sum(), np.float64)


def _from(read: TowReadings, begin: int) -> TowReadings:
    """Readings with times from a stamp (ns) on."""
    shift = (begin - read.start_ns) / SECOND

    def later(series: Series) -> Series:
        inside = series.times >= shift
        return replace(series, times=series.times[inside] - shift, values=series.values[inside])

    series = {name: later(known) for name, known in read.series.items()}
    for name in INPUTS:
        if not len(series[name]):
            raise TrawlError(f'{CHANNELS[name].topic} is silent')
    port, starboard = map(later, read.payout)
    kept = {name: known for name, known in series.items() if len(known)}
    return TowReadings(begin, kept, (port, starboard))
