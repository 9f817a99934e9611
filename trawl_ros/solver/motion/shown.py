"""Derivatives of observables by values of effects that change what they are made of.

A gear that stays where it is may show something else: a thicker wire pulls with another force at
the same stretch. All else that an effect changes comes with the motion.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import EffectSet
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.likeness import same_observables
from trawl_ros.solver.motion.course import by_values
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.partials import GearAtPoint


def effects_that_show(
    gear: GearAtPoint, parameters: MotionParameters, known: frozenset[str] = frozenset()
) -> frozenset[str]:
    """Names of the effects that change observables of a gear that stays where it is, those
    ``known`` to have done so before among them.
    """
    return known.union(
        effect.name
        for effect in parameters.effects
        if effect.name not in known and _shows(gear, effect)
    )


def _shows(gear: GearAtPoint, effect: Effect) -> bool:
    if type(effect).gear is Effect.gear:
        return False
    still, different = gear.model(gear.acting), []

    def compare(acting: EffectSet) -> FloatArray:
        different.append(not same_observables(gear.model(acting), still))
        return np.zeros(0)

    by_values(gear.acting, effect, compare)
    return any(different)


def shown_by_effects(
    gear: GearAtPoint, parameters: MotionParameters, names: frozenset[str], state: State, tow: Tow
) -> FloatArray:
    """Derivatives (n_observables, m) of observables by the values of effects, all motion held.

    Parameters
    ----------
    gear
        At this instant.
    parameters
        Of the derivatives.
    names
        Effects that may show so; those of all others are nought.
    state, tow
        State of the gear, and its boundary.
    """
    own = parameters.of_effects
    found, first = np.zeros((len(OBSERVABLES), own.stop - own.start)), 0
    for effect in parameters.effects:
        last = first + len(effect.parameters)
        if effect.name in names:
            found[:, first:last] = by_values(
                gear.acting, effect, lambda there: observe(gear.model(there), state, tow).array()
            ).T
        first = last
    return found
