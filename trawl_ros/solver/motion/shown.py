"""Derivatives of observables by values of effects that change what they are made of.

A gear that stays where it is may show something else: a thicker wire pulls with another force at
the same stretch. All else that an effect changes comes with the motion.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.partials import GearAtPoint


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
    still = observe(gear.model(gear.acting), state, tow).array()
    for effect in parameters.effects:
        if effect.name in names:
            for number, (size, model) in enumerate(gear.changed(effect)):
                found[:, first + number] = (observe(model, state, tow).array() - still) / size
        first += len(effect.parameters)
    return found
