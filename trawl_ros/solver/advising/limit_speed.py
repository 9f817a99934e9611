"""Least speed at which a gear is towed, or highest, next to one at which it is not."""

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import (
    Equilibrium,
    SteadyState,
    find_equilibrium,
    require_usable,
    steady_state,
    with_effects,
)

FASTER, SLOWER = (1.1, 1.3, 1.7), (0.9, 0.75, 0.6)
"""Multiples of a refused speed at which a usable state is looked for; slower ones for a gear that
breaks the surface."""

NEAR = 0.01
"""Part of the speed to which the least or highest usable one is found."""


def state_near(
    model: GearModel, warp_length: float, speed: float, start: Equilibrium
) -> Equilibrium:
    """Equilibrium at a warp length and speed, sought from a known one alone."""
    acting, point = with_effects(model, (warp_length, warp_length), speed)
    return find_equilibrium(acting, point, start, cold=False)


def usable_state(
    model: GearModel, warp_length: float, speed: float, start: Equilibrium
) -> SteadyState | NoSteadyState:
    """Usable state at a warp length and speed, from a known one, or why it is not."""
    acting, _ = with_effects(model, (warp_length, warp_length), speed)
    try:
        return require_usable(acting, state_near(model, warp_length, speed, start))
    except NoSteadyState as reason:
        return reason


def nearest_usable(
    model: GearModel,
    warp_length: float,
    speed: float,
    refusal: NoSteadyState,
    root: Equilibrium | None,
) -> tuple[SteadyState, str] | None:
    """Usable state nearest in speed to the refused one, and what is refused next to it."""
    bad, beyond = speed, str(refusal)
    for factor in SLOWER if refusal.reason == 'surfaced' else FASTER:
        if root is not None:
            found = usable_state(model, warp_length, factor * speed, root)
        else:
            try:
                found = steady_state(model, warp_length, factor * speed)
            except NoSteadyState as reason:
                found = reason
        if isinstance(found, SteadyState):
            return closer_usable(model, warp_length, found, bad, beyond)
        bad, beyond = factor * speed, str(found)
    return None


def closer_usable(
    model: GearModel, warp_length: float, found: SteadyState, bad: float, beyond: str
) -> tuple[SteadyState, str]:
    """Usable state as near as `NEAR` to where there is none, between a known one and a speed, and
    what is refused there.
    """
    good = found.equilibrium.point.speed
    while abs(good - bad) > NEAR * bad:
        middle = round(0.5 * (good + bad), 3)
        nearer = usable_state(model, warp_length, middle, found.equilibrium)
        if isinstance(nearer, SteadyState):
            found, good = nearer, middle
        else:
            bad, beyond = middle, str(nearer)
    return found, beyond


def shown_speed(edge: SteadyState, speed: float) -> float:
    """Speed of a state rounded to cm/s, away from what is refused."""
    own = edge.equilibrium.point.speed
    return float((np.ceil if own > speed else np.floor)(100.0 * own - 1e-6) / 100.0)
