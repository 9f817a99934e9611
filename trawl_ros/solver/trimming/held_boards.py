# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Boards held at an attitude: the pulls of ropes on them, and their stiffness.

Both boards are held at mirrored attitudes, and the rest of the gear is in equilibrium. Static
condensation turns the gear behind the ropes into stiffness matrices between moves of fastening
points and pulls on them. There are two: for boards that move as mirror images, and for boards that
move against each other. The moment left on a board is then a function of its points alone.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import board_loads, linearised, points_of, rest_lengths
from trawl_ros.model.bar_pass import add_bar_forces, water_of
from trawl_ros.model.compiled import promote_dtypes
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP, outer, skew, stepped
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import factorised_part

ACROSS = np.array([1.0, -1.0, 1.0])
"""Signs of a starboard point's move if its mirror image moves by a vector."""

WAYS = 1.0, -1.0
"""Signs of the starboard board's moves: as the mirror image of port's, or against it."""


@dataclass(frozen=True)
class HeldBoard:
    """Held port board; the starboard one is its mirror image.

    Attributes
    ----------
    arms : (3, 3) array
        Arms from its centre of gravity to the fastening points of this state, fixed axes, m.
    pulls : (3, 3) array
        Pulls of the ropes at these points, N.
    give : (2, 3, 3, 3, 3) array
        Change of pull ``i`` by a move of point ``j``, both in axes, N/m, by `WAYS`, while the net
        stays in equilibrium.
    load : (6,) array
        Force (N) and moment (N m) of water and weight.
    by_turn : (6, 3) array
        Change of the load by a rotation of the board, per rad.
    """

    arms: FloatArray
    pulls: FloatArray
    give: FloatArray
    load: FloatArray
    by_turn: FloatArray

    def balance(self, arms: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the moment (3,) left with other fastening points and its stiffness (2, 3, 3).

        The stiffness is against rotations of both boards by `WAYS`: a rotation θ changes the
        moment by ``-stiffness @ θ``. The board's position keeps its forces balanced.
        """
        moves = arms - self.arms
        inward = self.give[0].sum(axis=0)
        # The board moves to where its forces balance again.
        shift = -np.linalg.solve(inward.sum(axis=1), np.einsum('ajb,jb->a', inward, moves))
        pulls = self.pulls + np.einsum('iajb,jb->ia', self.give[0], moves + shift)
        moment = np.cross(arms, pulls).sum(axis=0) + self.load[3:]
        return moment, np.stack([self._stiffness(give, arms, pulls) for give in self.give])

    def _stiffness(self, give: FloatArray, arms: FloatArray, pulls: FloatArray) -> FloatArray:
        # A rotation θ moves an arm r by θ × r; the position follows, then moments are taken.
        inward, lever = give.sum(axis=0), -skew(arms)
        turned = np.einsum('ajb,jbc->ac', inward, lever) + self.by_turn[:3]
        shifts = -np.linalg.solve(inward.sum(axis=1), turned)
        more = np.einsum('iajb,jbc->iac', give, lever + shifts)
        stiffness: FloatArray = -self.by_turn[3:] - np.einsum('iab,ibc->ac', skew(arms), more)
        stiffness += np.einsum('ia,ia->', arms, pulls) * np.eye(3) - outer(arms, pulls).sum(axis=0)
        return stiffness


@dataclass(frozen=True)
class _Rigging:
    """First bars of the ropes at the boards: forces on their ends by moves of the ends."""

    model: GearModel
    state: State
    tow: Tow

    def forces(self, points: FloatArray, nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return forces (2, 3, 3) on points and (n, 3) on nodes after moves of these shapes."""
        model, state = self.model, self.state
        rigged, here = model.pattern.rigged, points_of(model, state, self.tow)
        n, ends = model.nodes, model.ends[rigged].ravel()
        moves = np.concatenate([nodes, points.reshape(6, 3), np.zeros((2, 3))])
        x, v, rest, rate = promote_dtypes(
            here.positions[ends] + moves[ends],
            here.velocities[ends],
            *(values[rigged] for values in rest_lengths(model, self.tow)),
        )
        bars, total = model.bars.chosen(rigged).columns, np.zeros_like(x)
        pairs = np.arange(len(ends)).reshape(-1, 2)
        add_bar_forces(pairs, x, v, rest, rate, bars, water_of(model.water), total)
        on_points, on_nodes = np.zeros((6, 3), x.dtype), np.zeros((n, 3), x.dtype)
        np.add.at(on_points, ends[0::2] - n, total[0::2])
        np.add.at(on_nodes, ends[1::2], total[1::2])
        return on_points.reshape(2, 3, 3), on_nodes


def rope_pulls(model: GearModel, state: State, tow: Tow) -> FloatArray:
    """Return pulls (2, 3, 3) of warps, upper and lower ropes at the boards' points, N."""
    still = np.zeros((2, 3, 3)), np.zeros((model.nodes, 3))
    pulls: FloatArray = _Rigging(model, state, tow).forces(*still)[0].real
    return pulls


def port_loads(model: GearModel, state: State) -> tuple[FloatArray, FloatArray]:
    """Return force (N) and moment (N m) (6,) of water and weight on the port board.

    With them goes their change (6, 3) by a rotation of the board, per rad.
    """
    by_turn = np.empty((6, 3))
    for axis in range(3):
        turn = np.zeros(model.dof)
        turn[3 * model.nodes + 3 + axis] = 1.0
        turned = state.moved(stepped(np.zeros(model.dof), turn))
        by_turn[:, axis] = board_loads(model, turned)[0].imag / STEP
    return board_loads(model, state)[0].real, by_turn


def held_board(model: GearModel, state: State, tow: Tow) -> HeldBoard:
    """Condense the gear to the port board, at a shape with held attitudes."""
    n, rigging = model.nodes, _Rigging(model, state, tow)
    still_points, still_nodes = np.zeros((2, 3, 3)), np.zeros((n, 3))
    moves = []
    for way in WAYS:
        for move in np.eye(9).reshape(9, 3, 3):
            moves.append(np.stack([move, way * ACROSS * move]))
    stiffness = model.pattern.matrix(linearised(model, state, tow).stiffness)
    pushes = [rigging.forces(stepped(still_points, move), still_nodes)[1] for move in moves]
    columns = np.column_stack([push.imag.ravel() / STEP for push in pushes])
    follows = factorised_part(stiffness[: 3 * n][:, : 3 * n].tocsc()).solve(columns)
    pulled = [
        rigging.forces(stepped(still_points, move), stepped(still_nodes, follow.reshape(n, 3)))[0]
        for move, follow in zip(moves, follows.T, strict=True)
    ]
    give = np.stack([pull[0].imag / STEP for pull in pulled]).reshape(2, 3, 3, 3, 3)
    load, by_turn = port_loads(model, state)
    return HeldBoard(
        arms=model.board.fastening_points @ state.board_rotations[0].T,
        pulls=rigging.forces(still_points, still_nodes)[0][0],
        # From (way, point j, axis b, point i, axis a).
        give=np.transpose(give, (0, 3, 4, 1, 2)),
        load=load,
        by_turn=by_turn,
    )
