# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rows and course of one log against another, aligned by state or in time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.comparison.reading import MINUTE_NS, Course, ReadLog
from trawl_ros.comparison.rows import ErrorBudget, Rows
from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
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
    end = min(one.start_ns + MINUTE_NS * one.minutes for one in (first, second))
    return 0 if begin < end else first.start_ns - second.start_ns


def by_state(first: ReadLog, second: ReadLog, options: Alignment) -> Rows:
    """Pair steady states of equal warp and speed.

    Raises
    ------
    TrawlError
        If no two states are equal.
    """
    states, others = _states(first), _states(second)
    pairs = []
    for own in states:
        apart = [_apart(first.course, own, second.course, other, options) for other in others]
        if apart and min(apart) <= 1.0:
            pairs.append((own, others[apart.index(min(apart))]))
    if not pairs:
        raise TrawlError(
            f'{first.found.name} and {second.found.name}: found {len(states)} and {len(others)} '
            f'steady states, none with equal warp and speed; expected one pair within '
            f'{100 * options.warp:g} % of warp and {options.speed:g} m/s; compare in time '
            'with --by time'
        )
    return _rows(first.course, second.course, pairs)


def by_time(first: Course, second: Course, options: Alignment) -> Rows:
    """Compare stretches of time of a course and another on its minutes.

    Raises
    ------
    TrawlError
        If there is no stretch in which both have warp lengths and speed.
    """
    missing = np.full(first.minutes, np.nan)
    both = [one.values.get(name, missing) for one in (first, second) for name in INPUTS]
    there = np.isfinite(both).all(axis=0)
    stretches = np.arange(first.minutes) // options.stretch
    pairs = [(own, own) for own in (np.flatnonzero(there & (stretches == one)) for one in
                                    np.unique(stretches[there]))]  # fmt: skip
    if not pairs:
        raise TrawlError('the two logs have no minute in common, expected some; try --shift')
    return _rows(first, second, pairs)


def on_minutes_of(first: Course, second: Course, options: Alignment) -> Course:
    """Return a second course on the minutes of the first."""
    shift = shift_between(first, second)
    if options.shift_s is not None:
        shift = round(options.shift_s * SECOND)
    behind = round((second.start_ns + shift - first.start_ns) / MINUTE_NS)
    minutes = np.arange(first.minutes) - behind
    there = (minutes >= 0) & (minutes < second.minutes)

    def moved(values: FloatArray) -> FloatArray:
        full = np.full(first.minutes, np.nan)
        full[there] = values[minutes[there]]
        return full

    return Course(
        first.start_ns,
        {name: moved(values) for name, values in second.values.items()},
        {name: moved(values) for name, values in second.scatter.items()},
    )


def _states(log: ReadLog) -> list[IntArray]:
    """Return the minutes of each steady state."""
    states: dict[int, list[int]] = {}
    for window in log.found.windows:
        middle = (window.start_ns + window.end_ns) // 2
        minute = (middle - log.course.start_ns) // MINUTE_NS
        states.setdefault(window.state, []).append(minute)
    return [np.array(minutes) for minutes in states.values()]


def _apart(
    first: Course, own: IntArray, second: Course, other: IntArray, options: Alignment
) -> float:
    """Return the distance of two states; they may be compared up to 1."""
    here, there = _over(first.values, own), _over(second.values, other)
    port, starboard = np.abs(here / there - 1.0)[:2] / options.warp
    return max(float(port), float(starboard), abs(float(here[2] - there[2])) / options.speed)


def _over(values: Mapping[str, FloatArray], minutes: IntArray, power: int = 1) -> FloatArray:
    """Return means (k,) over minutes, or with power 2 the std of means; NaN without a reading."""
    found = np.full(len(COMPARED), np.nan)
    for column, name in enumerate(COMPARED):
        own = values[name][minutes] if name in values else np.zeros(0)
        own = own[np.isfinite(own)]
        if len(own):
            found[column] = (own**power).sum() ** (1.0 / power) / len(own)
    return found


def _rows(first: Course, second: Course, pairs: Sequence[tuple[IntArray, IntArray]]) -> Rows:
    """Build a row from the minutes of each pair."""
    both = np.array([[_over(first.values, a), _over(second.values, b)] for a, b in pairs])
    noise = np.array([[_over(first.scatter, a, 2), _over(second.scatter, b, 2)] for a, b in pairs])
    present: BoolArray = np.isfinite(both[:, 0]) & np.isfinite(both[:, 1])
    filled = np.where(present[:, None], both, 0.0)
    absolute, relative, per_state = np.array(
        [(CHANNELS[one].bias, CHANNELS[one].bias_fraction, CHANNELS[one].per_state)
         for one in COMPARED]
    ).T  # fmt: skip
    own = np.where(present, np.hypot(np.linalg.norm(noise, axis=1), 2.0**0.5 * per_state), 0.0)
    # Each log has its own calibration, which stays through it.
    sizes = np.where(present[:, None], np.hypot(absolute, relative * filled), 0.0)
    bias = np.concatenate([np.eye(len(COMPARED)) * sizes[:, log, :, None] for log in range(2)], 2)
    rows = np.arange(len(pairs))
    return Rows(
        channels=COMPARED,
        state=rows,
        log=np.zeros(len(pairs), dtype=np.int64),
        hours=np.array([(own.mean() + 0.5) / 60.0 for own, _ in pairs]),
        inputs=both[:, 0, : len(INPUTS)],
        measured=filled[:, 0],
        reference=filled[:, 1],
        present=present,
        errors=ErrorBudget(own, np.zeros((*present.shape, 1)), [(rows, bias)]),
    )
