# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pseudo-arclength continuation of steady states in one parameter, around folds.

The shape q and the parameter p are both unknown, and the step along the branch is given (Keller
1977). So a branch is followed through a fold, where p turns back and K = -∂F/∂q is singular.
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
from trawl_ros.solver.relax import FORCE_TOLERANCE, MAX_STEP_M, MAX_STEP_RAD

Family = Callable[[float], tuple[GearModel, Tow]]
"""Gear and towing boundary at a value of the parameter."""


@dataclass(frozen=True)
class ContinuationOptions:
    """Options of a continuation.

    A step along the branch is the root mean square of all displacements relative to `relax`'s
    largest step, and of the parameter's change relative to its scale.

    Attributes
    ----------
    newton_steps
        Newton steps after which a shorter step along the branch is tried.
    easy_newton_steps
        Newton steps up to which the next step along the branch is longer.
    max_step, min_step
        Longest step along the branch, and the one below which it ends.
    scale_fraction
        Step of force differences, as a fraction of the parameter's scale.
    """

    newton_steps: int = 12
    easy_newton_steps: int = 5
    max_step: float = 1.0
    min_step: float = 1e-3
    scale_fraction: float = 1e-5


OPTIONS = ContinuationOptions()


@dataclass(frozen=True)
class BranchPoint:
    """Point of a branch: value of the parameter, its gear, boundary and steady shape.

    ``rate`` is the rate of the parameter along the branch, which changes sign at a fold.
    """

    value: float
    model: GearModel
    tow: Tow
    state: State
    rate: float


def branch(family: Family, value: float, state: State, *, scale: float) -> Iterator[BranchPoint]:
    """Follow a branch from a steady shape, as long as the steps converge.

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
    step = 0.25 * OPTIONS.max_step
    yield BranchPoint(value, model, tow, state, rate)
    while step >= OPTIONS.min_step:
        found = _corrected(family, value, state, (along, rate), step, scale, weights)
        if found is None:
            step *= 0.5
            continue
        value, state, factor, spent = found
        model, tow = family(value)
        ahead, turning = _tangent(factor, family, value, state, scale, weights)
        # The tangent keeps its direction, so the branch is not followed back.
        sign = np.sign(weights @ (ahead * along) + turning * rate)
        along, rate = sign * ahead, float(sign * turning)
        yield BranchPoint(value, model, tow, state, rate)
        if spent <= OPTIONS.easy_newton_steps:
            step = min(1.5 * step, OPTIONS.max_step)


def _weights(model: GearModel) -> FloatArray:
    """Return weights (dof,) of squared displacements, which sum up to about one."""
    weights = np.full(model.dof, 1.0 / MAX_STEP_M**2)
    weights[3 * model.nodes :].reshape(2, 6)[:, 3:] = 1.0 / MAX_STEP_RAD**2
    weights[: 3 * model.nodes] /= model.nodes
    return weights


def _push(family: Family, value: float, state: State, scale: float) -> FloatArray:
    """Return the change of the forces (dof,) with the parameter, per scale."""
    sides, nudge = [], OPTIONS.scale_fraction
    for sign in (-1.0, 1.0):
        model, tow = family(value + sign * nudge * scale)
        sides.append(forces(model, at_velocity(state, tow.block_velocities.mean(0)), tow))
    return (sides[1] - sides[0]) / (2 * nudge)


def _factor(family: Family, value: float, state: State) -> tuple[FloatArray, Factor]:
    model, tow = family(value)
    here = linearised(model, at_velocity(state, tow.block_velocities.mean(0)), tow)
    return here.force, factorised(model.pattern, here.stiffness)


def _tangent(
    factor: Factor, family: Family, value: float, state: State, scale: float, weights: FloatArray
) -> tuple[FloatArray, float]:
    """Return the unit tangent: of the shape (dof,), and of the parameter in its scale."""
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
    """Step along the tangent and return to the branch by Newton steps normal to it.

    Returns the value and state there, the factors of K and the number of Newton steps; None where
    they do not converge.
    """
    along, rate = tangent
    state, value = state.moved(step * along), value + step * rate * scale
    for spent in range(OPTIONS.newton_steps + 1):
        try:
            force, factor = _factor(family, value, state)
        except RuntimeError:
            return None
        if np.abs(force).max() < FORCE_TOLERANCE:
            _, tow = family(value)
            return value, at_velocity(state, tow.block_velocities.mean(0)), factor, spent
        # Bordered system by block elimination: K δq = F + δp ∂F/∂p, with (δq, δp) ⟂ tangent.
        both = factor.solve(np.column_stack([force, _push(family, value, state, scale)]))
        across, with_value = weights * along @ both
        change = -across / (with_value + rate)
        move = both[:, 0] + change * both[:, 1]
        if not np.isfinite(change) or weights @ move**2 + change**2 > (4.0 * OPTIONS.max_step) ** 2:
            return None
        state, value = state.moved(move), value + change * scale
    return None
