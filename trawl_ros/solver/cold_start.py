"""Cold start: steady shapes without a known neighbour, by refining coarser nets."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.first_guess import (
    carried_over,
    coarser_model,
    first_guess,
    shifted_to,
    softened,
)
from trawl_ros.solver.relax import TOLERANCE, WARM_LIMIT, WARM_TIME_STEP, relax, without_attitude

SOFT_LIMIT, LIMIT = 200, 300
"""Iterations after which a rough shape is given up, with softer ropes and with the real ones."""

LONGER, HAULS = 1.5, 6
"""Factor on the warp length, and number of hauling steps, where a fine net does not settle."""


def cold_start(model: GearModel, heading: float, tow: Tow) -> tuple[State, int, float]:
    """Find a steady shape from that of a coarser net or, for the coarsest, from a first guess.

    Unequal warps are reached from equal ones: the boards' first attitudes are equal too.

    Returns
    -------
    state, iterations, residual
        As `relax` has them.
    """
    even = replace(tow, lengths=np.full(2, tow.lengths.mean()))
    coarse = coarser_model(model)
    if coarse is None:
        state, spent, residual = _from_guess(model, even, heading)
    else:
        state, spent, residual = cold_start(coarse, heading, even)
        if residual > TOLERANCE:
            return state, spent, residual
        state, more, residual = _settled(model, carried_over(coarse, state, model), even)
        spent += more
        if residual > TOLERANCE and coarser_model(coarse) is not None:
            # A very fine net settles more easily on a longer warp, which is then hauled.
            state, more, residual = _hauled(model, coarse, heading, even)
            spent += more
    if residual > TOLERANCE or tow.lengths[0] == tow.lengths[1]:
        return state, spent, residual
    state, more, residual = relax(
        model, shifted_to(model, state, even, tow), tow, tolerance=TOLERANCE, time_step=2.0
    )
    return state, spent + more, residual


def _from_guess(model: GearModel, tow: Tow, heading: float) -> tuple[State, int, float]:
    # Boards keep their attitude until ropes and net have found a shape.
    state, spent, _ = relax(
        softened(model),
        first_guess(model, tow, heading),
        tow,
        tolerance=1000.0,
        time_step=2.0,
        free=without_attitude(model),
        limit=120,
    )
    state, more, residual = _settled(model, state, tow)
    return state, spent + more, residual


def _settled(model: GearModel, state: State, tow: Tow) -> tuple[State, int, float]:
    """Relax a rough shape, with softer ropes first."""
    state, spent, _ = relax(
        softened(model), state, tow, tolerance=100.0, time_step=1.0, limit=SOFT_LIMIT
    )
    state, more, residual = relax(
        model, state, tow, tolerance=TOLERANCE, time_step=1.0, limit=LIMIT
    )
    return state, spent + more, residual


def _hauled(
    model: GearModel, coarse: GearModel, heading: float, tow: Tow
) -> tuple[State, int, float]:
    """Steady shape hauled in, in a few steps, from `LONGER` times the warp length."""
    lengths = tow.lengths[0] * np.geomspace(LONGER, 1.0, HAULS + 1)
    steps = [replace(tow, lengths=np.full(2, length)) for length in lengths]
    state, spent, residual = cold_start(coarse, heading, steps[0])
    if residual > TOLERANCE:
        return state, spent, residual
    state, more, residual = _settled(model, carried_over(coarse, state, model), steps[0])
    spent += more
    for old, new in pairwise(steps):
        if residual > TOLERANCE:
            break
        state, more, residual = relax(
            model,
            shifted_to(model, state, old, new),
            new,
            tolerance=TOLERANCE,
            time_step=WARM_TIME_STEP,
            limit=WARM_LIMIT,
        )
        spent += more
    return state, spent, residual
