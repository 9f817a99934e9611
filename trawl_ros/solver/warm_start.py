# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Warm start: Newton's method along the tangent of a known state, with extrapolated tensions.

Two properties of netting slow down Newton's method. A step across a bar stretches it to second
order, and this false tension stiffens the next matrix. And a bar that goes slack approaches it on
the rounded corner of its law, halving the distance at each step. Both are avoided by two changes
of the matrix. It is made with the first-order tension of the step before instead of the tension at
the new length (mixed integration point Newton: Magisano, Leonetti and Garcea 2017). And a bar whose
tension would be negative is slack at once. The forces, and so the root, stay the same.
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
from trawl_ros.solver.relax import FORCE_TOLERANCE, step_size
from trawl_ros.solver.rest_linearisation import nearly_linearised

MAX_BOUNDARY_HALVINGS = 2
"""Number of times that a change of the towing boundary is halved before the search is given up."""

SLACK_STRAIN = -1.001 * SLACK_WIDTH
"""Strain at which a bar with negative tension is linearised: just on the slack branch."""


@dataclass(frozen=True)
class WarmStartOptions:
    """Options of a warm start.

    Attributes
    ----------
    iterations
        Iterations until the search is given up; it needs six to ten where it succeeds.
    max_board_turn
        Largest rotation of a board along the tangent, rad.
    max_step
        Largest step, relative to the largest of `relax`.
    keep_max_rate, keep_max_step
        The factorised matrix is kept while the residual falls to at most this ratio, after a step
        of at most this size relative to the largest of `relax`.
    max_tangent_residual_n
        Force left at the known state, N, above which more than the coefficients has changed.
    """

    iterations: int = 25
    max_board_turn: float = 0.3
    max_step: float = 3.0
    keep_max_rate: float = 0.2
    keep_max_step: float = 0.02
    max_tangent_residual_n: float = 1.0


OPTIONS = WarmStartOptions()


@dataclass(frozen=True)
class Tangent:
    """Tangent of a steady state.

    ``columns`` (dof, q + 3) are displacements per unit of the q coefficients, per m of either
    warp and per m/s of speed, at ``coefficients`` (q,) and unstretched lengths ``rest`` (m,).
    """

    coefficients: FloatArray
    rest: FloatArray
    columns: FloatArray

    def serves(self, model: GearModel, state: State, tow: Tow) -> bool:
        """Return True if only coefficients of the gear have changed since."""
        same = model.with_coefficients(self.coefficients)
        return bool(np.abs(forces(same, state, tow)).max() <= OPTIONS.max_tangent_residual_n)


@dataclass(frozen=True)
class _Bars:
    """Bars after a step.

    ``strains`` (m,) are those of their lengths, ``extrapolated`` (m,) those of the linearisation,
    and ``excess`` (dof,) the forces by linearised tensions minus those by the strains.
    """

    strains: FloatArray
    extrapolated: FloatArray
    excess: FloatArray


def warm_start(
    model: GearModel, state: State, old: Tow, new: Tow, tangent: Tangent | None = None
) -> tuple[State, int, float] | None:
    """Find the steady state at ``new`` from a known one at ``old``.

    The known state may be of a gear with other properties, as long as its bars are the same. Its
    ``tangent`` is used if it is known and no other property has changed.

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
    if not np.abs(turns).max() <= OPTIONS.max_board_turn:
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
    halvings: int = MAX_BOUNDARY_HALVINGS,
) -> tuple[State, int, float] | None:
    """Find the same state by way of the one halfway, where `warm_start` does not converge.

    In fine nets, flipping bars stop Newton's method on large changes, but not on small ones.
    """
    found = warm_start(model, state, old, new, tangent)
    if (found and found[2] <= FORCE_TOLERANCE) or halvings == 0:
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
        if residual > FORCE_TOLERANCE:
            break
    return state, spent, residual


def _parts(tow: Tow) -> tuple[FloatArray, ...]:
    return tow.blocks, tow.block_velocities, tow.lengths, tow.length_rates


def _displacement(
    model: GearModel, state: State, old: Tow, new: Tow, tangent: Tangent | None
) -> FloatArray:
    """Return the first-order displacement (dof,) of a known state for all that has changed."""
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
    # Complex step along the change: made at once, a longer unstretched wire would go slack.
    cut = _as_known(model, tangent)
    push = forces(replace(cut, rest=stepped(cut.rest, model.rest - cut.rest)), towed, changing)
    known = nearly_linearised(cut, state, old)
    return known.factor.solve(push.real + push.imag / STEP)


def _as_known(model: GearModel, tangent: Tangent | None) -> GearModel:
    """Return the gear with the unstretched lengths of the known state."""
    return model if tangent is None else replace(model, rest=tangent.rest)


def _newton(
    model: GearModel, state: State, tow: Tow, before: FloatArray
) -> tuple[State, int, float]:
    """Run Newton's method; ``before`` (m,) are the strains of the first linearisation."""
    rest = rest_lengths(model, tow)[0]
    bars = _extrapolated(model, state, tow, rest, before)
    factor: Factor | None = None
    last = np.inf
    for iteration in range(OPTIONS.iterations + 1):
        force = forces(model, state, tow)
        residual = float(np.abs(force).max())
        if (
            residual < FORCE_TOLERANCE
            or iteration == OPTIONS.iterations
            or not np.isfinite(residual)
        ):
            break
        if factor is None or residual > OPTIONS.keep_max_rate * last:
            # Other unstretched lengths give the model the extrapolated strains at its lengths.
            stretched = replace(model, rest=rest * (1.0 + bars.strains) / (1.0 + bars.extrapolated))
            try:
                factor = factorised(model.pattern, linearised(stretched, state, tow).stiffness)
            except RuntimeError:  # singular
                break
            force += bars.excess
        step = factor.solve(force)
        size = step_size(model, step)
        if size > OPTIONS.max_step:
            break
        if size > OPTIONS.keep_max_step:
            factor = None
        last = residual
        state = state.moved(step / max(size, 1.0))
        bars = _extrapolated(model, state, tow, rest, bars.extrapolated)
    return state, iteration, residual


def _spans(model: GearModel, state: State, tow: Tow) -> FloatArray:
    positions = points_of(model, state, tow).positions
    return length(positions[model.ends[:, 1]] - positions[model.ends[:, 0]])


def _extrapolated(
    model: GearModel, state: State, tow: Tow, rest: FloatArray, before: FloatArray
) -> _Bars:
    """Return the bars after a step, from the strains of the linearisation before it."""
    properties = model.bars
    strains, extrapolated = np.empty((2, len(before)))
    excess = np.zeros(model.dof)
    _extrapolate(
        model.ends,
        points_of(model, state, tow).positions,
        rest,
        properties.stiffness,
        properties.bow,
        before,
        model.nodes,
        strains,
        extrapolated,
        excess,
    )
    return _Bars(strains, extrapolated, excess)


@compiled
def _extrapolate(
    ends: IntArray,
    x: FloatArray,
    rest: FloatArray,
    stiffness: FloatArray,
    bow: FloatArray,
    before: FloatArray,
    nodes: int,
    strains: FloatArray,
    extrapolated: FloatArray,
    excess: FloatArray,
) -> None:
    vector = np.empty(3)
    for n in range(len(ends)):
        start, end = ends[n, 0], ends[n, 1]
        for i in range(3):
            vector[i] = x[end, i] - x[start, i]
        span = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
        strain = span / rest[n] - 1.0
        strains[n] = extrapolated[n] = strain
        elastic, slope, _ = taut_at(before[n], bow[n])
        # A bar without slope was slack: only its new length decides whether it still is.
        if slope == 0.0:
            continue
        reached = elastic + slope * (strain - before[n])
        if bow[n] > 0.0:
            if reached > 0.0:
                # Inverse of the law of bowed twine: strain at this tension.
                extrapolated[n] = reached - bow[n] / reached**2
        elif reached <= 0.0:
            extrapolated[n] = min(strain, SLACK_STRAIN)
        elif reached < SLACK_WIDTH:
            # Inverse of the rounded corner between slack and taut.
            extrapolated[n] = 2.0 * np.sqrt(SLACK_WIDTH * reached) - SLACK_WIDTH
        else:
            extrapolated[n] = reached
        if start < nodes and end < nodes:
            elastic, slope, _ = taut_at(extrapolated[n], bow[n])
            linear = elastic + slope * (strain - extrapolated[n])
            pull = stiffness[n] * (linear - taut_at(strain, bow[n])[0]) / span
            for i in range(3):
                excess[3 * start + i] += pull * vector[i]
                excess[3 * end + i] -= pull * vector[i]
