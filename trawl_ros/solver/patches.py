# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Nonlinear elimination of patches: Newton's method on a few nodes while all others are held.

Where bars of netting flip between slack and taut, only a few nodes still move at the end of an
implicit step, yet each flip needs a new matrix of the whole gear. These nodes are balanced first
with a small matrix of their own (nonlinear elimination: Lanzkron, Rose and Wilkes 1997; Cai and Li
2011). Forces and masses are those of the whole gear, and only its residual ends the iteration.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.assembly import points_of, rest_lengths, sheets_of
from trawl_ros.model.bar_pass import add_bar_blocks, water_of
from trawl_ros.model.compiled import compiled
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.lump_pass import (
    add_sheet_forces,
    fill_lump_forces,
    fill_lump_slopes,
)
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.fronts import dense_solution

NO_PATCH = np.empty(0, int)


@dataclass(frozen=True)
class PatchOptions:
    """Options of the elimination of patches.

    Attributes
    ----------
    min_gear_nodes
        Smaller gears have no patches: a patch would cost as much as the matrix that it saves.
    max_nodes, max_fraction
        Largest patch, in nodes and as a fraction of all nodes: its matrix is dense.
    correction_ratios
        A node joins the patch if its correction exceeds this ratio to the largest one. The next
        ratio is tried where the patch would be too large.
    iterations
        Iterations after which a patch is left as it was; most need three to eight.
    max_correction_m
        Largest correction of an iteration, m.
    full_newton_steps
        First iterations without a line search, which would stall where the netting buckles.
    max_slope_ratio
        The line search shortens a step if the slope after it exceeds this ratio to that before.
    min_step_fraction
        Smallest fraction to which it shortens a step.
    """

    min_gear_nodes: int = 2000
    max_nodes: int = 100
    max_fraction: float = 1 / 40
    correction_ratios: tuple[float, ...] = (0.03, 0.2)
    iterations: int = 20
    max_correction_m: float = 0.2
    full_newton_steps: int = 7
    max_slope_ratio: float = 0.8
    min_step_fraction: float = 0.1


PATCH_OPTIONS = PatchOptions()


@dataclass(frozen=True)
class ImplicitStep:
    """Implicit time step.

    Attributes
    ----------
    inertia
        Mass matrix as data on the pattern.
    by_position, by_velocity
        Change of the new position (s²) and velocity (s) per new acceleration.
    enough
        Correction (m) at which the step is converged.
    """

    inertia: FloatArray
    by_position: float
    by_velocity: float
    enough: float


def grown_patch(
    model: GearModel,
    patch: IntArray,
    correction: FloatArray,
    enough: float,
    options: PatchOptions = PATCH_OPTIONS,
) -> IntArray:
    """Add to a patch (k,) the nodes to which a correction (dof,) is confined.

    The patch is empty where they are too many. Nodes of the kite, and those with forces of their
    own, are in no patch.
    """
    n = model.nodes
    if n < options.min_gear_nodes:
        return NO_PATCH
    moved = np.abs(correction[: 3 * n]).reshape(n, 3).max(axis=1)
    largest = float(moved.max())
    moved[model.layout.kite.nodes] = 0.0
    for more in model.node_forces:
        moved[more.nodes] = 0.0
    most = min(options.max_nodes, options.max_fraction * n)
    for ratio in options.correction_ratios:
        grown = np.union1d(patch, np.flatnonzero(moved > max(ratio * largest, enough)))
        if len(grown) <= most:
            return grown
    return NO_PATCH


def balanced(
    model: GearModel,
    state: State,
    tow: Tow,
    step: ImplicitStep,
    acceleration: FloatArray,
    patch: IntArray,
    options: PatchOptions = PATCH_OPTIONS,
) -> FloatArray:
    """Balance the forces on a patch while all other nodes are held.

    Parameters
    ----------
    model, tow, step
        Gear, its boundary at the end of the step, and the step.
    state, acceleration
        State at the end of the step with an acceleration (dof,) there.
    patch
        Nodes (k,).
    options
        Limits of the iteration.

    Returns
    -------
    (dof,) array
        Acceleration with the patch in balance, or as given where none is found.
    """
    nodes = _PatchForces.of(model, state, tow, step, patch)
    new = acceleration[: 3 * model.nodes].reshape(-1, 3)[patch]
    move, slope = np.zeros_like(new), np.inf
    for iteration in range(options.iterations):
        left, matrix = nodes.linearised(new)
        there = float((move * left).sum())
        # The slope of the energy along the step: secant line search where it overshot.
        overshot = abs(there) > options.max_slope_ratio * abs(slope)
        if iteration >= options.full_newton_steps and overshot:
            share = min(max(slope / (slope - there), options.min_step_fraction), 0.5)
            new = nodes.moved(new, (share - 1.0) * move)
            move = share * move
            continue
        solution = dense_solution(matrix, left.ravel())
        if solution is None or not np.isfinite(size := float(np.abs(solution).max())):
            break
        limit = options.max_correction_m
        move = solution.reshape(-1, 3) * min(1.0, limit / max(size, limit))
        slope = float((move * left).sum())
        new = nodes.moved(new, move)
        if size < 0.1 * step.enough:
            found: FloatArray = acceleration.copy()
            found[: 3 * model.nodes].reshape(-1, 3)[patch] = new
            return found
    return acceleration


@dataclass(frozen=True)
class _PatchForces:
    """Forces on a patch.

    ``x`` and ``v`` (p, 3) are positions and velocities of all points, of which only its own move.
    ``bars`` (b,) touch the patch, ``places`` (b, 2) are their ends in it, -1 for ends outside, and
    ``masses`` (k, 3, 3) are those of its nodes.
    """

    model: GearModel
    step: ImplicitStep
    patch: IntArray
    x: FloatArray
    v: FloatArray
    rest: tuple[FloatArray, FloatArray]
    bars: IntArray
    places: IntArray
    masses: FloatArray

    @classmethod
    def of(
        cls, model: GearModel, state: State, tow: Tow, step: ImplicitStep, patch: IntArray
    ) -> '_PatchForces':
        points = points_of(model, state, tow)
        place = np.full(len(points.positions), -1)
        place[patch] = np.arange(len(patch))
        places = place[model.ends]
        bars = np.flatnonzero((places >= 0).any(axis=1))
        masses = step.inertia[model.pattern.node_slots[patch]]
        moving = points.positions, points.velocities
        return cls(
            model, step, patch, *moving, rest_lengths(model, tow), bars, places[bars], masses
        )

    def moved(self, new: FloatArray, move: FloatArray) -> FloatArray:
        """Move the patch by (k, 3) m and return its new acceleration (k, 3)."""
        step = self.step
        self.x[self.patch] += move
        self.v[self.patch] += move * (step.by_velocity / step.by_position)
        moved: FloatArray = new + move / step.by_position
        return moved

    def linearised(self, new: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residual (k, 3) at an acceleration (k, 3) and its Jacobian (3 k, 3 k).

        Derivatives are by the positions at the end of the step, with the sign of K.
        """
        model, patch, step = self.model, self.patch, self.step
        total, nothing = np.zeros_like(self.x), np.empty(0)
        k, c = np.empty((2, len(self.bars), 6, 6))
        water = water_of(model.water)
        add_bar_blocks(
            model.ends,
            self.bars,
            self.x,
            self.v,
            *self.rest,
            model.bars.columns,
            water,
            model.pattern.slot,
            total,
            nothing,
            nothing,
            k,
            c,
            np.empty((len(self.bars), 3)),
        )
        # Derivatives of sheets are small compared with those of bars; Newton does without them.
        add_sheet_forces(self.x, self.v, *sheets_of(model), water, total)
        here = self.x[patch], self.v[patch]
        force, (own, slowed) = np.empty_like(new), np.empty((2, len(patch), 3, 3))
        shape = (
            model.lump_volume[patch],
            model.lump_drag_area[patch],
            model.lump_viscous_area[patch],
        )
        fill_lump_forces(*here, model.lump_mass[patch], *shape, water, force)
        fill_lump_slopes(*here, *shape, water, own, slowed)
        faster = step.by_velocity / step.by_position
        own += faster * slowed + self.masses / step.by_position
        matrix = np.zeros((3 * len(patch), 3 * len(patch)))
        _fill_matrix(self.places, k, c, faster, own, matrix)
        left = total[patch] + force - np.einsum('nij,nj->ni', self.masses, new)
        return left, matrix


@compiled
def _fill_matrix(
    places: IntArray,
    k: FloatArray,
    c: FloatArray,
    faster: float,
    own: FloatArray,
    matrix: FloatArray,
) -> None:
    for node in range(len(own)):
        for i in range(3):
            for j in range(3):
                matrix[3 * node + i, 3 * node + j] = own[node, i, j]
    for bar in range(len(places)):
        for end in range(2):
            for other in range(2):
                row, column = 3 * places[bar, end], 3 * places[bar, other]
                if row < 0 or column < 0:
                    continue
                for i in range(3):
                    for j in range(3):
                        at = 3 * end + i, 3 * other + j
                        matrix[row + i, column + j] += k[bar][at] + faster * c[bar][at]
