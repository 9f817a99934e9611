"""Record of a tow in motion at a point: predicted means of its stretches, and their derivatives."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.estimation.motion.towing.records import LeftOut, MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedPoint


@dataclass(frozen=True)
class LinearisedTow:
    """Tow at a point, in n stretches by k channels.

    Attributes
    ----------
    tow, point
        The tow, and where it is linearised.
    values : (n, k) array
        Predicted means; NaN in stretches that are left out.
    by_coefficients : (n, k, 12) array
    by_added_mass : (n, k, 1) array
    by_errors : (n, k, e) array
        By a std of each of `INPUT_ERRORS`.
    by_knots : (n, k, knots) array
        By an input's error at each knot, per SI unit.
    by_motions : (n, k, motions) array
        By a metre of each slow motion at the beginning.
    by_net : (n, k, 2 or 0) array
        By the factors on drag and weight of the net.
    by_examined : (n, k, values) array
        By the values of the effects that are examined, of what they do to the gear and its inputs.
    left_out
        Stretches that the model cannot tow, and why.
    factorisations
        Matrices that were factorised for it, a measure of what it cost.
    """

    tow: MovingTow
    point: TowedPoint
    values: FloatArray
    by_coefficients: FloatArray
    by_added_mass: FloatArray
    by_errors: FloatArray
    by_knots: FloatArray
    by_motions: FloatArray
    by_net: FloatArray
    by_examined: FloatArray
    left_out: tuple[LeftOut, ...]
    factorisations: int

    @property
    def towed(self) -> BoolArray:
        """Flags (n,) of the stretches that are not left out."""
        return np.asarray(np.isfinite(self.values).any(axis=1), np.bool_)

    @property
    def residual(self) -> FloatArray:
        """Measured minus predicted means (n, k), NaN where either is missing."""
        return self.tow.means - self.values
