# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Gear that is watched: the model, and its derivatives by the values of all that may begin."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.diagnosis.library.drift import Drift
from trawl_ros.diagnosis.onset.candidates import WATCHED, AtOneHour
from trawl_ros.effects.base.effect import Effect, Situation
from trawl_ros.effects.effect_set import EffectSet
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.effect_sensitivity import shown_values
from trawl_ros.solver.motion.course import by_values

ROWS = [OBSERVABLES.index(name) for name in WATCHED]


@dataclass(frozen=True)
class WatchedGear:
    """Gear that is towed along: the model, the effects that are there, and those that may begin."""

    model: GearModel
    acting: EffectSet
    effects: tuple[Effect, ...]

    @property
    def towed(self) -> TowedGear:
        """Gear as the estimator tows it, with the effects that act on it or on its inputs."""
        moving = tuple(effect for effect in self.effects if acts_on_gear(effect))
        return TowedGear(self.model, self.acting, examined=moving)

    def counted(self, at: Situation) -> BoolArray:
        """Return flags (p,) of the values that change what counters show."""
        shown = np.array(at.inputs)
        true = [
            effect.apply_to_inputs(effect.neutral + step, shown.copy(), at)
            for effect in self.effects
            for step in np.diag([parameter.std for parameter in effect.parameters])
        ]
        return np.asarray(np.any(np.array(true)[:, :2] != shown[:2], axis=1), np.bool_)

    def by_values(self, moved: FloatArray, shown: FloatArray, at: Situation) -> FloatArray:
        """Return derivatives (k, p) of readings by the values of all effects.

        Parameters
        ----------
        moved : (k, m) array
            Derivatives of the watched channels by the values of effects on the gear.
        shown : (k,) array
            Watched channels by the model.
        at
            The situation.
        """
        observables = np.zeros(len(OBSERVABLES))
        observables[ROWS] = shown
        parts, first = [], 0
        for effect in self.effects:
            part = np.zeros((len(ROWS), len(effect.parameters)))
            if acts_on_gear(effect):
                part += moved[:, first : first + part.shape[1]]
                first += part.shape[1]
            by_sensors = by_values(
                self.acting, effect, lambda there: shown_values(there, observables, at)
            )
            parts.append(part + by_sensors[:, ROWS].T)
        return np.hstack(parts)


def acts_on_gear(effect: Effect) -> bool:
    """Return True if an effect may act on the gear or on what it is towed with."""
    own = effect.of if isinstance(effect, AtOneHour) else effect
    if isinstance(own, Drift) and not any(own.inputs):
        return False
    kind = type(own)
    return kind.gear is not Effect.gear or kind.apply_to_inputs is not Effect.apply_to_inputs
