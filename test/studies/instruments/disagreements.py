"""Disagreements of the gates with a survey's editors, by what is wrong with the readings."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray

WORST = 10
"""Readings of a haul on which gates and editors may differ without a row in the report."""

PERIOD_M = 100.0
"""Readings that are too long by more (m) are of another period of the ranging."""

MULTIPLE_WITHIN = 0.35
"""Readings are taken for a multiple of the distance up to this part of it above."""

RUN = 3
"""Readings in a row that make another level."""

CLASSES: Mapping[str, str] = {
    'second': 'one of two readings in a second, of which the editors rejected the other or none',
    'period': 'too long by more than 100 m: heard in the next period of the ranging',
    'multiple': 'two or three times the distance, and up to 0.35 of it more: there and back again',
    'level': 'three or more in a row off to the same side: another echo for a while, or the net '
    'rises or settles within the window',
    'long': 'too long, one or two in a row: a reflection',
    'short': 'too short, one or two in a row: something in between, or noise',
}
"""Classes of disagreements and their explanation; each reading has the first that fits."""


@dataclass(frozen=True)
class HaulDisagreement:
    """Disagreements of a haul: its number, readings, and class of `CLASSES` → readings."""

    number: int
    readings: int
    counts: Mapping[str, int]

    @property
    def total(self) -> int:
        """Readings on which gates and editors differ."""
        return sum(self.counts.values())

    @property
    def main(self) -> str:
        """Class of most of them."""
        return max(CLASSES, key=lambda kind: self.counts.get(kind, 0))


def classified(values: FloatArray, rejected: BoolArray) -> Counter[str]:
    """Count the rejected readings of a window by their class.

    Parameters
    ----------
    values
        All readings (n,) of the window, m, in the order of time.
    rejected
        Mask (n,) of those that the gates rejected and the editors kept.
    """
    counts = Counter[str]()
    if not rejected.any() or rejected.all():
        return counts
    level = float(np.median(values[~rejected]))
    side = np.where(rejected, np.sign(values - level), 0.0)
    ends = np.concatenate(([0], np.flatnonzero(np.diff(side) != 0.0) + 1, [len(side)]))
    for first, last in pairwise(ends):
        for value in values[first:last] if side[first] else ():
            counts[_class(float(value), level, int(last - first))] += 1
    return counts


def _class(value: float, level: float, run: int) -> str:
    if value - level > PERIOD_M:
        return 'period'
    over = value / level - 1.0
    if any(-0.1 < over - more < MULTIPLE_WITHIN for more in (1.0, 2.0)):
        return 'multiple'
    if run >= RUN:
        return 'level'
    return 'long' if value > level else 'short'
