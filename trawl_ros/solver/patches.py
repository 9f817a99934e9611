"""Nonlinear elimination of patches: Newton's method on a few nodes, all others held.

Where bars of netting flip between slack and taut, the iterations of an implicit step end with
corrections of a few nodes, and each flip asks for another matrix of the whole gear. These nodes are
brought into balance by themselves, with a small matrix of their own, before the next iteration
(nonlinear elimination: Lanzkron, Rose and Wilkes 1997; Cai and Li 2011). Forces and masses are
those of the whole gear, whose iterations alone decide when the search ends.
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
from trawl_ros.solver.frontal.one_front import dense_solution

LEAST_NODES = 2000
"""Gears of fewer nodes have no patches: theirs would take as long as the matrices they save."""

MOST, PART = 100, 1 / 40
"""Nodes of a patch at most, by number and as a part of all: its matrix is dense."""

SHARES = 0.03, 0.2
"""A patch takes the nodes whose correction is larger than this share of the largest; the second
share where the first would take too many."""

ITERATIONS = 20
"""Iterations after which a patch is left as it was; as a rule it needs three to eight."""

LIMIT = 0.2
"""Largest correction of an iteration, m."""

BOLD = 7
"""Iterations without a line search, which would creep where the netting buckles."""

OVERSHOT, LEAST_SHARE = 0.8, 0.1
"""From this share of the slope before it, the slope after an iteration asks for a shorter one, of
this share of it at least."""

NO_PATCH = np.empty(0, int)


@dataclass(frozen=True)
class ImplicitStep:
    """Implicit step: inertia as data on the pattern, change of the new place (s²) and velocity (s)
    by the new acceleration, and the correction (m) at which it is done.
    """

    inertia: FloatArray
    by_position: float
    by_velocity: float
    enough: float


def grown_patch(
    model: GearModel, patch: IntArray, correction: FloatArray, enough: float
) -> IntArray:
    """Patch (k,) with the nodes to which a correction (dof,) is confined; none where they are too
    many. Nodes of the kite, and those with forces of their own, are in no patch.
    """
    n = model.nodes
    if n < LEAST_NODES:
        return NO_PATCH
    moved = np.abs(correction[: 3 * n]).reshape(n, 3).max(axis=1)
    largest = float(moved.max())
    moved[model.layout.kite.nodes] = 0.0
    for more in model.node_forces:
        moved[more.nodes] = 0.0
    most = min(MOST, PART * n)
    for share in SHARES:
        grown = np.union1d(patch, np.flatnonzero(moved > max(share * largest, enough)))
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
) -> FloatArray:
    """Acceleration (dof,) with that of a patch in balance, all others held.

    Parameters
    ----------
    model, tow, step
        Gear, its boundary at the end of the step, and the step.
    state, acceleration
        State at the end of the step with an acceleration (dof,) there.
    patch
        Nodes (k,).

    Returns
    -------
    (dof,) array
        The acceleration as given, where the patch comes to no balance.
    """
    nodes = _PatchForces.of(model, state, tow, step, patch)
    new = acceleration[: 3 * model.nodes].reshape(-1, 3)[patch]
    move, slope = np.zeros_like(new), np.inf
    for iteration in range(ITERATIONS):
        left, matrix = nodes.linearised(new)
        there = float((move * left).sum())
        if iteration >= BOLD and abs(there) > OVERSHOT * abs(slope):
            share = min(max(slope / (slope - there), LEAST_SHARE), 0.5)
            new = nodes.moved(new, (share - 1.0) * move)
            move = share * move
            continue
        solution = dense_solution(matrix, left.ravel())
        if solution is None or not np.isfinite(size := float(np.abs(solution).max())):
            break
        move = solution.reshape(-1, 3) * min(1.0, LIMIT / max(size, LIMIT))
        slope = float((move * left).sum())
        new = nodes.moved(new, move)
        if size < 0.1 * step.enough:
            found: FloatArray = acceleration.copy()
            found[: 3 * model.nodes].reshape(-1, 3)[patch] = new
            return found
    return acceleration


@dataclass(frozen=True)
class _PatchForces:
    """Forces on a patch: places and velocities (p, 3) of all points, of which it moves its own,
    its ``bars`` (b,), the ``places`` (b, 2) of their ends in the patch, -1 where they are not in
    it, and the ``masses`` (k, 3, 3) of its nodes.
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
        """Move the patch by (k, 3) m, and return its acceleration (k, 3) after that."""
        step = self.step
        self.x[self.patch] += move
        self.v[self.patch] += move * (step.by_velocity / step.by_position)
        moved: FloatArray = new + move / step.by_position
        return moved

    def linearised(self, new: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Forces (k, 3) that are left over at an acceleration (k, 3), and the matrix (3 k, 3 k)
        of their derivatives by the places at the end of the step.
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
        # Their slopes are small beside those of bars, and left out here.
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
