"""Stability of a steady state by the eigenvalues of its linearised motion."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.modes import linearised_motion

FALLING = (2.0, 0.5, 0.1)
"""Points (1/s) around which a board that falls over is sought, in a second or in some. Without one
the nearest eigenvalues are a crowd of slow ones, all as far away, which are not waited for."""

FALLING_RESTARTS = 2

DRIFTING = 0.02
"""Point around which slow drifts of the whole gear are sought."""

SWINGING = (0.3 + 1.0j, 1.0 + 3.0j, 1.0 + 8.0j, 0.5 + 15.0j)
"""Points around which the swings of boards on their ropes are sought."""

MODES, SWINGS = 6, 4
"""Number of modes around a point."""

TOLERANCE, SWING_TOLERANCE = 1e-5, 1e-3
"""Error of an eigenvalue, relative to its distance from the point, at which it is found."""

SLOWEST_SWING = 0.05
"""Frequency (rad/s) below which a motion is a drift, and found more precisely as such."""


@dataclass(frozen=True)
class Stability:
    """The eigenvalues (1/s) nearest to instability; ``growth`` is the largest real part."""

    eigenvalues: FloatArray

    @property
    def growth(self) -> float:
        """Rate of growth (1/s) of the least stable motion; negative when all die out."""
        return float(self.eigenvalues.real.max())

    @property
    def stable(self) -> bool:
        """True if every motion found dies out."""
        return self.growth < 0.0

    @property
    def settling_time(self) -> float:
        """Time (s) in which the slowest motion falls to 1/e."""
        return -1.0 / self.growth if self.stable else float('inf')


def stability(model: GearModel, state: State, tow: Tow) -> Stability:
    """Eigenvalues of M ẍ + C ẋ + K x = 0 near the imaginary axis."""
    motion = linearised_motion(model, state, tow)
    drifting, _ = motion.nearest(DRIFTING, MODES, tolerance=TOLERANCE)
    found = [drifting]
    for falling in FALLING:
        values, _ = motion.nearest(falling, MODES, tolerance=TOLERANCE, restarts=FALLING_RESTARTS)
        found.append(values)
    for point in SWINGING:
        values, _ = motion.nearest(point, SWINGS, tolerance=SWING_TOLERANCE)
        found.append(values[np.abs(values.imag) > SLOWEST_SWING])
    return Stability(np.concatenate(found))
