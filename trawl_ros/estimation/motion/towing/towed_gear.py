# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Gear that is towed along a tow in motion, and the point at which it is linearised."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Situation
from trawl_ros.effects.effect_set import NO_EFFECTS, ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.effect_sensitivity import sensor_slopes, shown_values
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.motion.parameters import NET, MotionParameters
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.tow import DifferentiatedTow

ADDED_MASS = catalogue()['board_added_mass']


@dataclass(frozen=True)
class TowedGear:
    """Gear that is towed: the model as its file has it, with the effects that are there.

    Attributes
    ----------
    model, acting
        The model without effects, and these.
    net_std
        Prior std of the factors on drag and weight in water of the net; 0 where these are held.
    examined
        Effects by whose values the tow is differentiated too.
    near
        Equilibria of it with other coefficients or inputs, from which one is sought.
    """

    model: GearModel
    acting: EffectSet = NO_EFFECTS
    net_std: float = 0.0
    examined: tuple[Effect, ...] = ()
    near: tuple[Equilibrium, ...] = ()

    def nearest(self, inputs: FloatArray) -> tuple[Equilibrium, ...]:
        """Equilibrium whose warp lengths and speed are nearest to inputs (3,); none without any."""

        def away(known: Equilibrium) -> float:
            at = known.point.port_length, known.point.starboard_length, known.point.speed
            return float(np.abs(np.array(at) / inputs - 1.0).sum())

        return (min(self.near, key=away),) if self.near else ()

    def with_added_mass(self, part: float) -> EffectSet:
        """Effects with an added mass of the boards beside that in the gear file."""
        known = self.acting.of(ADDED_MASS).values
        return self.acting.having(ActiveEffect(ADDED_MASS, known + part))

    def model_at(self, point: 'TowedPoint') -> GearModel:
        """Model without effects, with coefficients and net of a point."""
        model = self.model.with_coefficients(point.coefficients)
        return model.with_net(*map(float, point.net)) if self.net_std else model

    @property
    def of_net(self) -> int:
        """Number of factors on the net that are estimated."""
        return len(NET) if self.net_std else 0

    def parameters(self, inputs: Sequence[str], motions: int) -> MotionParameters:
        """Parameters of the derivatives, with additions to the inputs and slow motions."""
        return MotionParameters(
            coefficients=self.model.board.law.parameters.names,
            net=bool(self.net_std),
            effects=(ADDED_MASS, *self.examined),
            inputs=tuple(inputs),
            motions=motions,
        )

    def observed(
        self, towed: DifferentiatedTow, at: Situation, channels: Sequence[str]
    ) -> MotionPrediction:
        """Channels (k,) as their sensors show them, with derivatives (k, m)."""
        observed, acting = towed.observed(), self.acting
        values, slopes = observed.values, observed.slopes
        if acting.on_sensors:
            slopes = sensor_slopes(acting, values, at) @ slopes
            values = shown_values(acting, values, at)
        rows = [OBSERVABLES.index(name) for name in channels]
        return MotionPrediction(values[rows], slopes[rows])

    @staticmethod
    def parts(slopes: FloatArray, parameters: MotionParameters) -> dict[str, FloatArray]:
        """Derivatives (k, m) by the parameters of the gear, in groups."""
        of_effects, added = slopes[:, parameters.of_effects], len(ADDED_MASS.parameters)
        return {
            'coefficients': slopes[:, parameters.of_coefficients],
            'added_mass': of_effects[:, :added],
            'net': slopes[:, parameters.of_net],
            'examined': of_effects[:, added:],
        }


@dataclass(frozen=True)
class TowedPoint:
    """Point at which a tow is linearised.

    ``coefficients`` (q,), ``added_mass`` as a part of the cylinder of water around a board,
    ``errors`` (e,) of the inputs in std, ``drifts`` (knots,) their errors at all knots, SI, and
    ``net`` (2,), factors on its drag and weight in water.
    """

    coefficients: FloatArray
    added_mass: float
    errors: FloatArray
    drifts: FloatArray
    net: FloatArray = field(default_factory=lambda: np.ones(len(NET)))
