"""Stability of a steady state by the eigenvalues of its linearised motion."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.modes import LinearisedMotion, linearised_motion

DRIFTING = 0.02
"""Point (1/s) around which slow drifts of the whole gear are sought."""

DRIFTS = 6
"""Number of them."""

FALLING = 0.5
"""Point around which a board that falls over is sought, in a second or in some."""

FALLS = 0.03
"""Growth (1/s) from which that is left to it: slower ones are found among the drifts."""

SWINGING = (0.3 + 1.0j, 1.0 + 3.0j, 0.7 + 7.5j, 0.7 + 11.0j, 0.5 + 15.0j)
"""Points around which the swings of boards on their ropes, and of netting, are sought."""

TOLERANCE, SWING_TOLERANCE = 1e-5, 1e-3
"""Error of an eigenvalue, relative to its distance from the point, at which it is found."""

SLOWEST_SWING = 0.05
"""Frequency (rad/s) below which a motion is a drift, and found more precisely as such."""

SEEN = 0.2
"""Error up to which a motion is followed that may grow faster than those found before. Those that
grow stand out: eigenvalues of motions that die out fill a disk, in which 1 / (λ - s) are sought,
and those of the others lie outside, where Arnoldi's method comes first."""

LEAST = 16
"""Vectors after which a motion that grows has been seen."""


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
    """Eigenvalues of M ẍ + C ẋ + K x = 0 near the imaginary axis: slow drifts, and of the other
    motions those that may be less stable.
    """
    motion = linearised_motion(model, state, tow)
    drifting, _ = motion.nearest(DRIFTING, DRIFTS, tolerance=TOLERANCE)
    found = [drifting]
    growth = float(drifting.real.max(initial=-np.inf))
    for point in (FALLING, *SWINGING):
        values = _growing(motion, point, growth)
        growth = float(values.real.max(initial=growth))
        found.append(values)
    return Stability(np.concatenate(found))


def _growing(motion: LinearisedMotion, point: complex, growth: float) -> FloatArray:
    """Eigenvalues of falls or swings around a point, all that grow faster among them."""
    tolerance = TOLERANCE if point == FALLING else SWING_TOLERANCE

    def counts(values: FloatArray) -> BoolArray:
        swinging: BoolArray = np.abs(values.imag) > SLOWEST_SWING
        return values.real > FALLS if point == FALLING else swinging

    def enough(values: FloatArray, errors: FloatArray) -> bool:
        seen = counts(values) & (values.real > growth) & (errors < SEEN)
        return len(values) >= LEAST and bool(np.all(errors[seen] <= tolerance))

    around = motion.around(point, enough)
    found = around.values[around.residuals <= tolerance]
    return found[counts(found)]
