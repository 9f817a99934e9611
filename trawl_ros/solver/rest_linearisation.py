# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Linearisation of the forces at a steady state, with its factors, in a small cache.

Sensitivities, the slow mode, derivatives by net and effects, and the tangent to the next steady
state all use the same matrix.
"""

from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

from trawl_ros.model.assembly import LinearisedForces, linearised
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import Factor, factorised

CACHED_STATES = 2
"""A known state and one found from it. Each takes about 4 MB with the default gear."""


@dataclass(frozen=True, eq=False)
class RestLinearisation:
    """Linearisation of a gear's forces at one state."""

    model: GearModel
    state: State
    tow: Tow

    @cached_property
    def motion(self) -> LinearisedForces:
        """Forces, K = -∂F/∂q and C = -∂F/∂v."""
        return linearised(self.model, self.state, self.tow)

    @cached_property
    def factor(self) -> Factor:
        """Factors of K.

        Raises
        ------
        RuntimeError
            If the matrix is singular.
        """
        return factorised(self.model.pattern, self.motion.stiffness)


_RECENT: deque[RestLinearisation] = deque(maxlen=CACHED_STATES)


def rest_linearisation(model: GearModel, state: State, tow: Tow) -> RestLinearisation:
    """Return the linearisation at a state, from the cache if it is there."""
    for known in tuple(_RECENT):
        if known.state is state and known.tow is tow and known.model is model:
            return _renewed(known)
    new = RestLinearisation(model, state, tow)
    _RECENT.append(new)
    return new


def nearly_linearised(model: GearModel, state: State, tow: Tow) -> RestLinearisation:
    """Return the same, or one of a gear with other properties at the same state."""
    for known in tuple(_RECENT):
        if known.state is state and known.model.pattern is model.pattern:
            return _renewed(known)
    return rest_linearisation(model, state, tow)


def _renewed(known: RestLinearisation) -> RestLinearisation:
    """Move a linearisation to the end of the cache."""
    # Another thread may have dropped it meanwhile.
    with suppress(ValueError):
        _RECENT.remove(known)
    _RECENT.append(known)
    return known
