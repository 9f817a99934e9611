"""Warm start: Newton's method from a known steady state, along its tangent and with tensions
that are carried on.

Two things keep Newton's method from its few steps in netting. A step across a bar stretches it to
second order, and the next matrix is stiffened by a pull that is not there; and a bar that is to
fall slack creeps there on the rounded corner of its law, by half at each step. Both end where the
matrix is made with the tension to which the step before would have led to first order, instead of
with the one at the new length (mixed integration point Newton: Magisano, Leonetti and Garcea
2017), and where a bar whose tension would be negative is taken for slack at once. The root is that
of the same forces: they alone decide when the search ends.
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.assembly import forces, linearised, points_of, rest_lengths
from trawl_ros.model.bar import SLACK_WIDTH, taut_at
from trawl_ros.model.compiled import compiled
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP, length, stepped
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.first_guess import at_velocity
from trawl_ros.solver.linear.factor import Factor, factorised
from trawl_ros.solver.relax import TOLERANCE, step_size
from trawl_ros.solver.rest_linearisation import nearly_linearised

LIMIT = 25
"""Iterations after which the search is given up: it needs six to ten where it succeeds."""

TURN = 0.3
"""Largest turn of a board (rad) along the tangent from which a start is tried."""

FARTHEST_STEP = 3.0
"""Step, as a share of the limits of `relax`, from which the search is given up."""

KEEP_RATE, KEEP_SIZE = 0.2, 0.02
"""A factorised matrix serves again after a step of at most this share of those limits, while it
brings the force down to this share at least."""

LEFT_BY_OTHERS = 1.0
"""Force (N) left at a known steady state from which more than the coefficients has changed."""

HALVINGS = 2
"""Number of times that a change of the towing boundary is halved before another way is tried."""

SLACK = -1.001 * SLACK_WIDTH
"""Strain of a bar that is taken for slack."""


@dataclass(frozen=True)
class Tangent:
    """Tangent of a steady state: displacements (dof, 15) per unit of the twelve coefficients, m of
    either warp and m/s of speed, at these coefficients (12,) and lengths of bars (m,) at rest.
    """

    coefficients: FloatArray
    rest: FloatArray
    columns: FloatArray

    def serves(self, model: GearModel, state: State, tow: Tow) -> bool:
        """True if no other property of the gear has changed since, of which it knows nothing."""
        same = model.with_coefficients(self.coefficients)
        return bool(np.abs(forces(same, state, tow)).max() <= LEFT_BY_OTHERS)


@dataclass(frozen=True)
class _Bars:
    """Bars after a step: their strains (m,), those by which their law is linearised, and the forces
    (dof,) by the linearised tensions beyond those that the strains give.
    """

    strains: FloatArray
    carried: FloatArray
    beyond: FloatArray


def warm_start(
    model: GearModel, state: State, old: Tow, new: Tow, tangent: Tangent | None = None
) -> tuple[State, int, float] | None:
    """Find the steady state at ``new`` from one that is known at ``old``.

    The known one may be that of a gear with other properties, as long as its bars are the same.
    ``tangent`` is its own, where that is known; it serves where no other property has changed.

    Returns
    -------
    state, iterations, residual
        As `relax` has them; None where the change is too large for the tangent.
    """
    try:
        first = _displacement(model, state, old, new, tangent)
    except RuntimeError:  # singular: a fold
        return None
    turns = first[3 * model.nodes :].reshape(2, 6)[:, 3:]
    if not np.abs(turns).max() <= TURN:
        return None
    before = _spans(model, state, old) / rest_lengths(_as_known(model, tangent), old)[0] - 1.0
    moved = at_velocity(state.moved(first), new.block_velocities.mean(0))
    return _newton(model, moved, new, before)


def warm_start_in_parts(
    model: GearModel,
    state: State,
    old: Tow,
    new: Tow,
    tangent: Tangent | None = None,
    halvings: int = HALVINGS,
) -> tuple[State, int, float] | None:
    """The same, by way of the state halfway where `warm_start` does not arrive.

    Bars that flip turn Newton's method away on long ways in fine nets, not on short ones.
    """
    found = warm_start(model, state, old, new, tangent)
    if (found and found[2] <= TOLERANCE) or halvings == 0:
        return found
    middle = Tow(*((a + b) / 2.0 for a, b in zip(_parts(old), _parts(new), strict=True)))
    if all(map(np.array_equal, _parts(old), _parts(middle))):
        return found
    spent = found[1] if found else 0
    for start, end, known in ((old, middle, tangent), (middle, new, None)):
        found = warm_start_in_parts(model, state, start, end, known, halvings - 1)
        if found is None:
            return None
        state, more, residual = found
        spent += more
        if residual > TOLERANCE:
            break
    return state, spent, residual


def _parts(tow: Tow) -> tuple[FloatArray, ...]:
    return tow.blocks, tow.block_velocities, tow.lengths, tow.length_rates


def _displacement(
    model: GearModel, state: State, old: Tow, new: Tow, tangent: Tangent | None
) -> FloatArray:
    """Displacement (dof,) of a known steady state to first order in all that has changed."""
    change = new.block_velocities.mean(0) - old.block_velocities.mean(0)
    along = old.blocks[0, 1] - old.blocks[1, 1], old.blocks[1, 0] - old.blocks[0, 0], 0.0
    ahead = np.array(along) / np.linalg.norm(along)
    faster = ahead @ change
    straight = np.allclose(change, faster * ahead) and np.array_equal(old.blocks, new.blocks)
    if tangent is not None and straight and tangent.serves(model, state, old):
        coefficients = model.coefficients - tangent.coefficients
        parameters = np.array([*coefficients, *(new.lengths - old.lengths), faster])
        return np.asarray(tangent.columns @ parameters)
    towed = replace(
        state,
        node_velocities=stepped(state.node_velocities, change),
        board_velocities=stepped(state.board_velocities, change),
    )
    changing = Tow(
        blocks=stepped(old.blocks, new.blocks - old.blocks),
        block_velocities=stepped(old.block_velocities, new.block_velocities - old.block_velocities),
        lengths=stepped(old.lengths, new.lengths - old.lengths),
        length_rates=old.length_rates,
    )
    # A taut wire that were longer at once would be slack, and pull less by no more than it did.
    cut = _as_known(model, tangent)
    push = forces(replace(cut, rest=stepped(cut.rest, model.rest - cut.rest)), towed, changing)
    known = nearly_linearised(cut, state, old)
    return known.factor.solve(push.real + push.imag / STEP)


def _as_known(model: GearModel, tangent: Tangent | None) -> GearModel:
    """Gear with its bars as long as they were in the known state."""
    return model if tangent is None else replace(model, rest=tangent.rest)


def _newton(
    model: GearModel, state: State, tow: Tow, before: FloatArray
) -> tuple[State, int, float]:
    """Newton's method from strains (m,) by which the bars' law is linearised at first."""
    rest = rest_lengths(model, tow)[0]
    bars = _carried(model, state, tow, rest, before)
    factor: Factor | None = None
    last = np.inf
    for iteration in range(LIMIT + 1):
        force = forces(model, state, tow)
        residual = float(np.abs(force).max())
        if residual < TOLERANCE or iteration == LIMIT or not np.isfinite(residual):
            break
        if factor is None or residual > KEEP_RATE * last:
            stretched = replace(model, rest=rest * (1.0 + bars.strains) / (1.0 + bars.carried))
            try:
                factor = factorised(model.pattern, linearised(stretched, state, tow).stiffness)
            except RuntimeError:  # singular
                break
            force += bars.beyond
        step = factor.solve(force)
        size = step_size(model, step)
        if size > FARTHEST_STEP:
            break
        if size > KEEP_SIZE:
            factor = None
        last = residual
        state = state.moved(step / max(size, 1.0))
        bars = _carried(model, state, tow, rest, bars.carried)
    return state, iteration, residual


def _spans(model: GearModel, state: State, tow: Tow) -> FloatArray:
    positions = points_of(model, state, tow).positions
    return length(positions[model.ends[:, 1]] - positions[model.ends[:, 0]])


def _carried(
    model: GearModel, state: State, tow: Tow, rest: FloatArray, before: FloatArray
) -> _Bars:
    """Bars after a step, from the strains by which their law was linearised before it."""
    properties = model.bars
    strains, carried = np.empty((2, len(before)))
    beyond = np.zeros(model.dof)
    _carry(
        model.ends,
        points_of(model, state, tow).positions,
        rest,
        properties.stiffness,
        properties.bow,
        before,
        model.nodes,
        strains,
        carried,
        beyond,
    )
    return _Bars(strains, carried, beyond)


@compiled
def _carry(
    ends: IntArray,
    x: FloatArray,
    rest: FloatArray,
    stiffness: FloatArray,
    bow: FloatArray,
    before: FloatArray,
    nodes: int,
    strains: FloatArray,
    carried: FloatArray,
    beyond: FloatArray,
) -> None:
    vector = np.empty(3)
    for n in range(len(ends)):
        start, end = ends[n, 0], ends[n, 1]
        for i in range(3):
            vector[i] = x[end, i] - x[start, i]
        span = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
        strain = span / rest[n] - 1.0
        strains[n] = carried[n] = strain
        elastic, slope, _ = taut_at(before[n], bow[n])
        # A bar without slope was slack: only its length tells whether it still is.
        if slope == 0.0:
            continue
        reached = elastic + slope * (strain - before[n])
        if bow[n] > 0.0:
            if reached > 0.0:
                carried[n] = reached - bow[n] / reached**2
        elif reached <= 0.0:
            carried[n] = min(strain, SLACK)
        elif reached < SLACK_WIDTH:
            carried[n] = 2.0 * np.sqrt(SLACK_WIDTH * reached) - SLACK_WIDTH
        else:
            carried[n] = reached
        if start < nodes and end < nodes:
            elastic, slope, _ = taut_at(carried[n], bow[n])
            linear = elastic + slope * (strain - carried[n])
            pull = stiffness[n] * (linear - taut_at(strain, bow[n])[0]) / span
            for i in range(3):
                beyond[3 * start + i] += pull * vector[i]
                beyond[3 * end + i] -= pull * vector[i]
