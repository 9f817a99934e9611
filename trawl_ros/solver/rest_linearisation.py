"""Linearisation of the forces at a steady state, with its factors; the newest are remembered.

Sensitivities, the slow mode, the derivatives by net and effects, and the way to the next steady
state all ask for the same matrix.
"""

from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

from trawl_ros.model.assembly import LinearisedForces, linearised
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import Factor, factorised

REMEMBERED = 2
"""A known state and one found from it. Each takes some 4 MB with the default gear."""


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


_RECENT: deque[RestLinearisation] = deque(maxlen=REMEMBERED)


def rest_linearisation(model: GearModel, state: State, tow: Tow) -> RestLinearisation:
    """The linearisation at a state, remembered where it is one of the newest."""
    for known in tuple(_RECENT):
        if known.state is state and known.tow is tow and known.model is model:
            return _renewed(known)
    new = RestLinearisation(model, state, tow)
    _RECENT.append(new)
    return new


def nearly_linearised(model: GearModel, state: State, tow: Tow) -> RestLinearisation:
    """The same, or that of a gear whose properties may differ, at the same state."""
    for known in tuple(_RECENT):
        if known.state is state and known.model.pattern is model.pattern:
            return _renewed(known)
    return rest_linearisation(model, state, tow)


def _renewed(known: RestLinearisation) -> RestLinearisation:
    """Make one the newest; another thread may have dropped it meanwhile."""
    with suppress(ValueError):
        _RECENT.remove(known)
    _RECENT.append(known)
    return known
