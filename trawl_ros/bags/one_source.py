"""Two sources on one topic, told by their channels, their stamps, or readings that alternate.

A publisher leaves no name in a bag. That there are two is known from what one cannot do: come by
turns from two channels, give two readings for one time, go back in time again and again, or jump
to and fro between two courses at every reading.
"""

from collections import deque
from itertools import pairwise
from statistics import median

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


class SourceWatch:
    """Looks at the readings of one topic as they come."""

    def __init__(self) -> None:
        self._readings: deque[tuple[int, int, tuple[float, ...]]] = deque(maxlen=BLOCK)
        self._count = 0

    def take(self, channel: int, sample: Sample) -> str:
        """Take a reading; why there are two sources, '' while there is one.

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
        return self._judge() if self._count % (BLOCK // 2) == 0 else ''

    def _judge(self) -> str:
        channels, stamps, values = zip(*self._readings, strict=True)
        pairs = list(zip(stamps, stamps[1:], values, values[1:], strict=False))
        seen: set[int] = set()
        returns = 0
        for before, channel in zip((None, *channels), channels, strict=False):
            returns += channel != before and channel in seen
            seen.add(channel)
        if returns >= RETURNS:
            return f'it comes by turns from {len(seen)} channels'
        twice = sum(one == two and this != that for one, two, this, that in pairs)
        if twice >= SHARE * BLOCK:
            return f'{twice} of {len(stamps)} stamps come twice, with two readings'
        back = sum(two < one for one, two, _, _ in pairs)
        if back >= SHARE * BLOCK:
            return f'{back} of {len(stamps)} stamps go back in time'
        near = median(two - one for one, two, _, _ in pairs) <= LONGEST_STEP
        if near and len(stamps) == BLOCK and any(map(_alternates, zip(*values, strict=True))):
            return f'{len(stamps)} readings jump to and fro between two courses'
        return ''


def _alternates(values: tuple[float, ...]) -> bool:
    steps = [after - before for before, after in pairwise(values)]
    turns = sum(one * two < 0 for one, two in pairwise(steps))
    if turns < ALTERNATING * (len(steps) - 1):
        return False
    beyond = [abs(after - before) for before, after in zip(values, values[2:], strict=False)]
    return median(map(abs, steps)) > JUMP * median(beyond)


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
