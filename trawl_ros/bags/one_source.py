"""Two sources on one topic, told by their channels, their stamps, or readings that alternate.

A publisher leaves no name in a bag. That there are two is known from what one cannot do: come by
turns from two channels, give two readings for one time, go back in time again and again, jump
to and fro between two courses at every reading, or give readings on a second course beside, and not
instead of, those that its rate asks for.
"""

from collections import deque
from itertools import pairwise
from statistics import median

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.records.samples import (
    AttitudeSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)

BLOCK = 60
"""Readings that are looked at together; what is seldom is a fault and no second source."""

RETURNS = 3
"""Times that a channel comes again behind another, from which on they take turns."""

SHARE = 0.25
"""Part of a block that has stamps which one source does not give."""

JUMP = 2.0
"""Least ratio of the step to the next reading to that to the one behind it, by which waves have
moved on already."""

LONGEST_STEP = 1_500_000_000
"""Time (ns) between readings up to which they are looked at for this: slower ones may alternate
because swell comes at twice their interval."""

ALTERNATING = 0.9
"""Part of the steps in a block that turn back."""

MEMORY = 4 * BLOCK
"""Readings among which those of a slower source are looked for."""

VISITS = 6
"""Readings on a second course from which on it is one."""

SPREAD = 0.3
"""Largest deviation, as a part, of what one source has in common: the distance of its readings from
the other's, and the time between them."""

MOST = 0.9
"""Part of the readings on the first course that stand out by less than the second is off it."""

ONE_PERIOD = 1.5
"""Largest ratio of the time between two readings that have one of the second course between them
to that between two that have not: a reading that is wrong stands in another's place, and makes it
two."""


class SourceWatch:
    """Watch for a second source among the readings of one topic, as they come."""

    def __init__(self) -> None:
        self._readings: deque[tuple[int, int, tuple[float, ...]]] = deque(maxlen=MEMORY)
        self._count = 0
        self._why = ''

    def take(self, channel: int, sample: Sample) -> str:
        """Take a reading; why there are two sources by the last judgement, '' for one.

        Parameters
        ----------
        channel
            Number of the channel by which it came.
        sample
            Reading of the message.
        """
        values = _values(sample)
        if values is None:
            return ''
        self._readings.append((channel, sample.stamp, values))
        self._count += 1
        if self._count % (BLOCK // 2) == 0:
            self._why = self._judge()
        return self._why

    def _judge(self) -> str:
        readings = list(self._readings)
        channels, stamps, values = zip(*readings[-BLOCK:], strict=True)
        pairs = list(zip(stamps, stamps[1:], values, values[1:], strict=False))
        met: set[int] = set()
        returns = 0
        for before, channel in zip((None, *channels), channels, strict=False):
            returns += channel != before and channel in met
            met.add(channel)
        if returns >= RETURNS:
            return f'it comes by turns from {len(met)} channels'
        twice = sum(first == second and this != that for first, second, this, that in pairs)
        if twice >= SHARE * BLOCK:
            return f'{twice} of {len(stamps)} stamps come twice, with two readings'
        back = sum(second < first for first, second, _, _ in pairs)
        if back >= SHARE * BLOCK:
            return f'{back} of {len(stamps)} stamps go back in time'
        near = median(second - first for first, second, _, _ in pairs) <= LONGEST_STEP
        if near and len(stamps) == BLOCK and any(map(_alternates, zip(*values, strict=True))):
            return f'{len(stamps)} readings jump to and fro between two courses'
        if visits := _visits(readings):
            return f'{visits} of {len(readings)} readings lie on a second course beside the first'
        return ''


def _alternates(values: tuple[float, ...]) -> bool:
    steps = [after - before for before, after in pairwise(values)]
    turns = sum(first * second < 0 for first, second in pairwise(steps))
    if turns < ALTERNATING * (len(steps) - 1):
        return False
    beyond = [abs(after - before) for before, after in zip(values, values[2:], strict=False)]
    return median(map(abs, steps)) > JUMP * median(beyond)


def _visits(readings: list[tuple[int, int, tuple[float, ...]]]) -> int:
    """Count the readings of a slower source between those of a faster one; 0 without one."""
    stamps = np.array([stamp for _, stamp, _ in readings])
    courses = np.array([values for _, _, values in readings]).T
    if np.any(np.diff(stamps) < 0):
        order = np.argsort(stamps, kind='stable')
        stamps, courses = stamps[order], courses[:, order]
    times = (stamps - stamps[0]).astype(float)
    # Values beyond any instrument are refused elsewhere.
    with np.errstate(over='ignore', invalid='ignore'):
        return max(_beside(times, sign * course) for course in courses for sign in (1.0, -1.0))


def _beside(times: FloatArray, values: FloatArray) -> int:
    """Count the readings that stand out upward (n,), if they are a source of their own; else 0."""
    finite = np.isfinite(values)
    times, values = times[finite], values[finite]
    if len(values) < 2 * VISITS:
        return 0
    out = _departures(values)
    chosen = out > np.maximum(abs(values[2:] - values[:-2]), np.sort(out)[-VISITS] / 2.0)
    if np.count_nonzero(chosen) < VISITS or not _alike(out[chosen]):
        return 0
    if not _alike(np.diff(times[1:-1][chosen])):
        return 0
    # Of the others, each with the number of chosen ones before it.
    others = np.concatenate(([True], ~chosen, [True]))
    if np.median(out[chosen]) < JUMP * np.quantile(abs(_departures(values[others])), MOST):
        return 0
    gaps, between = np.diff(times[others]), np.diff(np.cumsum(~others)[others]) > 0
    if np.count_nonzero(~between) < VISITS:
        return 0
    if np.median(gaps[between]) > ONE_PERIOD * np.median(gaps[~between]):
        return 0
    return int(np.count_nonzero(chosen))


def _departures(values: FloatArray) -> FloatArray:
    """Return by how much values (n,) depart from the mean of their neighbours (n - 2,)."""
    return values[1:-1] - (values[:-2] + values[2:]) / 2.0


def _alike(sizes: FloatArray) -> bool:
    """True if most of some sizes (n,) deviate little."""
    # Of some ten numbers, which arrays take longer to sort.
    middle = float(median(sizes.tolist()))
    return middle > 0.0 and float(median(abs(sizes - middle).tolist())) <= SPREAD * middle


def _values(sample: Sample) -> tuple[float, ...] | None:
    """Give what an instrument reads; None where it is no number on a course of its own."""
    match sample:
        case WinchSample():
            return (*sample.lengths, *sample.tensions)
        case PressureSample():
            return (sample.pressure,)
        case AttitudeSample():
            return sample.pitch, sample.roll
        case RangeSample(what='spread' | 'depth'):
            return (sample.distance,)
        case VelocitySample():
            return tuple(map(float, sample.velocity))
    return None
