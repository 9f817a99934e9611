# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Newton with pseudo-transient continuation.

Each step is one implicit Euler step from rest, (M/τ² + C/τ + K) δ = F, with a time step τ that
grows while steps stay small; at τ = ∞ it is Newton's (switched evolution relaxation: Mulder and van
Leer 1985). Real mass and drag lead the gear to a state that it would also reach at sea, rather than
to any root near the start.
"""

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.model.assembly import forces, linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import Factor, factorised

FORCE_TOLERANCE = 1e-4
"""Largest force (N) or moment (N m) left at a root; the last Newton step goes far below."""

MAX_STEP_M, MAX_STEP_RAD = 10.0, 0.1
"""Largest step of a node or board, and of a board's attitude."""

MASSLESS_TIME_STEP_S = 1e2
"""Time step from which M/τ² is negligible compared with C/τ and K."""

KEEP_MAX_RATE, KEEP_MAX_STEP = 0.4, 0.05
"""The factorised matrix is kept while the residual falls to at most this ratio, after a step of at
most this fraction of the largest."""

MAX_GROWTH, MIN_GROWTH, SHRINKING = 3.0, 0.25, 1.5
"""Factors on the time step: the largest, while the residual falls; the least, where it rises; and
the divisor after a step that was too large."""

SHORTEST_TIME_STEP_S, LONGEST_TIME_STEP_S = 0.3, 1e9
"""Bounds of the time step: with the longest, a step is Newton's to rounding."""

SINGULAR_TIME_STEP_S = 1e-6
"""Time step below which a matrix that is still singular remains singular."""

WARM_TIME_STEP_S, WARM_ITERATIONS = 1e3, 60
"""First time step from a known state nearby, nearly Newton's; iterations until it is given up."""

DRIFT_TIME_STEP_S, DRIFT_ITERATIONS = 10.0, 90
"""The same from a shape that is only roughly right."""


def relax(
    model: GearModel,
    state: State,
    tow: Tow,
    *,
    tolerance: float,
    time_step: float,
    free: BoolArray | None = None,
    limit: int = 300,
) -> tuple[State, int, float]:
    """Find a root of the forces from a state nearby.

    Parameters
    ----------
    free
        Mask (dof,) of the degrees of freedom that may move; all by default.
    limit
        Iterations after which the search is given up.

    Returns
    -------
    state, iterations, residual
        The residual is the largest force or moment left.
    """
    tau = time_step
    iteration = 0
    last = np.inf
    factor: Factor | None = None
    while True:
        if factor is None:
            here = linearised(model, state, tow)
            force = here.force
        else:
            force = forces(model, state, tow)
        if free is not None:
            force = np.where(free, force, 0.0)
        residual = float(np.abs(force).max())
        if residual < tolerance or iteration == limit or not np.isfinite(residual):
            return state, iteration, residual
        if factor is not None and residual > KEEP_MAX_RATE * last:
            factor = None
            continue
        iteration += 1
        if factor is None:
            data = here.stiffness + here.damping / tau
            if tau < MASSLESS_TIME_STEP_S:
                data += mass(model, state, tow) / tau**2
            try:
                factor = factorised(
                    model.pattern, data if free is None else model.pattern.held(data, free)
                )
            except RuntimeError:  # singular: a shorter time step adds mass and drag
                tau /= 4.0
                if tau < SINGULAR_TIME_STEP_S:
                    return state, iteration, residual
                continue
        step = factor.solve(force)
        size = step_size(model, step)
        # Bars that flip between slack and taut raise the residual: take a shorter time step.
        growth = MAX_GROWTH if residual < last else max(MIN_GROWTH, last / residual)
        tau = tau / SHRINKING if size > 1.0 else growth * tau
        tau = min(max(tau, SHORTEST_TIME_STEP_S), LONGEST_TIME_STEP_S)
        if size > KEEP_MAX_STEP:
            factor = None
        last = residual
        state = state.moved(step / max(size, 1.0))


def relax_warm(model: GearModel, state: State, tow: Tow) -> tuple[State, int, float]:
    """Find a root from a known state nearby; returns as `relax` does."""
    return relax(
        model,
        state,
        tow,
        tolerance=FORCE_TOLERANCE,
        time_step=WARM_TIME_STEP_S,
        limit=WARM_ITERATIONS,
    )


def step_size(model: GearModel, step: FloatArray) -> float:
    """Return the size of a step (dof,) as a fraction of the largest step."""
    n = model.nodes
    body = step[3 * n :].reshape(2, 6)
    metres = max(np.abs(step[: 3 * n]).max(), np.abs(body[:, :3]).max())
    return float(max(metres / MAX_STEP_M, np.abs(body[:, 3:]).max() / MAX_STEP_RAD))


def without_attitude(model: GearModel) -> BoolArray:
    """Return a mask (dof,) of all degrees of freedom but the boards' attitudes."""
    free = np.ones(model.dof, bool)
    free[3 * model.nodes :].reshape(2, 6)[:, 3:] = False
    return free
