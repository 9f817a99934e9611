# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Derivatives of warp forces and of M a along directions of positions and towing boundary.

`trawl_ros.model.assembly.linearised` has the derivatives of forces by positions and velocities;
this module has the others that the derivative of a time step needs. Ropes at blocks and boards are
few, so they are differentiated by the complex step, for all directions in one pass. The net's bars
are differentiated analytically, on the model's pattern.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import points_of, rest_lengths
from trawl_ros.model.bar_pass import water_of
from trawl_ros.model.board import world_inertia
from trawl_ros.model.compiled import as_kind
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.numerics import transpose
from trawl_ros.model.slopes.passes import (
    add_bar_inertia_slopes,
    add_warp_forces,
    subtract_inertia,
)
from trawl_ros.model.state import State, Tow, TowSlopes


@dataclass(frozen=True)
class RiggingDirections:
    """Directions along which to differentiate the ropes at blocks and boards.

    ``nodes`` (k, m) are the rows of `BarGroup.rows`, ``boards`` (12, m) metres and rotation vectors
    in fixed axes, ``boundary`` the derivatives of blocks and warps.
    """

    nodes: FloatArray
    boards: FloatArray
    boundary: TowSlopes


def add_forces_along_tow(
    model: GearModel, state: State, tow: Tow, slopes: TowSlopes, into: FloatArray
) -> None:
    """Add the derivatives of the forces by the towing boundary alone to those ``into`` (dof, m)."""
    group, at = model.warps, points_of(model, state, tow)
    rest, rate = (values[group.bars] for values in rest_lengths(model, tow))
    add_warp_forces(
        group.points,
        group.ends,
        model.warp_side[group.bars],
        float(model.warp_segments),
        at.positions[group.points],
        at.velocities[group.points],
        at.arms,
        rest,
        rate,
        group.properties.columns,
        water_of(model.water),
        tuple(as_kind(float, *vars(slopes).values())),
        into,
    )


def net_inertia_slopes(
    model: GearModel, state: State, tow: Tow, acceleration: FloatArray
) -> FloatArray:
    """Return the derivatives of M a by positions as data on the pattern, at constant a (dof,).

    They are those of nodes and of the bars between them. Warps and ropes at boards are left to
    `subtract_rigging_inertia`.
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
        Gear, its state and boundary.
    acceleration
        Generalised acceleration (dof,), constant.
    moved
        Directions.
    into
        Derivatives (dof, m) from which they are subtracted.
    """
    group, at = model.rigging, points_of(model, state, tow)
    subtract_inertia(
        group.points,
        group.ends,
        model.warp_side[group.bars],
        float(model.warp_segments),
        at.positions[group.points],
        at.arms,
        rest_lengths(model, tow)[0][group.bars],
        group.properties.columns,
        water_of(model.water),
        _turned_inertia(model, state.board_rotations),
        acceleration,
        *as_kind(float, moved.nodes, moved.boards, moved.boundary.blocks, moved.boundary.lengths),
        into,
    )


def _turned_inertia(model: GearModel, rotations: FloatArray) -> FloatArray:
    """Return added mass and inertia (2, 2, 3, 3) of the boards in fixed axes."""
    added = rotations @ (model.board.added_mass[:, None] * transpose(rotations))
    return np.stack([added, world_inertia(model.board, OUTWARD, rotations)], axis=1)


def board_inertia(model: GearModel, rotations: FloatArray, acceleration: FloatArray) -> FloatArray:
    """Return forces and moments (2, 6): the boards' inertia times a generalised acceleration.

    Inertia is their own mass, inertia and added mass, rotated by ``rotations`` (2, 3, 3).
    """
    body = acceleration[3 * model.nodes :].reshape(2, 2, 3)
    push: FloatArray = (_turned_inertia(model, rotations) @ body[..., None])[..., 0]
    push[:, 0] += model.board.mass * body[:, 0]
    return push.reshape(2, 6)
