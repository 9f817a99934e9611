# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""State of the gear, positions and velocities, and the towing boundary imposed on it."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.rotations import rotation, rotation_vector


@dataclass(frozen=True)
class Tow:
    """Towing boundary: motion of the blocks and warp lengths at one instant.

    ``blocks`` (2, 3) positions and ``block_velocities`` (2, 3) of the towing blocks, port and
    starboard, in ``map`` axes (m, m/s); ``lengths`` (2,) unstretched warp lengths (m) and
    ``length_rates`` (2,) their rates (m/s, out positive).
    """

    blocks: FloatArray
    block_velocities: FloatArray
    lengths: FloatArray
    length_rates: FloatArray


@dataclass(frozen=True)
class TowSlopes:
    """Derivatives of a towing boundary by m parameters, per unit of each.

    ``blocks`` and ``block_velocities`` are (m, 2, 3), ``lengths`` and ``length_rates`` (m, 2).
    """

    blocks: FloatArray
    block_velocities: FloatArray
    lengths: FloatArray
    length_rates: FloatArray


def held_boundary(number: int) -> TowSlopes:
    """Return the zero derivatives of a boundary that depends on none of ``number`` parameters."""
    return TowSlopes(*np.zeros((2, number, 2, 3)), *np.zeros((2, number, 2)))


@dataclass(frozen=True)
class State:
    """Positions and velocities in ``map`` axes.

    ``nodes`` (n, 3), ``board_positions`` (2, 3) of the centres of gravity, ``board_rotations``
    (2, 3, 3) from the right-handed door frame (x forward, y port, z up), and the velocities
    ``node_velocities``, ``board_velocities``, ``board_rates`` (rad/s).
    """

    nodes: FloatArray
    board_positions: FloatArray
    board_rotations: FloatArray
    node_velocities: FloatArray
    board_velocities: FloatArray
    board_rates: FloatArray

    def moved(self, step: FloatArray) -> 'State':
        """Return the state displaced by ``step`` (dof,): metres, and rotation vectors of boards."""
        n = len(self.nodes)
        board = step[3 * n :].reshape(2, 6)
        return State(
            nodes=self.nodes + step[: 3 * n].reshape(n, 3),
            board_positions=self.board_positions + board[:, :3],
            board_rotations=rotation(board[:, 3:]) @ self.board_rotations,
            node_velocities=self.node_velocities,
            board_velocities=self.board_velocities,
            board_rates=self.board_rates,
        )

    def with_velocity(self, velocity: FloatArray) -> 'State':
        """Return the state with the generalised velocity ``velocity`` (dof,)."""
        n = len(self.nodes)
        board = velocity[3 * n :].reshape(2, 6)
        return State(
            nodes=self.nodes,
            board_positions=self.board_positions,
            board_rotations=self.board_rotations,
            node_velocities=velocity[: 3 * n].reshape(n, 3),
            board_velocities=board[:, :3],
            board_rates=board[:, 3:],
        )

    @property
    def velocity(self) -> FloatArray:
        """Generalised velocity (dof,)."""
        board = np.concatenate([self.board_velocities, self.board_rates], axis=1)
        return np.concatenate([self.node_velocities.ravel(), board.ravel()])

    def shifted(self, offset: FloatArray) -> 'State':
        """Return the state of the whole gear displaced by ``offset`` (3,), m."""
        return State(
            nodes=self.nodes + offset,
            board_positions=self.board_positions + offset,
            board_rotations=self.board_rotations,
            node_velocities=self.node_velocities,
            board_velocities=self.board_velocities,
            board_rates=self.board_rates,
        )


def halfway(first: State, last: State, h: float) -> State:
    """Return the state ``h`` / 2 seconds after ``first`` on the cubic Hermite through both ends.

    Its error falls with the fourth power of ``h``, faster than that of the time stepper.
    """

    def place(move: FloatArray, v0: FloatArray, v1: FloatArray) -> FloatArray:
        return 0.5 * move + h / 8 * (v0 - v1)

    def speed(move: FloatArray, v0: FloatArray, v1: FloatArray) -> FloatArray:
        return 1.5 / h * move - 0.25 * (v0 + v1)

    nodes = last.nodes - first.nodes, first.node_velocities, last.node_velocities
    boards = (
        last.board_positions - first.board_positions,
        first.board_velocities,
        last.board_velocities,
    )
    turn = last.board_rotations @ np.swapaxes(first.board_rotations, 1, 2)
    turns = rotation_vector(turn), first.board_rates, last.board_rates
    return State(
        nodes=first.nodes + place(*nodes),
        board_positions=first.board_positions + place(*boards),
        board_rotations=rotation(place(*turns)) @ first.board_rotations,
        node_velocities=speed(*nodes),
        board_velocities=speed(*boards),
        board_rates=speed(*turns),
    )


def mirrored(state: State, permutation: IntArray) -> State:
    """Return the mirror image in the x-z plane.

    ``permutation`` (n,) has the number of the mirrored node of each node.
    """
    flip = np.array([1.0, -1.0, 1.0])
    swap = [1, 0]
    return State(
        nodes=(state.nodes * flip)[permutation],
        board_positions=(state.board_positions * flip)[swap],
        board_rotations=(flip[:, None] * state.board_rotations * flip)[swap],
        node_velocities=(state.node_velocities * flip)[permutation],
        board_velocities=(state.board_velocities * flip)[swap],
        board_rates=(-state.board_rates * flip)[swap],
    )
