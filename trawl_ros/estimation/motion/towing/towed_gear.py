"""Gear that is towed along a tow in motion, and the point at which it is linearised."""

from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import NO_EFFECTS, ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.motion.parameters import NET

ADDED_MASS = catalogue()['board_added_mass']


@dataclass(frozen=True)
class TowedGear:
    """Gear that is towed: the model as its file has it, with the effects that are there.

    Attributes
    ----------
    model, acting
        The model without effects, and these.
    motions
        Number of slow motions with which a tow may begin.
    net_std
        Prior std of the factors on drag and weight in water of the net; 0 where these are held.
    examined
        Effects by whose values the tow is differentiated too.
    """

    model: GearModel
    acting: EffectSet = NO_EFFECTS
    motions: int = 0
    net_std: float = 0.0
    examined: tuple[Effect, ...] = ()

    def with_added_mass(self, part: float) -> EffectSet:
        """Effects with an added mass of the boards beside that in the gear file."""
        known = self.acting.of(ADDED_MASS).values
        return self.acting.having(ActiveEffect(ADDED_MASS, known + part))

    def model_at(self, point: 'TowedPoint') -> GearModel:
        """Model without effects, with coefficients and net of a point."""
        model = self.model.with_coefficients(point.coefficients)
        return model.with_net(*map(float, point.net)) if self.net_std else model


@dataclass(frozen=True)
class TowedPoint:
    """Point at which a tow is linearised.

    ``coefficients`` (12,), ``added_mass`` as a part of the cylinder of water around a board,
    ``errors`` (e,) of the inputs in std, ``drifts`` (knots,) their errors at all knots, SI, and
    ``net`` (2,), factors on its drag and weight in water.
    """

    coefficients: FloatArray
    added_mass: float
    errors: FloatArray
    drifts: FloatArray
    net: FloatArray = field(default_factory=lambda: np.ones(len(NET)))
