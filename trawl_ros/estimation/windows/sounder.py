# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Depth of the water in a window, from the echo sounder."""

import math
from collections import deque

import numpy as np

from trawl_ros.records.samples import RangeSample, Sample

KEPT = 5000
"""So many soundings are kept: more than an hour at 1 Hz."""


class Sounder:
    """Soundings of late, of which windows take the median.

    A ship may have none, and water may be too deep for an echo: no window waits for one.
    """

    def __init__(self) -> None:
        self._soundings: deque[tuple[int, float]] = deque(maxlen=KEPT)

    def add(self, sample: Sample) -> None:
        """Add a sounding; samples of other instruments and lost echoes are none."""
        if not isinstance(sample, RangeSample) or sample.what != 'depth':
            return
        if 0.0 < sample.distance < math.inf:
            self._soundings.append((sample.stamp, sample.distance))

    def depth(self, start_ns: int, end_ns: int) -> float | None:
        """Depth (m) under the ship in a window; None without a sounding."""
        own = [depth for stamp, depth in self._soundings if start_ns <= stamp < end_ns]
        return float(np.median(own)) if own else None
