"""Rows and course of one log against another, aligned by state or in time."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.comparison.reading import Course, ReadLog, hours_of
from trawl_ros.comparison.rows import ErrorBudget, Rows
from trawl_ros.core.arrays import BoolArray, FloatArray, Slice
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.fit.linearised import measured_inputs
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED

COMPARED = (*INPUTS, *MEASURED)


@dataclass(frozen=True)
class Alignment:
    """Options of the alignment of two logs.

    Attributes
    ----------
    warp
        Largest relative difference of the warp lengths of two states that are compared.
    speed
        Largest difference of their speeds, m/s.
    stretch
        Minutes of a stretch that is compared in time.
    shift_s
        Time that is added to the second log, s; None for that of `shift_between`.
    """

    warp: float = 0.015
    speed: float = 0.05
    stretch: int = 5
    shift_s: float | None = None


def shift_between(first: Course, second: Course) -> int:
    """Return the time (ns) to add to the second log: 0 where the stamps of both overlap.

    Logs of different times, a simulation and a tow at sea for example, start together.
    """
    begin = max(first.start_ns, second.start_ns)
    end = min(one.start_ns + 60 * SECOND * one.minutes for one in (first, second))
    return 0 if begin < end else first.start_ns - second.start_ns


def by_state(first: ReadLog, second: ReadLog, options: Alignment) -> Rows:
    """Pair steady states of equal warp and speed.

    Raises
    ------
    TrawlError
        If no two states are equal.
    """
    states = [_states(log.found.windows) for log in (first, second)]
    hours = dict(zip([w.index for w in first.found.windows], hours_of(first), strict=True))
    pairs = []
    for own in states[0]:
        nearest = min(states[1], key=lambda other: _apart(own, other, options), default=None)
        if nearest is not None and _apart(own, nearest, options) <= 1.0:
            pairs.append((own, nearest))
    if not pairs:
        raise TrawlError(
            f'{first.found.name} and {second.found.name}: found {len(states[0])} and '
            f'{len(states[1])} steady states, none with equal warp and speed; expected one pair '
            f'within {100 * options.warp:g} % of warp and {options.speed:g} m/s; compare in time '
            'with --by time'
        )
    return _rows(
        values=[np.array([_means(side) for side in pair]) for pair in pairs],
        noise=[np.array([_noise(side) for side in pair]) for pair in pairs],
        hours=[float(np.mean([hours[window.index] for window in own])) for own, _ in pairs],
    )


def by_time(
    first: Course, second: Course, options: Alignment
) -> tuple[Rows, dict[str, FloatArray]]:
    """Compare stretches of time.

    Returns
    -------
    Rows
        A row for each stretch in which both have warp lengths and speed.
    dict
        The second course on the minutes of the first.

    Raises
    ------
    TrawlError
        If there is no such stretch.
    """
    course, scatter = on_minutes_of(first, second, options)
    values, noise, hours = [], [], []
    for start in range(0, first.minutes, options.stretch):
        here = slice(start, start + options.stretch)
        pair = np.array([_over(one, here, mean=True) for one in (first.values, course)])
        if np.isfinite(pair[:, : len(INPUTS)]).all():
            values.append(pair)
            noise.append(np.array([_over(one, here) for one in (first.scatter, scatter)]))
            hours.append((start + 0.5 * options.stretch) / 60.0)
    if not values:
        raise TrawlError('the two logs have no minute in common, expected some; try --shift')
    return _rows(values, noise, hours), course


def on_minutes_of(
    first: Course, second: Course, options: Alignment
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Return values and scatter (n,) of a second course on the minutes of the first."""
    shift = shift_between(first, second)
    if options.shift_s is not None:
        shift = round(options.shift_s * SECOND)
    behind = round((second.start_ns + shift - first.start_ns) / (60 * SECOND))
    minutes = np.arange(first.minutes) - behind
    there = (minutes >= 0) & (minutes < second.minutes)

    def moved(values: FloatArray) -> FloatArray:
        full = np.full(first.minutes, np.nan)
        full[there] = values[minutes[there]]
        return full

    return (
        {name: moved(values) for name, values in second.values.items()},
        {name: moved(values) for name, values in second.scatter.items()},
    )


def _states(windows: Sequence[SteadyWindow]) -> list[list[SteadyWindow]]:
    states: dict[int, list[SteadyWindow]] = {}
    for window in windows:
        states.setdefault(window.state, []).append(window)
    return list(states.values())


def _apart(one: list[SteadyWindow], other: list[SteadyWindow], options: Alignment) -> float:
    """Return the distance of two states; they may be compared up to 1."""
    here, there = _inputs(one), _inputs(other)
    port, starboard = np.abs(here / there - 1.0)[:2] / options.warp
    return max(float(port), float(starboard), abs(float(here[2] - there[2])) / options.speed)


def _inputs(windows: list[SteadyWindow]) -> FloatArray:
    inputs: FloatArray = np.array([measured_inputs(window) for window in windows]).mean(axis=0)
    return inputs


def _means(windows: list[SteadyWindow]) -> FloatArray:
    """Return means (k,) of a state's windows, NaN where none has the channel."""
    return np.array(
        [
            np.mean([w.means[name] for w in windows if name in w.means] or [np.nan])
            for name in COMPARED
        ]
    )


def _noise(windows: list[SteadyWindow]) -> FloatArray:
    """Return the std (k,) of these means, without calibration."""
    found: list[float] = []
    for name in COMPARED:
        own = [w.own_noise(name) for w in windows if name in w.means]
        changing = [CHANNELS[name].state_std(w.bias[name], 0.3) for w in windows if name in w.bias]
        noise = float(np.linalg.norm(own)) / len(own) if own else 0.0
        found.append(math.hypot(noise, max(changing, default=0.0)))
    return np.array(found)


def _over(values: Mapping[str, FloatArray], here: Slice, *, mean: bool = False) -> FloatArray:
    """Return means (k,) over some minutes, or the std of these; NaN without a reading."""
    found = np.full(len(COMPARED), np.nan)
    for column, name in enumerate(COMPARED):
        own = values[name][here] if name in values else np.zeros(0)
        own = own[np.isfinite(own)]
        if len(own):
            found[column] = own.mean() if mean else np.linalg.norm(own) / len(own)
    return found


def _rows(values: list[FloatArray], noise: list[FloatArray], hours: list[float]) -> Rows:
    """Build rows from values and noise (2, k) of each."""
    both = np.array(values)
    present: BoolArray = np.isfinite(both[:, 0]) & np.isfinite(both[:, 1])
    own = np.where(present, np.linalg.norm(np.nan_to_num(noise), axis=1), 0.0)
    filled = np.where(present[:, None], both, 0.0)
    # Each log has its own calibration, which stays through it.
    bias = np.zeros((*present.shape, 2, len(COMPARED)))
    for column, name in enumerate(COMPARED):
        for log in range(2):
            means = filled[:, log, column]
            sizes = [CHANNELS[name].bias_std(mean) for mean in means]
            bias[:, column, log, column] = np.where(present[:, column], sizes, 0.0)
    count = len(hours)
    shared = [(np.arange(count), bias.reshape(count, len(COMPARED), -1))]
    return Rows(
        channels=COMPARED,
        state=np.arange(count),
        log=np.zeros(count, dtype=np.int64),
        hours=np.array(hours),
        inputs=both[:, 0, : len(INPUTS)],
        measured=filled[:, 0],
        reference=filled[:, 1],
        present=present,
        errors=ErrorBudget(own, np.zeros((*present.shape, 1)), shared),
    )
