# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Stretches of a tow: means of its readings, and the inputs that it was towed with."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.motion.fallen import fallen_stretches
from trawl_ros.estimation.motion.processes import STATE_SHARE, ErrorTimes
from trawl_ros.estimation.motion.series import Series, TowReadings
from trawl_ros.estimation.motion.swell import swell_of
from trawl_ros.estimation.motion.towing.inputs import TowInputs, on_grid, stacked
from trawl_ros.estimation.motion.towing.knots import knots_of_counter, knots_of_log
from trawl_ros.estimation.motion.towing.records import LeftOut, MovingTow
from trawl_ros.estimation.windows.operation import Block, Operation
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED

GRID_S = 1.0
"""Step of the grid on which inputs are smoothed."""

REACH_S = 10.0
"""Reach over which speed and heading are smoothed."""

PAYOUT_REACH_S, STANDING_M_S = 2.0, 0.02
"""Reach over which pay-out speeds are smoothed; a winch slower than this stands."""

COUNTER_REACH_S = 600.0
"""Reach over which counters correct the course that pay-out speeds give."""

LEVEL_STEP_S = 10.0
"""Step of the grid on which they do."""

STEADY_ONLY = ('vertical_opening',)
"""Measured channels that count while the gear is steady only: an opening is stamped when its sweep
begins."""

FEWEST = 10
"""Stretches that count in a tow, at least."""

LONGEST_S = 21_600.0
"""Longest tow: memory grows with the square of its length."""


@dataclass(frozen=True)
class StretchOptions:
    """Options of stretches.

    Attributes
    ----------
    step_s, stretch_s
        Step in which a tow is towed; length of a stretch, a whole number of steps.
    settling_s
        Time after the beginning whose stretches do not count unless they are steady: what the gear
        did before is not known. 0 for a tow that begins at rest.
    knot_s, counter_knot_s
        Time between knots of the errors of log and counters.
    counter_std_m, counter_time_s
        Std and correlation time of the errors of counters along the way, assumed.
    memory_s
        Time after which the gear has forgotten an error.
    """

    step_s: float = 2.0
    stretch_s: float = 20.0
    settling_s: float = 300.0
    knot_s: float = 20.0
    counter_knot_s: float = 60.0
    counter_std_m: float = 0.5
    counter_time_s: float = 600.0
    memory_s: float = 160.0


def moving_tow(read: TowReadings, name: str, options: StretchOptions) -> MovingTow:
    """Divide a tow into stretches.

    Parameters
    ----------
    read
        Its readings.
    name
        For people.
    options
        Of stretches.

    Raises
    ------
    TrawlError
        If an input falls silent on the way, or the tow is too short.
    """
    for channel in INPUTS:
        times = read.series[channel].times
        gap = float(np.max(np.diff(times)))
        if gap > CHANNELS[channel].longest_gap:
            raise TrawlError(
                f'{name}: {channel} ({CHANNELS[channel].topic}) is silent for {gap:.0f} s, '
                f'expected {CHANNELS[channel].longest_gap:g} s at most: the model cannot be towed '
                'along'
            )
    number = int(read.duration_s / options.stretch_s)
    settling = int(np.ceil(options.settling_s / options.stretch_s))
    if number < settling + FEWEST:
        raise TrawlError(
            f'{name}: lasts {read.duration_s:.0f} s, expected at least '
            f'{(settling + FEWEST) * options.stretch_s:.0f} s'
        )
    if read.duration_s > LONGEST_S:
        raise TrawlError(
            f'{name}: lasts {read.duration_s:.0f} s, expected at most {LONGEST_S:.0f} s; '
            'cut it into parts'
        )
    channels = tuple(c for c in MEASURED if c in read.series)
    parts = [_means(read.series[c], number, options) for c in channels]
    means, noise, counts, weights = (np.stack(part, axis=1) for part in zip(*parts, strict=True))
    inputs = _inputs(read, number * options.stretch_s, options)
    held_s = held_times(inputs, number, options.stretch_s)
    steady = held_s > 0.0
    settling = min([settling, *np.flatnonzero(steady)[:1].tolist()])
    means[:settling] = np.nan
    why = 'what the gear did before is not known'
    left_out = (LeftOut(0.0, settling * options.stretch_s, why),) if settling else ()
    for column, channel in enumerate(channels):
        if channel in STEADY_ONLY:
            means[~steady, column] = np.nan
    return MovingTow(
        name, read.start_ns, options.step_s, options.stretch_s, channels, means, noise,
        counts.astype(np.int64), weights, inputs,
        left_out, fallen_stretches(read.fallen, options.stretch_s, number),
        swell_of(read, options.stretch_s), held_s,
    )  # fmt: skip


def held_times(inputs: TowInputs, number: int, stretch_s: float) -> FloatArray:
    """Time (number,) for which inputs have been held at the end of each stretch, in s.

    It is 0 of stretches at whose end no steady window may lie. The criteria are those of the window
    finder: inputs are held as long as the gear takes to settle, and for a window.
    """
    options = WindowOptions()
    operation, size = Operation(options), round(options.block_s / inputs.grid_s)
    blocks = len(inputs.values) // size
    held = np.zeros(number)
    for block in range(blocks):
        own = slice(block * size, (block + 1) * size)
        port, starboard, speed = map(float, np.median(inputs.values[own], axis=0))
        heading = float(np.median(inputs.headings[own]))
        operation.add(Block(block, (port, starboard, speed), heading, None))
        # The last block of a stretch decides on it.
        stretch = int((block + 1.5) * options.block_s / stretch_s) - 1
        if 0 <= stretch < number and operation.full:
            steady = operation.unheld() is None
            held[stretch] = operation.settle_s + options.window_s if steady else 0.0
    return held


def _means(
    series: Series, number: int, options: StretchOptions
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Means, their noise and counts (n,), and weights (n, s + 1) of the instants."""
    steps = round(options.stretch_s / options.step_s)
    inside = (series.times >= 0.0) & (series.times < number * options.stretch_s)
    times, values = series.times[inside], series.values[inside]
    stretches = (times / options.stretch_s).astype(int)
    counts = np.bincount(stretches, minlength=number).astype(float)
    some = np.where(counts > 0.0, counts, np.nan)
    means = np.bincount(stretches, values, minlength=number) / some
    places = (times - stretches * options.stretch_s) / options.step_s
    first = np.minimum(places.astype(int), steps - 1)
    weights = np.zeros((number, steps + 1))
    np.add.at(weights, (stretches, first), (1.0 - (places - first)) / counts[stretches])
    np.add.at(weights, (stretches, first + 1), (places - first) / counts[stretches])
    return means, series.noise / np.sqrt(some), counts, weights


def _inputs(read: TowReadings, duration_s: float, options: StretchOptions) -> TowInputs:
    grid = np.arange(0.0, duration_s + 0.5 * GRID_S, GRID_S)
    log = read.series['speed']
    paths = [
        *(
            warp_path(read.series[name], payout, grid)
            for name, payout in zip(INPUTS[:2], read.payout, strict=True)
        ),
        on_grid(log.times, log.values, grid, REACH_S),
    ]
    headings, yaw_rates = np.zeros((2, len(grid)))
    if 'heading' in read.series:
        compass = read.series['heading']
        headings, yaw_rates = on_grid(compass.times, np.unwrap(compass.values), grid, REACH_S)
    end, memory = float(grid[-1]), options.memory_s
    std, time = options.counter_std_m, options.counter_time_s
    bias = CHANNELS['speed'].bias_std(float(np.median(log.values)))
    knots = (
        knots_of_log(
            log.times, log.noise, end, options.knot_s, memory,
            slow_std=CHANNELS['speed'].state_std(bias, STATE_SHARE),
            slow_time_s=ErrorTimes().state,
        ),
        *(
            knots_of_counter(name, std, time, end, options.counter_knot_s, memory)
            for name in INPUTS[:2]
        ),
    )  # fmt: skip
    values, rates = stacked(paths)
    return TowInputs(GRID_S, values, rates, headings, yaw_rates, knots, read.hours)


def warp_path(counter: Series, payout: Series, grid: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Warp length and its rate (t,) on a grid (t,).

    The course comes from the pay-out speed, the level from the counter. So no warp moves where a
    counter jumps while its winch stands.
    """
    way, speeds = paid_out(payout, grid)
    rest = counter.values - np.interp(counter.times, grid, way)
    level = _level(counter.times, rest, grid)
    return way + level, speeds + np.gradient(level, grid)


def paid_out(payout: Series, grid: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Warp that has run out since the beginning of a grid (t,), and its speed (t,)."""
    speeds, _ = on_grid(payout.times, payout.values, grid, PAYOUT_REACH_S)
    speeds[np.abs(speeds) < STANDING_M_S] = 0.0
    return np.asarray(cumulative_trapezoid(speeds, grid, initial=0.0), np.float64), speeds


def _level(times: FloatArray, values: FloatArray, grid: FloatArray) -> FloatArray:
    """Mean (t,) of values (n,) about each of a grid's times, with tricube weights."""
    places = np.append(np.arange(grid[0], grid[-1], LEVEL_STEP_S), grid[-1])
    means = np.empty(len(places))
    for number, place in enumerate(places):
        first, last = np.searchsorted(times, (place - COUNTER_REACH_S, place + COUNTER_REACH_S))
        weights = level_weights(times[first:last] - place)
        means[number] = np.average(values[first:last], weights=weights)
    level: FloatArray = np.interp(grid, places, means)
    return level


def level_weights(away: FloatArray) -> FloatArray:
    """Tricube weights (n,) of a counter's readings in its level so many seconds (n,) away."""
    weights: FloatArray = (1.0 - np.minimum(np.abs(away / COUNTER_REACH_S), 1.0) ** 3) ** 3
    return weights
