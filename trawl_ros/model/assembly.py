# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Assembly of all forces on the gear, their exact Jacobian, and the mass matrix.

`forces` is the whole right-hand side of eq. 15, 25 and 29 as a function of state, towing
boundary and parameters; it accepts complex arguments. `linearised` returns the same
forces with K = -∂F/∂q and C = -∂F/∂v on the model's sparsity pattern: bars analytically
(`bar.pull_slopes_at`, `bar.load_slopes_at`), boards and kite by the complex step, which is exact
to rounding.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model import board as board_physics
from trawl_ros.model import kite as kite_physics
from trawl_ros.model import line
from trawl_ros.model.bar import between
from trawl_ros.model.bar_pass import add_bar_blocks, add_bar_forces, add_bar_masses, water_of
from trawl_ros.model.compiled import compiled, promote_dtypes
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.line import BarMotion
from trawl_ros.model.lump_pass import (
    add_sheet_forces,
    add_sheet_slopes,
    fill_lump_forces,
    fill_lump_slopes,
)
from trawl_ros.model.numerics import STEP, skew, stepped
from trawl_ros.model.point_pass import fill_board_masses, fill_masses, fill_points, gather_loads
from trawl_ros.model.rotations import rotation
from trawl_ros.model.state import State, Tow


def rest_lengths(model: GearModel, tow: Tow) -> tuple[FloatArray, FloatArray]:
    """Return the unstretched lengths of all bars and their rates; bars of a warp are equal."""
    lengths = tow.lengths / model.warp_segments
    rest = model.rest.astype(lengths.dtype)
    rate = np.zeros(len(rest), np.result_type(tow.length_rates, 0.0))
    for side, bars in enumerate(model.warp_bars):
        rest[bars] = lengths[side]
        rate[bars] = tow.length_rates[side] / model.warp_segments
    return rest, rate


@dataclass(frozen=True)
class Points:
    """Positions and velocities (p, 3) of nodes, fastening points and blocks.

    ``arms`` (2, 3, 3) lead from the boards' centres of gravity to their fastening points, in fixed
    axes.
    """

    positions: FloatArray
    velocities: FloatArray
    arms: FloatArray


def points_of(model: GearModel, state: State, tow: Tow) -> Points:
    """Return positions and velocities of all points at which bars can end."""
    fastening, outward, *moving = promote_dtypes(
        model.board.fastening_by_side,
        OUTWARD,
        state.nodes,
        state.node_velocities,
        state.board_positions,
        state.board_velocities,
        state.board_rotations,
        state.board_rates,
        tow.blocks,
        tow.block_velocities,
    )
    x, v = np.empty((2, model.nodes + 8, 3), fastening.dtype)
    arms = np.empty((2, 3, 3), fastening.dtype)
    fill_points(fastening, outward, *moving, x, v, arms)
    return Points(x, v, arms)


def motion_of(model: GearModel, points: Points, tow: Tow) -> BarMotion:
    """Return the motion of all bars."""
    ends = model.ends
    x, v = promote_dtypes(points.positions, points.velocities)
    vector, stretching, velocity = np.empty((3, len(ends), 3), x.dtype)
    height = np.empty(len(ends), x.dtype)
    _motion(ends, x, v, vector, stretching, velocity, height)
    return BarMotion(vector, stretching, velocity, height, *rest_lengths(model, tow))


@compiled
def _motion(
    ends: IntArray,
    x: FloatArray,
    v: FloatArray,
    vector: FloatArray,
    stretching: FloatArray,
    velocity: FloatArray,
    height: FloatArray,
) -> None:
    for n in range(len(ends)):
        height[n] = between(x, v, ends[n, 0], ends[n, 1], vector[n], stretching[n], velocity[n])


def sheets_of(model: GearModel) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Return the sheets of netting for compiled loops."""
    sheets = model.sheets
    return sheets.around, sheets.weights, sheets.lift, sheets.twine


def lump_forces(model: GearModel, state: State) -> FloatArray:
    """Return drag (eq. 22), weight and buoyancy (eq. 28) of the lumps at nodes, (n, 3) N."""
    x, v, *lumps = promote_dtypes(
        state.nodes,
        state.node_velocities,
        model.lump_mass,
        model.lump_volume,
        model.lump_drag_area,
        model.lump_viscous_area,
    )
    force = np.empty_like(x)
    fill_lump_forces(x, v, *lumps, water_of(model.water), force)
    for more in model.node_forces:
        at = more.nodes
        force[at] += more(state.nodes[at], state.node_velocities[at])
    return force


def board_loads(model: GearModel, state: State) -> FloatArray:
    """Return the force and moment (2, 6) on both boards that do not come from ropes."""
    return board_physics.own_load(
        model.board,
        model.coefficients,
        OUTWARD,
        state.board_positions,
        state.board_rotations,
        state.board_velocities,
        state.board_rates,
        model.water,
    )


def kite_load(model: GearModel, state: State) -> FloatArray:
    """Return the force (3,) on the kite."""
    held = model.layout.kite
    if not held.held:
        return np.zeros(3)
    front, rear = held.weights @ state.nodes[held.nodes]
    front_velocity, rear_velocity = held.weights @ state.node_velocities[held.nodes]
    return kite_physics.load(model.kite, front, rear, front_velocity, rear_velocity, model.water)


def forces(model: GearModel, state: State, tow: Tow) -> FloatArray:
    """Return generalised forces (dof,) on nodes (N) and boards (N, N m), in fixed axes."""
    points = points_of(model, state, tow)
    x, v, rest, rate = promote_dtypes(
        points.positions, points.velocities, *rest_lengths(model, tow)
    )
    total = np.zeros_like(x)
    add_bar_forces(model.ends, x, v, rest, rate, model.bars.columns, water_of(model.water), total)
    add_sheet_forces(x, v, *sheets_of(model), water_of(model.water), total)
    total[: model.nodes] += lump_forces(model, state)
    boards, kite = board_loads(model, state), kite_load(model, state)
    return gathered(model, total, points.arms, boards, kite)


def gathered(
    model: GearModel, total: FloatArray, arms: FloatArray, boards: FloatArray, kite: FloatArray
) -> FloatArray:
    """Return generalised forces (dof,) from the loads of points, boards and kite."""
    held = model.layout.kite
    given = promote_dtypes(total, arms, boards, kite, held.shares)
    force = np.empty(model.dof, given[0].dtype)
    gather_loads(*given, held.nodes, force)
    return force


def block_forces(model: GearModel, state: State, tow: Tow) -> FloatArray:
    """Return the force (2, 3) of each warp on its towing block, N.

    It includes the load of half a segment, which a lumped line has at its fixed end. So the tension
    at the block does not depend on the number of segments.
    """
    top = model.layout.top_warp_bars
    block, upper = model.ends[top].T
    block = block - model.nodes - 6
    rest, rate = (values[top] for values in rest_lengths(model, tow))
    x, v, rest, rate = promote_dtypes(
        np.concatenate([tow.blocks[block], state.nodes[upper]]),
        np.concatenate([tow.block_velocities[block], state.node_velocities[upper]]),
        rest,
        rate,
    )
    ends, total = np.arange(2 * len(top)).reshape(2, -1).T, np.zeros_like(x)
    columns = model.bars.chosen(top).columns
    add_bar_forces(
        np.ascontiguousarray(ends), x, v, rest, rate, columns, water_of(model.water), total
    )
    return total[: len(top)]


def bar_tensions(model: GearModel, state: State, tow: Tow) -> FloatArray:
    """Return the tension (m,) of every bar, N."""
    return line.tension(model.bars, motion_of(model, points_of(model, state, tow), tow))[0]


@dataclass(frozen=True)
class LinearisedForces:
    """Forces (dof,), K = -∂F/∂q and C = -∂F/∂v as data on the model's pattern."""

    force: FloatArray
    stiffness: FloatArray
    damping: FloatArray


def linearised(model: GearModel, state: State, tow: Tow) -> LinearisedForces:
    """Return the forces with their exact derivatives at one state."""
    pattern, points = model.pattern, points_of(model, state, tow)
    n, hung = model.nodes, len(model.pattern.hung)
    stiffness, damping = np.zeros((2, len(pattern.indices)))
    k, c = np.empty((2, hung + len(pattern.rigged), 6, 6))
    start_force, total = np.empty((len(k), 3)), np.zeros_like(points.positions)
    add_bar_blocks(
        model.ends,
        pattern.order,
        points.positions,
        points.velocities,
        *rest_lengths(model, tow),
        model.bars.columns,
        water_of(model.water),
        pattern.slot,
        total,
        stiffness,
        damping,
        k,
        c,
        start_force,
    )
    moving = points.positions, points.velocities, *sheets_of(model), water_of(model.water)
    add_sheet_slopes(*moving, model.sheet_slots, total, stiffness, damping)
    rig_k, rig_c = _rigged_blocks(model, state, points, start_force[hung:], k[hung:], c[hung:])
    body_k, body_c, body_force = _board_blocks(model, state)
    kite_k, kite_c, kite_force = _kite_blocks(model, state)
    node_k, node_c = _lump_blocks(model, state)
    pattern.add([k[:hung, 3:, 3:], rig_k, body_k, node_k, kite_k], stiffness)
    pattern.add([c[:hung, 3:, 3:], rig_c, body_c, node_c, kite_c], damping)

    total[:n] += lump_forces(model, state)
    force = gathered(model, total, points.arms, body_force, kite_force)
    return LinearisedForces(force, stiffness, damping)


def _lift(model: GearModel, points: Points) -> FloatArray:
    """Return B of `_rigged_blocks` with the identity of the bar's other end, (r, 6, 9)."""
    lift = np.zeros((len(model.pattern.rigged), 6, 9))
    lift[:, :3, :3] = np.eye(3)
    lift[:, :3, 3:6] = -skew(points.arms[model.pattern.rig_board, model.pattern.rig_point])
    lift[:, 3:, 6:] = np.eye(3)
    return lift


def _rigged_blocks(
    model: GearModel,
    state: State,
    points: Points,
    forces: FloatArray,
    k: FloatArray,
    c: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the blocks of bars at a fastening point p = X + a: δp = [I, -S(a)] (δX, δθ)."""
    arm = skew(points.arms[model.pattern.rig_board, model.pattern.rig_point])
    spin = skew(state.board_rates[model.pattern.rig_board])
    lift = _lift(model, points)
    # The velocity of the point, v + ω × a, changes with the rotation too.
    turning = np.zeros((len(k), 6, 9))
    turning[:, :3, 3:6] = -spin @ arm
    back = np.swapaxes(lift, 1, 2)
    rig_k = back @ (k @ lift + c @ turning)
    # The moment a × f changes with the rotation of a, even at constant f.
    rig_k[:, 3:6, 3:6] -= skew(forces) @ arm
    return rig_k, back @ c @ lift


def _board_blocks(model: GearModel, state: State) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Linearise the boards' own loads by the complex step in their positions and velocities."""
    shift, turned, velocity, rate = _board_steps()
    load = board_physics.own_load(
        model.board,
        model.coefficients,
        OUTWARD,
        state.board_positions + shift,
        turned @ state.board_rotations,
        state.board_velocities + velocity,
        state.board_rates + rate,
        model.water,
    )
    slopes = np.moveaxis(load.imag / STEP, 0, -1)
    return -slopes[..., :6], -slopes[..., 6:], load[0].real


@cache
def _board_steps() -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return complex steps in a board's position, rotation, velocity and rate.

    Each of them has all twelve steps, of which three are its own; the second are rotations.
    """
    steps = stepped(np.zeros((12, 12)), np.eye(12)).reshape(12, 4, 1, 3)
    return steps[:, 0], rotation(steps[:, 1]), steps[:, 2], steps[:, 3]


@cache
def _kite_steps() -> FloatArray:
    """Return complex steps (12, 2, 2, 3) in position and velocity of the kite's two carriers."""
    return stepped(np.zeros((12, 12)), np.eye(12)).reshape(12, 2, 2, 3)


def _kite_blocks(model: GearModel, state: State) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Linearise the kite's load by the complex step in its carriers' positions and velocities."""
    held = model.layout.kite
    if not held.held:
        return np.zeros((1, 9, 9)), np.zeros((1, 9, 9)), np.zeros(3)
    steps = _kite_steps()
    x = held.weights @ state.nodes[held.nodes] + steps[:, 0]
    v = held.weights @ state.node_velocities[held.nodes] + steps[:, 1]
    load = kite_physics.load(model.kite, x[:, 0], x[:, 1], v[:, 0], v[:, 1], model.water)
    slopes = (load.imag / STEP).T.reshape(3, 2, 6) @ held.carried
    blocks = -(held.shares[:, None, None, None] * slopes).transpose(2, 0, 1, 3).reshape(2, 9, 9)
    return blocks[:1], blocks[1:], load[0].real


def _lump_blocks(model: GearModel, state: State) -> tuple[FloatArray, FloatArray]:
    stiffness, damping = np.empty((2, model.nodes, 3, 3))
    fill_lump_slopes(
        *promote_dtypes(
            state.nodes,
            state.node_velocities,
            model.lump_volume,
            model.lump_drag_area,
            model.lump_viscous_area,
        ),
        water_of(model.water),
        stiffness,
        damping,
    )
    for more in model.node_forces:
        at, still = more.nodes, np.zeros((len(more.nodes), 3))
        for axis in range(3):
            step = still + 1j * STEP * np.eye(3)[axis]
            x, v = state.nodes[at], state.node_velocities[at]
            stiffness[at, :, axis] -= more(x + step, v + still).imag / STEP
            damping[at, :, axis] -= more(x + still, v + step).imag / STEP
    return stiffness, damping


def mass(model: GearModel, state: State, tow: Tow) -> FloatArray:
    """Return the mass matrix with added mass (eq. 15, 16, 25-27, 29) as data on the pattern.

    Bars contribute half of their mass to either end. Boards contribute their inertia in fixed
    axes, and their added mass if the gear file has one.
    """
    pattern, points = model.pattern, points_of(model, state, tow)
    hung, rigged = len(pattern.hung), len(pattern.rigged)
    data, half = np.zeros(len(pattern.indices)), np.empty((hung + rigged, 3, 3))
    add_bar_masses(
        model.ends,
        pattern.order,
        points.positions,
        rest_lengths(model, tow)[0],
        model.bars.columns,
        water_of(model.water),
        pattern.slot,
        data,
        half,
    )
    rigged_mass, body, board = np.empty((rigged, 9, 9)), np.empty((2, 6, 6)), model.board
    fill_board_masses(
        float(board.mass),
        board.inertia,
        board.added_mass,
        OUTWARD,
        state.board_rotations,
        points.arms,
        half[hung:],
        pattern.rig_board,
        pattern.rig_point,
        rigged_mass,
        body,
    )
    lumps, canvas, held = np.empty((model.nodes, 3, 3)), np.empty((9, 9)), model.layout.kite
    density = model.water.density_at(state.nodes[:, 2])
    kite = model.kite.mass * held.shares
    fill_masses(model.lump_mass, model.lump_added, density, kite, lumps, canvas)
    pattern.add([half[:hung], rigged_mass, body, lumps, canvas], data)
    return data
