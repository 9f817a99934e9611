# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady part of a tow: the equilibrium of held inputs, and its slowest motions.

The means of a stretch follow from one equilibrium to first order in the inputs, for these stay
within the tolerances of a steady window. The gear's slowest motions decay in 200 to 800 s, longer
than most holds last, so what is left of them is added: amplitudes that decay.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.towing.inputs import MeanInputs
from trawl_ros.estimation.motion.towing.linearisation import SLOW_MOTIONS, Linearisation
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.tow import DifferentiatedTow


@dataclass(frozen=True)
class HeldGear:
    """Gear in the equilibrium of held inputs.

    Attributes
    ----------
    inputs : (3,) array
        Warp lengths (m) and speed (m/s) of the equilibrium.
    equilibrium
        The equilibrium itself.
    base
        Channels (k,) there, with their derivatives by the parameters of the gear.
    by_inputs : (k, 3) array
        Derivatives by the inputs.
    shapes : (k, m) array
        Derivatives by the amplitudes (m) of the slowest motions.
    paces : (m, m) array
        Rates of change of the amplitudes by the amplitudes, 1/s.
    projection : (m, k) array
        Amplitudes of the slowest motions by departures of the channels, in least squares.
    """

    inputs: FloatArray
    equilibrium: Equilibrium
    base: Linearisation
    by_inputs: FloatArray
    shapes: FloatArray
    paces: FloatArray
    projection: FloatArray

    def at(self, mean: MeanInputs) -> Linearisation:
        """Channels (k,) at mean inputs nearby, to first order."""
        by = dict(self.base.by)
        by['errors'] = self.by_inputs @ mean.by_errors.T
        for channel, weights in mean.by_knots.items():
            by[channel] = np.outer(self.by_inputs[:, INPUTS.index(channel)], weights)
        return Linearisation(self.base.values + self.by_inputs @ (mean.values - self.inputs), by)

    def decayed(self, amplitudes: Linearisation, seconds: float) -> Linearisation:
        """Amplitudes of the slowest motions so many seconds later."""
        return amplitudes.through(expm(self.paces * seconds))


def projection(shapes: FloatArray, channels: Sequence[str]) -> FloatArray:
    """Amplitudes (m, k) of motions by departures of channels (k,), in least squares.

    Parameters
    ----------
    shapes : (k, m) array
        Derivatives of the channels by the amplitudes.
    channels
        Their names; each counts by the noise of a reading.
    """
    noise = np.array([CHANNELS[name].noise for name in channels])
    found: FloatArray = np.linalg.pinv(shapes / noise[:, None]) / noise
    return found


def hold_gear(
    gear: TowedGear,
    point: TowedPoint,
    mean: MeanInputs,
    channels: Sequence[str],
    start: Equilibrium | None = None,
) -> HeldGear:
    """Find the equilibrium of mean inputs with its derivatives.

    Parameters
    ----------
    gear, point
        Gear, and the point at which it is linearised.
    mean
        Inputs.
    channels
        Measured channels (k).
    start
        Equilibrium nearby.

    Raises
    ------
    NoSteadyState
        If there is none.
    """
    parameters = gear.parameters(INPUTS, motions=SLOW_MOTIONS)
    at = InputPoint(
        mean.values, np.zeros(3), mean.heading, 0.0, mean.hours, np.eye(3), np.zeros((3, 3))
    )
    acting, model = gear.with_added_mass(point.added_mass), gear.model_at(point)
    towed = DifferentiatedTow(model, parameters, lambda time: at, acting, start)
    seen = gear.observed(towed, at.situation, channels)
    shapes, own = seen.slopes[:, parameters.of_motions], parameters.of_motions
    places, paces = towed.slopes.places[:, own], towed.slopes.velocities[:, own]
    return HeldGear(
        mean.values, towed.first, Linearisation(seen.values, gear.parts(seen.slopes, parameters)),
        seen.slopes[:, parameters.of_inputs], shapes, np.linalg.pinv(places) @ paces,
        projection(shapes, channels),
    )  # fmt: skip
