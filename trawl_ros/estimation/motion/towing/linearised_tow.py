# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Record of a tow in motion at a point: predicted means of its stretches, and their derivatives."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.motion.towing.linearisation import STARTS, Linearisation
from trawl_ros.estimation.motion.towing.records import LeftOut, MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint


@dataclass(frozen=True)
class LinearisedTow:
    """Tow at a point, in n stretches by k channels.

    Attributes
    ----------
    tow, point
        The tow, and where it is linearised.
    values : (n, k) array
        Predicted means; NaN in stretches that are left out.
    by_coefficients : (n, k, q) array
    by_added_mass : (n, k, 1) array
    by_errors : (n, k, e) array
        By a std of each of `INPUT_ERRORS`.
    by_knots : (n, k, knots) array
        By an input's error at each knot, per SI unit.
    by_starts : (n, k, starts) array
        By the amplitudes (m) of the slowest motions with which each part may begin.
    by_net : (n, k, 2 or 0) array
        By the factors on drag and weight of the net.
    by_examined : (n, k, values) array
        By the values of the effects that are examined, of what they do to the gear and its inputs.
    left_out
        Stretches that cannot be predicted, and why.
    """

    tow: MovingTow
    point: TowedPoint
    values: FloatArray
    by_coefficients: FloatArray
    by_added_mass: FloatArray
    by_errors: FloatArray
    by_knots: FloatArray
    by_starts: FloatArray
    by_net: FloatArray
    by_examined: FloatArray
    left_out: tuple[LeftOut, ...]

    @classmethod
    def empty(
        cls, tow: MovingTow, point: TowedPoint, gear: TowedGear, left_out: tuple[LeftOut, ...]
    ) -> 'LinearisedTow':
        """Tow without any prediction."""
        of_examined = sum(len(effect.parameters) for effect in gear.examined)
        of_inputs = len(INPUT_ERRORS), tow.inputs.number_of_knots
        widths = (len(point.coefficients), 1, *of_inputs, tow.starts, gear.of_net, of_examined)
        coefficients, mass, errors, knots, starts, net, examined = (
            np.zeros((*tow.means.shape, width)) for width in widths
        )
        values = np.full(tow.means.shape, np.nan)
        return cls(
            tow, point, values, coefficients, mass, errors, knots, starts, net, examined, left_out
        )

    def put(self, stretch: int, means: Linearisation) -> None:
        """Put the prediction of a stretch in its place."""
        by = means.by
        self.values[stretch] = means.values
        self.by_coefficients[stretch] = by['coefficients']
        self.by_added_mass[stretch] = by['added_mass']
        self.by_errors[stretch] = by['errors']
        for knots, own, _ in self.tow.inputs.knot_places:
            slopes = by[knots.channel]
            self.by_knots[stretch][:, own.start : own.start + slopes.shape[1]] = slopes
        starts = by.get(STARTS, np.zeros((0, 0)))[:, : self.tow.starts]
        self.by_starts[stretch][:, : starts.shape[1]] = starts if len(starts) else 0.0
        self.by_net[stretch] = by['net'] / self.point.net if self.by_net.size else 0.0
        self.by_examined[stretch] = by['examined']

    @property
    def towed(self) -> BoolArray:
        """Flags (n,) of the stretches that are not left out."""
        return np.asarray(np.isfinite(self.values).any(axis=1), np.bool_)

    @property
    def residual(self) -> FloatArray:
        """Measured minus predicted means (n, k), NaN where either is missing."""
        return self.tow.means - self.values
