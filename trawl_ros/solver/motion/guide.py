# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Guide of a tow: its time steps, by which a tow with parameters nearby is solved sooner."""

from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import FloatArray

Key = tuple[float, float]


def _key(time: float, h: float) -> Key:
    return round(time, 6), round(h, 6)


@dataclass
class TowGuide:
    """Time steps of a tow: accelerations of those that converged, and those that were halved.

    Another tow along the same times begins its iterations with these accelerations, and halves the
    same steps. A step that is halved at one value of the parameters and not at another would change
    the readings by the error of the method.
    """

    accelerations: dict[Key, FloatArray] = field(default_factory=dict)
    halved: set[Key] = field(default_factory=set)

    def note(self, time: float, h: float, acceleration: FloatArray) -> None:
        """Note the acceleration (dof,) at the end of a step of ``h`` seconds from a time."""
        # A guess needs no more digits, and there are thousands of steps.
        self.accelerations[_key(time, h)] = acceleration.astype(np.float32)

    def note_halved(self, time: float, h: float) -> None:
        """Note that a step was halved."""
        self.halved.add(_key(time, h))

    def guess(self, time: float, h: float) -> FloatArray | None:
        """Return the acceleration (dof,) at the end of a step; None where it is not known."""
        known = self.accelerations.get(_key(time, h))
        return None if known is None else known.astype(np.float64)

    def is_halved(self, time: float, h: float) -> bool:
        """Return True if a step was halved."""
        return _key(time, h) in self.halved
