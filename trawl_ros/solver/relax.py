"""Newton with pseudo-transient continuation.

Each step is one implicit Euler step from rest, (M/τ² + C/τ + K) δ = F, with a time step τ that
grows while steps stay small; at τ = ∞ it is Newton's. Real mass and drag let the gear drift to
a state it would also reach at sea, rather than to any root near the start.
"""

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.model.assembly import forces, linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import Factor, factorised

TOLERANCE = 1e-4
"""Largest force (N) or moment (N m) left at a root; the last Newton step goes far below."""

LIMIT_METRES, LIMIT_RADIANS = 10.0, 0.1
"""Largest step of a node or board, and of a board's attitude."""

HEAVY = 1e2
"""Time step (s) from which mass is too little to matter beside drag and stiffness."""

KEEP_RATE, KEEP_SIZE = 0.4, 0.05
"""A factorised matrix serves again after a step of at most this share of the limits, while it
brings the force down to this share at least."""

LEAST_TIME_STEP = 1e-6
"""Time step (s) below which a matrix that is still singular stays so."""

WARM_TIME_STEP = 1e3
"""First time step (s) from a known state nearby: nearly Newton's own."""

WARM_LIMIT = 60
"""Iterations after which that is given up."""

DRIFT_TIME_STEP = 10.0
"""First time step (s) from a shape that is only roughly right."""

DRIFT_LIMIT = 90
"""Iterations after which such a start is given up."""


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
    """Drive the forces to zero.

    Parameters
    ----------
    free
        Mask (dof,) of what may move; all by default.
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
        if factor is not None and residual > KEEP_RATE * last:
            factor = None
            continue
        iteration += 1
        if factor is None:
            data = here.stiffness + here.damping / tau
            if tau < HEAVY:
                data += mass(model, state, tow) / tau**2
            try:
                factor = factorised(
                    model.pattern, data if free is None else model.pattern.held(data, free)
                )
            except RuntimeError:  # singular: a shorter time step adds mass and drag
                tau /= 4.0
                if tau < LEAST_TIME_STEP:
                    return state, iteration, residual
                continue
        step = factor.solve(force)
        size = step_size(model, step)
        # Bars that flip between slack and taut raise the residual and ask for shorter steps.
        growth = 3.0 if residual < last else max(0.25, last / residual)
        tau = max(tau / 1.5, 0.3) if size > 1.0 else min(max(growth * tau, 0.3), 1e9)
        if size > KEEP_SIZE:
            factor = None
        last = residual
        state = state.moved(step / max(size, 1.0))


def step_size(model: GearModel, step: FloatArray) -> float:
    """Size of a step (dof,) as a share of the limits."""
    n = model.nodes
    body = step[3 * n :].reshape(2, 6)
    metres = max(np.abs(step[: 3 * n]).max(), np.abs(body[:, :3]).max())
    return float(max(metres / LIMIT_METRES, np.abs(body[:, 3:]).max() / LIMIT_RADIANS))


def without_attitude(model: GearModel) -> BoolArray:
    """Mask (dof,) of all degrees of freedom but the boards' attitudes."""
    free = np.ones(model.dof, bool)
    free[3 * model.nodes :].reshape(2, 6)[:, 3:] = False
    return free
