# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Course of a watched tow: its innovations and the evidence for what may have begun, over time."""

from collections.abc import Sequence
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

    @classmethod
    def of(cls, stretches: Sequence[WatchedStretch]) -> 'WatchedCourse':
        """Return the course through some stretches."""
        return cls(
            np.array([one.end_ns for one in stretches], np.int64),
            np.array([one.innovations for one in stretches]).reshape(-1, len(WATCHED)),
            np.array([one.rarity for one in stretches], np.float64),
        )
