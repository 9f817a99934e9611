"""Cold start: steady shapes without a known neighbour, by continuation from bowed twine.

Netting has bars that pull and bars that hang slack, and Newton's steps flip them from one to the
other without end. Twine that bows under a load across it pulls a little however slack it hangs:
with a large load the shape is found easily, and the load is then taken away step by step.
"""

from dataclasses import replace

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
from trawl_ros.solver.relax import TOLERANCE, WARM_LIMIT, WARM_TIME_STEP, relax, without_attitude

PRESSURE = 1000.0
"""Load across a bar per area (Pa) with which a shape is sought: about three times that of the
water on netting that is towed at 2 m/s at 20° to its bars."""

HARDER = 1.0, 4.0, 16.0
"""Multiples of that load that are tried one after another, each where the one before does not calm
the netting: nets of thick twine, or held so that they come to lie nearly flat, need more."""

COARSE_LIMIT, LIMIT = 100, 3.0
"""Iterations after which a rough shape is given up: of the coarsest net, and of finer ones per
square root of the number of nodes, so per row and column. With 48 meshes around up to 63 are
needed, with 96 up to 160."""

ROUGH, SHARE = 1.0, 0.01
"""Force (N) left at which a shape with bowed twine is found; on the way down, at which share of the
force that the fall of the load has left over, where that is more."""

LEAST, TOO_LITTLE = 4.0, 1e-3
"""Load (Pa) below which it is taken away altogether; where that fails it is lowered on, down to
the second value."""

FIRST_FALL, FALL, LEAST_FALL = 2.0, 3.0, 1.2
"""Factors by which the load is lowered at first, with nothing known of what that does to the shape,
and later, and the one at which that is given up."""

BOWED_POWER = 2.0 / 3.0
"""Power of the load with which the tension rises of a bar that is just as long as it is unstretched
(`trawl_ros.model.bar.bowed_at`): the shape is nearly a straight line in that."""


def cold_start(
    model: GearModel, heading: float, tow: Tow, *, lying: bool = False, turned: bool = False
) -> tuple[State, int, float]:
    """Find a steady shape from that of a coarser net or, for the coarsest, from a first guess.

    Unequal warps are reached from equal ones: the boards' first attitudes are equal too.

    Parameters
    ----------
    lying
        True: boards may lie on their backs. False: the search is given up where they do with bowed
        twine, whose load then takes long to be taken away.
    turned
        True: the search begins with plates of a pair turned over.

    Returns
    -------
    state, iterations, residual
        As `relax` has them.
    """
    even = replace(tow, lengths=np.full(2, tow.lengths.mean()))
    spent = 0
    for harder in HARDER:
        pressure = harder * PRESSURE
        state, more, residual = _bowed_shape(model, heading, even, pressure, turned=turned)
        spent += more
        if residual <= ROUGH:
            break
    if residual <= ROUGH:
        if not lying and lies_over(model, state) and outward_normal_lift(state).min() > 0.0:
            return state, spent, ROUGH
        state, more, residual = straightened(model, state, even, pressure=pressure)
        spent += more
    if residual > TOLERANCE or tow.lengths[0] == tow.lengths[1]:
        return state, spent, residual
    state, more, residual = relax(
        model, shifted_to(model, state, even, tow), tow, tolerance=TOLERANCE, time_step=2.0
    )
    return state, spent + more, residual


def bowed(model: GearModel, pressure: float) -> GearModel:
    """The same gear with bars that bow at least as under this load (Pa) across them."""
    bars = model.bars
    load = pressure * bars.normal_area * model.rest / bars.stiffness
    bow = np.where(model.warp_side < 0, load**2 / 24.0, 0.0)
    return replace(model, bars=replace(bars, bow=np.maximum(bars.bow, bow)))


def _bowed_shape(
    model: GearModel, heading: float, tow: Tow, pressure: float, *, turned: bool
) -> tuple[State, int, float]:
    """Shape of the gear with twine that is bowed by this load, Pa."""
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
        if residual > ROUGH:
            return state, spent, residual
        state = carried_over(coarse, state, model)
    limit = round(LIMIT * np.sqrt(model.nodes)) if coarse else COARSE_LIMIT
    state, more, residual = relax(loose, state, tow, tolerance=ROUGH, time_step=1.0, limit=limit)
    return state, spent + more, residual


def held_shape(model: GearModel, state: State, tow: Tow) -> tuple[State, int, float]:
    """Find the shape of a gear whose boards keep the attitude that they have, as `relax` has it."""
    free = without_attitude(model)
    state, spent, residual = relax(
        bowed(model, PRESSURE), state, tow, tolerance=ROUGH, time_step=2.0, free=free
    )
    if residual > ROUGH:
        return state, spent, residual
    state, more, residual = straightened(model, state, tow, free)
    return state, spent + more, residual


def straightened(
    model: GearModel,
    state: State,
    tow: Tow,
    free: BoolArray | None = None,
    *,
    pressure: float = PRESSURE,
) -> tuple[State, int, float]:
    """Take the load of `bowed` (Pa) away from a shape found with it; ``free`` as for `relax`."""
    fall, least, spent, before = FALL, LEAST, 0, None
    while True:
        lower = pressure / (fall if before else min(fall, FIRST_FALL))
        last = lower < least
        wanted, start, trial_model = TOLERANCE, state, model
        if not last:
            trial_model = bowed(model, lower)
            left = forces(trial_model, state, tow)
            if free is not None:
                left = left[free]
            wanted = max(ROUGH, SHARE * float(np.abs(left).max()))
        if before:
            start = _on(*before, pressure, state, 0.0 if last else lower)
        trial, more, residual = relax(
            trial_model,
            start,
            tow,
            tolerance=wanted,
            time_step=WARM_TIME_STEP,
            free=free,
            limit=WARM_LIMIT,
        )
        spent += more
        if residual <= wanted:
            before = pressure, state
            state, pressure = trial, lower
            if last:
                return state, spent, residual
        elif last and least > TOO_LITTLE:
            least /= FALL**2
        elif fall > LEAST_FALL:
            fall = np.sqrt(fall)
        else:
            return trial, spent, residual


def _on(high: float, first: State, low: float, second: State, load: float) -> State:
    """The shape at a load, on the straight line through those at two higher ones (Pa)."""
    top, here, there = (value**BOWED_POWER for value in (high, low, load))
    share = (here - there) / (top - here)
    return replace(
        second,
        nodes=second.nodes + share * (second.nodes - first.nodes),
        board_positions=second.board_positions
        + share * (second.board_positions - first.board_positions),
    )
