"""Derivatives of warp forces and of M a along directions of positions and towing boundary.

Forces by positions and velocities are `trawl_ros.model.assembly.linearised`; here is the rest that
the derivative of a time step needs. Ropes at blocks and boards are few, so they are taken by the
complex step, for all directions in one pass; the net's bars analytically, on the model's pattern.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray, Slice
from trawl_ros.model.assembly import Points, points_of, rest_lengths
from trawl_ros.model.bar_pass import water_of
from trawl_ros.model.board import world_inertia
from trawl_ros.model.gear_model import OUTWARD, BarGroup, GearModel
from trawl_ros.model.numerics import STEP, cross, stepped, transpose
from trawl_ros.model.rotations import rotation
from trawl_ros.model.slopes.inertia_pass import (
    add_bar_inertia_slopes,
    add_forces_of_many,
    add_inertia_of_many,
)
from trawl_ros.model.state import State, Tow, TowSlopes


@dataclass(frozen=True)
class RiggingDirections:
    """Directions of the gear along which to differentiate, as far as ropes at blocks and boards go.

    ``nodes`` (k, m) are those of `BarGroup.rows`, ``boards`` (12, m) metres and rotation vectors in
    fixed axes, ``boundary`` those of the blocks and warps.
    """

    nodes: FloatArray
    boards: FloatArray
    boundary: TowSlopes


@dataclass(frozen=True)
class _Stepped:
    """Points of a group of bars (m, points, 3) and arms (m, 2, 3, 3) of the fastening points, all
    stepped along directions.
    """

    group: BarGroup
    positions: FloatArray
    arms: FloatArray


def _stepped_points(
    model: GearModel, at: Points, group: BarGroup, moved: RiggingDirections
) -> _Stepped:
    n, number, points = model.nodes, moved.boards.shape[1], group.points
    body = moved.boards.T.reshape(number, 2, 1, 6)
    turned = cross(body[..., 3:], at.arms)
    every = np.empty((number, len(points), 3))
    every[:, points < n] = moved.nodes.T.reshape(number, -1, 3)
    rigged, hung = (points >= n) & (points < n + 6), points >= n + 6
    every[:, rigged] = (body[..., :3] + turned).reshape(number, 6, 3)[:, points[rigged] - n]
    every[:, hung] = moved.boundary.blocks[:, points[hung] - n - 6]
    return _Stepped(group, stepped(at.positions[points], every), stepped(at.arms, turned))


def _add_gathered(
    model: GearModel,
    there: _Stepped,
    total: FloatArray,
    columns: Slice | IntArray,
    into: FloatArray,
) -> None:
    """Add the slopes of the generalised forces of stepped loads (m, points, 3) to columns of
    ``into`` (dof, ...).
    """
    n, points = model.nodes, there.group.points
    rigged = (points >= n) & (points < n + 6)
    fastened = np.zeros((len(total), 6, 3), complex)
    fastened[:, points[rigged] - n] = total[:, rigged]
    ropes = fastened.reshape(-1, 2, 3, 3)
    load = np.concatenate([ropes.sum(axis=2), cross(there.arms, ropes).sum(axis=2)], axis=2)
    rows = np.concatenate([there.group.rows(n), np.arange(3 * n, model.dof)])
    free = total[:, points < n].reshape(len(total), -1)
    slopes = np.concatenate([free, load.reshape(len(total), -1)], axis=1).T.imag / STEP
    if isinstance(columns, slice):
        into[rows, columns] += slopes
    else:
        into[rows[:, None], columns] += slopes


def _rest(
    model: GearModel, tow: Tow, slopes: TowSlopes, bars: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Unstretched lengths of some bars and their rates, both (m, k), stepped with the boundary."""
    sides, segments = model.warp_side[bars], model.warp_segments
    rest, rate = (values[bars] for values in rest_lengths(model, tow))
    warp = sides >= 0
    longer = np.where(warp, slopes.lengths[:, sides], 0.0) / segments
    faster = np.where(warp, slopes.length_rates[:, sides], 0.0) / segments
    return stepped(rest, longer), stepped(rate, faster)


def add_forces_along_tow(
    model: GearModel, state: State, tow: Tow, slopes: TowSlopes, into: FloatArray
) -> None:
    """Add the derivatives of the forces by the towing boundary alone to those ``into`` (dof, m)."""
    moving = np.flatnonzero(slopes.moving)
    if not len(moving):
        return
    own, group = slopes.chosen(moving), model.warps
    number, points = len(moving), group.points
    at = points_of(model, state, tow)
    still = np.zeros((len(group.rows(model.nodes)), number)), np.zeros((12, number))
    there = _stepped_points(model, at, group, RiggingDirections(*still, own))
    speeds = np.zeros((number, len(points), 3))
    hung = points >= model.nodes + 6
    speeds[:, hung] = own.block_velocities[:, points[hung] - model.nodes - 6]
    total = np.zeros((number, len(points), 3), complex)
    add_forces_of_many(
        group.ends,
        there.positions,
        stepped(at.velocities[points], speeds),
        *_rest(model, tow, own, group.bars),
        group.properties.columns,
        water_of(model.water),
        total,
    )
    _add_gathered(model, there, total, moving, into)


def net_inertia_slopes(
    model: GearModel, state: State, tow: Tow, acceleration: FloatArray
) -> FloatArray:
    """Derivatives of M a by positions as data on the pattern, accelerations (dof,) held: of nodes
    and of the bars between them, but for warps and ropes at boards (`subtract_rigging_inertia`).
    """
    pattern, n = model.pattern, model.nodes
    data, a = np.zeros(len(pattern.indices)), acceleration[: 3 * n].reshape(n, 3)
    add_bar_inertia_slopes(
        model.ends,
        pattern.plain,
        model.warp_side < 0,
        state.nodes,
        a,
        rest_lengths(model, tow)[0],
        model.bars.columns,
        water_of(model.water),
        pattern.slot,
        data,
    )
    lumps, rigged = np.zeros((n, 3, 3)), len(pattern.rigged)
    lumps[:, :, 2] = -model.water.density_gradient * model.lump_added[:, None] * a
    still = np.zeros((len(pattern.hung), 3, 3)), np.zeros((rigged, 9, 9)), np.zeros((2, 6, 6))
    pattern.add([*still, lumps], data)
    return data


def subtract_rigging_inertia(
    model: GearModel,
    state: State,
    tow: Tow,
    acceleration: FloatArray,
    moved: RiggingDirections,
    into: FloatArray,
) -> None:
    """Subtract the derivatives of M a of warps, ropes at boards and boards from ``into`` (dof, m).

    Parameters
    ----------
    model, state, tow
        Gear, and the place at which its mass is taken.
    acceleration
        Generalised acceleration (dof,), held.
    moved
        Directions.
    into
        Sum that they are subtracted from.
    """
    n, number, group = model.nodes, moved.boards.shape[1], model.rigging
    points = group.points
    there = _stepped_points(model, points_of(model, state, tow), group, moved)
    body = acceleration[3 * n :].reshape(2, 1, 6)
    every = np.zeros((number, len(points), 3), complex)
    free, boards = points < n, (points >= n) & (points < n + 6)
    every[:, free] = -acceleration[: 3 * n].reshape(n, 3)[points[free]]
    fastened = (body[..., :3] + cross(body[..., 3:], there.arms)).reshape(number, 6, 3)
    every[:, boards] = -fastened[:, points[boards] - n]
    total = np.zeros((number, len(points), 3), complex)
    add_inertia_of_many(
        group.ends,
        there.positions,
        every,
        _rest(model, tow, moved.boundary, group.bars)[0],
        group.properties.columns,
        water_of(model.water),
        total,
    )
    _add_gathered(model, there, total, slice(None), into)
    turns = moved.boards.T.reshape(number, 2, 6)[..., 3:]
    turned = rotation(stepped(np.zeros(3), turns)) @ state.board_rotations
    push = board_inertia(model, turned, acceleration).reshape(number, 12)
    into[3 * n :] -= push.T.imag / STEP


def board_inertia(model: GearModel, rotations: FloatArray, acceleration: FloatArray) -> FloatArray:
    """Boards' own mass, inertia and added mass, turned by rotations (..., 2, 3, 3), times their
    part of a generalised acceleration (dof,): forces and moments (..., 2, 6).
    """
    board, body = model.board, acceleration[3 * model.nodes :].reshape(2, 6)
    added = rotations @ (board.added_mass[:, None] * transpose(rotations))
    push = np.empty((*rotations.shape[:-2], 6), rotations.dtype)
    push[..., :3] = board.mass * body[:, :3] + (added @ body[:, :3, None])[..., 0]
    push[..., 3:] = (world_inertia(board, OUTWARD, rotations) @ body[:, 3:, None])[..., 0]
    return push
