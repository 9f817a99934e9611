"""Stretches of a tow that goes on: the newest cut out of the readings of the last minutes."""

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.motion.records import MovingTow
from trawl_ros.estimation.motion.series import Series, TowReadings, tow_readings
from trawl_ros.estimation.motion.stretches import FEWEST, StretchOptions, moving_tow
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.records.samples import Sample, WinchSample

LIVE = StretchOptions(step_s=3.0, stretch_s=30.0, settling_s=0.0, knot_s=30.0, counter_knot_s=90.0)
"""Stretches as they are watched; nothing is left out at their beginning, see `LastStretch`."""

LAG_S = 15.0
"""Time for which readings of a stretch are waited for."""

MOST_SAMPLES = 200_000
"""Samples that are kept at most: more than all instruments say in the time that is looked back."""

LOST_S = 1800.0
"""A longer silence of the winches ends a tow; stretches within it are not counted one by one."""


RUNNING_M_S, CHANGED_M_S = 0.05, 0.05
"""Warps that are faster run; a speed that is another by more within a stretch changes."""

UNHEARD_LOG = 0.02
"""Standard error (m/s) of the log's mean where it is not heard."""


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
    why_not: str = ''


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

    def feed(self, sample: Sample) -> Iterator[LastStretch]:
        """Take a sample; yield the stretches that it ends."""
        self._samples.append(sample)
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
            aligned = _from(read, begin)
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
        return replace(
            last, tow=tow, place=int(place), log_std=log_std, moves=_moves(tow, int(place))
        )


def _moves(tow: MovingTow, place: int) -> tuple[bool, bool]:
    steps = round(tow.stretch_s / tow.inputs.grid_s)
    own = slice(place * steps, (place + 1) * steps + 1)
    running = np.max(np.abs(tow.inputs.rates[own, :2])) > RUNNING_M_S
    first, *_, last = np.array_split(tow.inputs.values[own, 2], 3)
    return bool(running), bool(abs(last.mean() - first.mean()) > CHANGED_M_S)


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
