# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Falls of boards in a tow, as their inclinometers show them."""

from collections import deque

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.observables import lies_by_attitude
from trawl_ros.records.samples import AttitudeSample
from trawl_ros.records.truth import SIDES

READINGS = 3
"""Readings of one sensor in a stretch from which its board has fallen; fewer may be glitches."""

MOSTLY = 0.5
"""Part of a sensor's readings from which it is the sensor that is mounted otherwise, or speaks in
another unit, and not the board that lies."""


class FallRecorder:
    """Recorder of the falls that the inclinometers of both boards show.

    Every reading counts, also those that are outliers among their neighbours, or beyond what a
    board that stands can have: a board that swings over and comes back does so within seconds.

    Parameters
    ----------
    most
        Readings of a sensor that are kept.
    """

    def __init__(self, most: int) -> None:
        self._read: dict[str, deque[tuple[int, bool]]] = {
            side: deque(maxlen=most) for side in SIDES
        }

    def feed(self, sample: AttitudeSample) -> None:
        """Take a reading; one that is no angle says nothing."""
        if abs(sample.pitch) <= np.pi and abs(sample.roll) <= np.pi:
            lies = lies_by_attitude(sample.pitch, sample.roll)
            self._read[sample.side].append((sample.stamp, lies))

    def stamps(self, until_ns: int | None = None) -> tuple[IntArray, ...]:
        """Stamps (ns) of the readings of each board in which it lies, up to one that counts."""
        return tuple(self._of(side, until_ns) for side in SIDES)

    def _of(self, side: str, until_ns: int | None) -> IntArray:
        read = [one for one in self._read[side] if until_ns is None or one[0] <= until_ns]
        lies = np.array([stamp for stamp, fallen in read if fallen], dtype=np.int64)
        return lies if len(lies) < MOSTLY * len(read) else lies[:0]


def fallen_stretches(
    fallen: tuple[FloatArray, ...], stretch_s: float, number: int
) -> tuple[int, ...]:
    """Stretches in which a board has fallen.

    Parameters
    ----------
    fallen
        Times (s) of the readings of each board in which it lies.
    stretch_s, number
        Length of the stretches, and how many these are.
    """
    counts = np.zeros(number, dtype=np.int64)
    for times in fallen:
        inside = times[(times >= 0.0) & (times < number * stretch_s)]
        places = (inside / stretch_s).astype(int)
        counts = np.maximum(counts, np.bincount(places, minlength=number))
    return tuple(int(place) for place in np.flatnonzero(counts >= READINGS))
