# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Cold start: steady shapes without a known neighbour, by continuation from bowed twine.

Netting has taut bars and slack bars, and Newton steps flip them back and forth without converging.
Twine that bows under a load across it still pulls a little when it is slack. With a large load the
shape is found easily; the load is then reduced step by step to zero (a homotopy).
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import BoolArray
from trawl_ros.model.assembly import forces
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import lies_over, outward_normal_lift
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.first_guess import (
    carried_over,
    coarser_model,
    first_guess,
    shifted_to,
)
from trawl_ros.solver.relax import (
    FORCE_TOLERANCE,
    WARM_ITERATIONS,
    WARM_TIME_STEP_S,
    relax,
    without_attitude,
)

BOW_PRESSURE_PA = 1000.0
"""Load across a bar per area in the first search: about three times that of the water on netting
that is towed at 2 m/s at 20° to its bars."""

BOWED_POWER = 2.0 / 3.0
"""Exponent of the load in the tension of a bar at its unstretched length
(`trawl_ros.model.bar.bowed_at`): the shape is nearly linear in this power of the load."""


@dataclass(frozen=True)
class ColdStartOptions:
    """Options of the continuation from bowed twine.

    Attributes
    ----------
    pressure_factors
        Multiples of the first load, each tried where the one before does not converge: nets of
        thick twine, or held nearly flat, need more.
    coarse_iterations
        Iterations for the coarsest net.
    iterations_per_row
        Iterations for finer nets, per square root of the number of nodes. With 48 meshes around up
        to 63 are needed, with 96 up to 160.
    rough_force_n
        Force left at which a shape with bowed twine is converged.
    rough_ratio
        The same, relative to the force that the last reduction of the load left over.
    min_pressure_pa, last_pressure_pa
        Load below which it is set to zero; where this fails it is reduced further, down to the
        second value.
    first_reduction, reduction, min_reduction
        Factors of the first reduction, of later ones, and the factor at which it is given up.
    """

    pressure_factors: tuple[float, ...] = (1.0, 4.0, 16.0)
    coarse_iterations: int = 100
    iterations_per_row: float = 3.0
    rough_force_n: float = 1.0
    rough_ratio: float = 0.01
    min_pressure_pa: float = 4.0
    last_pressure_pa: float = 1e-3
    first_reduction: float = 2.0
    reduction: float = 3.0
    min_reduction: float = 1.2


OPTIONS = ColdStartOptions()


def cold_start(
    model: GearModel, heading: float, tow: Tow, *, lying: bool = False, turned: bool = False
) -> tuple[State, int, float]:
    """Find a steady shape from that of a coarser net or, for the coarsest, from a first guess.

    Unequal warps are reached from equal ones, because the boards' first attitudes are equal too.

    Parameters
    ----------
    lying
        True to allow boards that lie on their backs. False gives up where they do with bowed twine,
        because reducing its load then takes long.
    turned
        True to begin with plates of a pair turned over.

    Returns
    -------
    state, iterations, residual
        As `relax` has them.
    """
    even = replace(tow, lengths=np.full(2, tow.lengths.mean()))
    spent = 0
    for factor in OPTIONS.pressure_factors:
        pressure = factor * BOW_PRESSURE_PA
        state, more, residual = _bowed_shape(model, heading, even, pressure, turned=turned)
        spent += more
        if residual <= OPTIONS.rough_force_n:
            break
    if residual <= OPTIONS.rough_force_n:
        if not lying and lies_over(model, state) and outward_normal_lift(state).min() > 0.0:
            return state, spent, OPTIONS.rough_force_n
        state, more, residual = straightened(model, state, even, pressure=pressure)
        spent += more
    if residual > FORCE_TOLERANCE or tow.lengths[0] == tow.lengths[1]:
        return state, spent, residual
    state, more, residual = relax(
        model, shifted_to(model, state, even, tow), tow, tolerance=FORCE_TOLERANCE, time_step=2.0
    )
    return state, spent + more, residual


def bowed(model: GearModel, pressure: float) -> GearModel:
    """Return the gear with bars that bow at least as under this load (Pa) across them."""
    bars = model.bars
    load = pressure * bars.normal_area * model.rest / bars.stiffness
    # With the load Q on all of a bar, bow = (Q / EA)² / 24 (`trawl_ros.model.bar.bowed_at`).
    bow = np.where(model.warp_side < 0, load**2 / 24.0, 0.0)
    return replace(model, bars=replace(bars, bow=np.maximum(bars.bow, bow)))


def _bowed_shape(
    model: GearModel, heading: float, tow: Tow, pressure: float, *, turned: bool
) -> tuple[State, int, float]:
    """Find the shape of the gear with twine that is bowed by this load, Pa."""
    coarse = coarser_model(model)
    loose = bowed(model, pressure)
    if coarse is None:
        # Boards keep their attitude until ropes and net have found a shape.
        state, spent, _ = relax(
            loose,
            first_guess(model, tow, heading, turned=turned),
            tow,
            tolerance=1000.0,
            time_step=2.0,
            free=without_attitude(model),
            limit=120,
        )
    else:
        state, spent, residual = _bowed_shape(coarse, heading, tow, pressure, turned=turned)
        if residual > OPTIONS.rough_force_n:
            return state, spent, residual
        state = carried_over(coarse, state, model)
    limit = OPTIONS.coarse_iterations
    if coarse is not None:
        limit = round(OPTIONS.iterations_per_row * np.sqrt(model.nodes))
    state, more, residual = relax(
        loose, state, tow, tolerance=OPTIONS.rough_force_n, time_step=1.0, limit=limit
    )
    return state, spent + more, residual


def held_shape(model: GearModel, state: State, tow: Tow) -> tuple[State, int, float]:
    """Find the shape of a gear whose boards keep their attitudes; returns as `relax` does."""
    free = without_attitude(model)
    state, spent, residual = relax(
        bowed(model, BOW_PRESSURE_PA),
        state,
        tow,
        tolerance=OPTIONS.rough_force_n,
        time_step=2.0,
        free=free,
    )
    if residual > OPTIONS.rough_force_n:
        return state, spent, residual
    state, more, residual = straightened(model, state, tow, free)
    return state, spent + more, residual


def straightened(
    model: GearModel,
    state: State,
    tow: Tow,
    free: BoolArray | None = None,
    *,
    pressure: float = BOW_PRESSURE_PA,
) -> tuple[State, int, float]:
    """Reduce the load of `bowed` (Pa) to zero, from its shape; ``free`` as in `relax`."""
    fall, least = OPTIONS.reduction, OPTIONS.min_pressure_pa
    spent, before = 0, None
    while True:
        lower = pressure / (fall if before else min(fall, OPTIONS.first_reduction))
        last = lower < least
        wanted, start, trial_model = FORCE_TOLERANCE, state, model
        if not last:
            trial_model = bowed(model, lower)
            left = forces(trial_model, state, tow)
            if free is not None:
                left = left[free]
            wanted = max(OPTIONS.rough_force_n, OPTIONS.rough_ratio * float(np.abs(left).max()))
        if before:
            start = _extrapolated(*before, pressure, state, 0.0 if last else lower)
        trial, more, residual = relax(
            trial_model,
            start,
            tow,
            tolerance=wanted,
            time_step=WARM_TIME_STEP_S,
            free=free,
            limit=WARM_ITERATIONS,
        )
        spent += more
        if residual <= wanted:
            before = pressure, state
            state, pressure = trial, lower
            if last:
                return state, spent, residual
        elif last and least > OPTIONS.last_pressure_pa:
            least /= OPTIONS.reduction**2
        elif fall > OPTIONS.min_reduction:
            fall = np.sqrt(fall)
        else:
            return trial, spent, residual


def _extrapolated(high: float, first: State, low: float, second: State, load: float) -> State:
    """Extrapolate the shape at a load from those at two higher loads (Pa)."""
    top, here, there = (value**BOWED_POWER for value in (high, low, load))
    share = (here - there) / (top - here)
    return replace(
        second,
        nodes=second.nodes + share * (second.nodes - first.nodes),
        board_positions=second.board_positions
        + share * (second.board_positions - first.board_positions),
    )
