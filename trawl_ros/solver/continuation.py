"""Pseudo-arclength continuation of steady states in one parameter, around folds.

Beside the shape q the parameter p is unknown, and the step along the branch, not that of p, is
given (Keller). So a branch is followed through a fold, where p turns back and K = -∂F/∂q is
singular.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import forces, linearised
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.first_guess import at_velocity
from trawl_ros.solver.linear.factor import Factor, factorised
from trawl_ros.solver.relax import LIMIT_METRES, LIMIT_RADIANS, TOLERANCE

ITERATIONS = 12
"""Newton steps after which a step along the branch is tried shorter."""

EASY = 5
"""Newton steps up to which the next step is longer."""

LONGEST, SHORTEST = 1.0, 1e-3
"""Step along the branch: the root mean square of all parts' changes in parts of `relax`'s limits,
and of the parameter's in parts of its scale."""

NUDGE = 1e-5
"""Part of the parameter's scale over which forces are differenced."""

Family = Callable[[float], tuple[GearModel, Tow]]
"""Gear and towing boundary at a value of the parameter."""


@dataclass(frozen=True)
class BranchPoint:
    """Point of a branch: the parameter's value, its gear, boundary and steady shape, and the rate
    of the parameter along the branch, which changes sign at a fold.
    """

    value: float
    model: GearModel
    tow: Tow
    state: State
    rate: float


def branch(family: Family, value: float, state: State, *, scale: float) -> Iterator[BranchPoint]:
    """Follow a branch from a steady shape, as long as steps can be made.

    Parameters
    ----------
    family
        Gear and boundary over the parameter.
    value, state
        Start of the branch, and a steady shape there.
    scale
        Change of the parameter that counts as one; its sign is the direction taken first.
    """
    model, tow = family(value)
    weights = _weights(model)
    state = at_velocity(state, tow.block_velocities.mean(0))
    _, factor = _factor(family, value, state)
    along, rate = _tangent(factor, family, value, state, scale, weights)
    step = 0.25 * LONGEST
    yield BranchPoint(value, model, tow, state, rate)
    while step >= SHORTEST:
        found = _corrected(family, value, state, (along, rate), step, scale, weights)
        if found is None:
            step *= 0.5
            continue
        value, state, factor, spent = found
        model, tow = family(value)
        ahead, turning = _tangent(factor, family, value, state, scale, weights)
        sign = np.sign(weights @ (ahead * along) + turning * rate)
        along, rate = sign * ahead, float(sign * turning)
        yield BranchPoint(value, model, tow, state, rate)
        if spent <= EASY:
            step = min(1.5 * step, LONGEST)


def _weights(model: GearModel) -> FloatArray:
    """Weights (dof,) of the squares of all parts' changes; they sum up to about one."""
    weights = np.full(model.dof, 1.0 / LIMIT_METRES**2)
    weights[3 * model.nodes :].reshape(2, 6)[:, 3:] = 1.0 / LIMIT_RADIANS**2
    weights[: 3 * model.nodes] /= model.nodes
    return weights


def _push(family: Family, value: float, state: State, scale: float) -> FloatArray:
    """Change of the forces (dof,) with the parameter, per scale."""
    sides = []
    for sign in (-1.0, 1.0):
        model, tow = family(value + sign * NUDGE * scale)
        sides.append(forces(model, at_velocity(state, tow.block_velocities.mean(0)), tow))
    return (sides[1] - sides[0]) / (2 * NUDGE)


def _factor(family: Family, value: float, state: State) -> tuple[FloatArray, Factor]:
    model, tow = family(value)
    here = linearised(model, at_velocity(state, tow.block_velocities.mean(0)), tow)
    return here.force, factorised(model.pattern, here.stiffness)


def _tangent(
    factor: Factor, family: Family, value: float, state: State, scale: float, weights: FloatArray
) -> tuple[FloatArray, float]:
    """Unit tangent of the branch: of the shape (dof,), and of the parameter in its scale."""
    along = factor.solve(_push(family, value, state, scale))
    size = float(np.sqrt(weights @ along**2 + 1.0))
    return along / size, 1.0 / size


def _corrected(
    family: Family,
    value: float,
    state: State,
    tangent: tuple[FloatArray, float],
    step: float,
    scale: float,
    weights: FloatArray,
) -> tuple[float, State, Factor, int] | None:
    """A step along the tangent, and Newton's steps across it back to the branch: the point there,
    with the factors of K and the number of Newton's steps; None where they do not come to rest.
    """
    along, rate = tangent
    state, value = state.moved(step * along), value + step * rate * scale
    for spent in range(ITERATIONS + 1):
        try:
            force, factor = _factor(family, value, state)
        except RuntimeError:
            return None
        if np.abs(force).max() < TOLERANCE:
            _, tow = family(value)
            return value, at_velocity(state, tow.block_velocities.mean(0)), factor, spent
        both = factor.solve(np.column_stack([force, _push(family, value, state, scale)]))
        across, with_value = weights * along @ both
        change = -across / (with_value + rate)
        move = both[:, 0] + change * both[:, 1]
        if not np.isfinite(change) or weights @ move**2 + change**2 > (4.0 * LONGEST) ** 2:
            return None
        state, value = state.moved(move), value + change * scale
    return None
