# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Course of a watched tow: its innovations and the evidence for what may have begun, over time."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.watch import WatchedStretch


@dataclass(frozen=True)
class WatchedCourse:
    """Course of a watched tow, by its n stretches.

    Attributes
    ----------
    ends_ns
        Ends (n,) of the stretches.
    innovations
        Whitened innovations (n, k) of the channels `WATCHED`, NaN where there are none.
    rarities
        Rarity (n,) of the rarest candidate; NaN where nothing was judged.
    """

    ends_ns: IntArray
    innovations: FloatArray
    rarities: FloatArray


class CourseKeeper:
    """Keeper of a tow's course, as what a monitor calls after each stretch."""

    def __init__(self) -> None:
        self._rows: list[tuple[int, FloatArray, float]] = []

    def __call__(self, stretch: WatchedStretch) -> None:
        """Keep a stretch."""
        rarity = np.nan if stretch.why_not else stretch.rarity
        self._rows.append((stretch.end_ns, stretch.innovations, rarity))

    @property
    def course(self) -> WatchedCourse:
        """The course so far."""
        ends, innovations, rarities = zip(*self._rows, strict=True) if self._rows else ((),) * 3
        return WatchedCourse(
            np.array(ends, np.int64),
            np.array(innovations, np.float64).reshape(-1, len(WATCHED)),
            np.array(rarities, np.float64),
        )
