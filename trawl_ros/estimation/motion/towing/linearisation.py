# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Linearised quantities of a tow: values with their derivatives by the parameters, in groups."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray

STARTS = 'starts'
"""Name of the group of slow motions with which parts of a tow may begin."""

SLOW_MOTIONS = 3
"""Slowest motions that are carried from part to part. They decay in 200 to 800 s; after the time of
settling of a steady window no faster one is left, and of depths a departure of 10 m may be."""


@dataclass(frozen=True)
class Linearisation:
    """Values (k,) and their derivatives (k, m) by each group of parameters.

    A group may have more columns in one linearisation than in another: those that are missing at
    its end are zero.
    """

    values: FloatArray
    by: Mapping[str, FloatArray]

    def plus(self, other: 'Linearisation', factor: float = 1.0) -> 'Linearisation':
        """Return this plus a multiple of another."""
        found = dict(self.by)
        for name, slopes in other.by.items():
            own = found.get(name)
            found[name] = factor * slopes if own is None else _sum(own, factor * slopes)
        return Linearisation(self.values + factor * other.values, found)

    def through(self, matrix: FloatArray) -> 'Linearisation':
        """Return the product of a matrix (n, k) with this."""
        return Linearisation(
            matrix @ self.values, {name: matrix @ slopes for name, slopes in self.by.items()}
        )


def _sum(one: FloatArray, other: FloatArray) -> FloatArray:
    wide, narrow = (one, other) if one.shape[1] >= other.shape[1] else (other, one)
    total: FloatArray = wide.copy()
    total[:, : narrow.shape[1]] += narrow
    return total


def unknown_amplitudes(number: int) -> Linearisation:
    """Amplitudes of the slow motions with which the ``number``-th part of a tow begins."""
    by = np.zeros((SLOW_MOTIONS, SLOW_MOTIONS * (number + 1)))
    by[:, -SLOW_MOTIONS:] = np.eye(SLOW_MOTIONS)
    return Linearisation(np.zeros(SLOW_MOTIONS), {STARTS: by})
