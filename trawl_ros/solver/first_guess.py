# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""First guess of the gear's shape, and a known shape shifted to other warp lengths."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.assembly import block_forces, forces, linearised
from trawl_ros.model.gear_model import OUTWARD, GearModel, build_model
from trawl_ros.model.numerics import STEP, length
from trawl_ros.model.rotations import about_axis
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import factorised

FIRST_ATTACK = np.radians(20.0)
FIRST_LEAN = np.radians(14.0)
DEPTH_PER_WARP, REACH_PER_WARP = 0.22, 0.16
"""Depth and sideways reach of a board per length of warp, typical of gears."""

BRIDLE_REACH = 0.88
"""Distance of the net behind the boards per length of bridle: bridles run inward at some 28°."""

MAX_SIDEWAYS_FRACTION = 0.95
"""Largest sideways part of warp and bridle for which ships of a pair are close enough."""

COARSE_AROUND = (96, 48, 24)
"""Meshes around the mouth of the coarser nets whose shape is found first."""

INTERPOLATION_NODES = 12
"""Nodes of the coarser net from which the place of a finer net's node is interpolated."""


def first_guess(model: GearModel, tow: Tow, heading: float, *, turned: bool = False) -> State:
    """Return a first guess: straight warps, boards at a typical attitude, the net as built.

    Plates of a pair are on edge, or ``turned`` over.
    """
    lengths = tow.lengths
    half = 0.5 * model.gear.block_distance
    depth = DEPTH_PER_WARP * lengths
    bridle = model.gear.behind_boards
    reach, attack, lean = REACH_PER_WARP * lengths, FIRST_ATTACK, FIRST_LEAN
    if model.paired:
        # The plate lies on the straight line from its ship to its wing.
        wing = abs(model.first_guess[model.layout.headrope[0], 1])
        share = (half - wing) / (lengths + bridle)
        if share.max() > MAX_SIDEWAYS_FRACTION:
            raise NoSteadyState(
                f'ships {2 * half:g} m apart, {lengths.min():g} m of warp and bridles of '
                f'{bridle:g} m: the net between the ships is {2 * wing:.0f} m wide and cannot be '
                'reached; expected ships closer together or more warp'
            )
        reach = -share * lengths
        attack, lean = float(np.arctan2(-reach.mean(), lengths.mean())), np.pi * turned
    boards = np.stack(
        [-np.sqrt(lengths**2 - depth**2 - reach**2), (half + reach) * OUTWARD, -depth], 1
    )
    blocks = np.array([[0.0, half, 0.0], [0.0, -half, 0.0]])
    nodes = np.array(model.first_guess)
    layout = model.layout
    share = np.arange(1, model.warp_segments) / model.warp_segments
    for side, warp in enumerate(layout.warps):
        nodes[warp] = blocks[side] + share[:, None] * (boards[side] - blocks[side])
    nodes[layout.net] += [boards[:, 0].mean() - BRIDLE_REACH * bridle, 0.0, boards[:, 2].mean()]
    starts = boards.copy()
    for side, sweep in enumerate(layout.sweeps):
        _lay_sweep(model, nodes, side, boards[side])
        starts[side] = nodes[sweep[-1]]
    for k, (line, end) in enumerate(zip(layout.bridles, layout.bridle_ends, strict=True)):
        share = np.arange(1, len(line) + 1) / (len(line) + 1)
        start = starts[2 * k // len(layout.bridles)]
        nodes[line] = start + share[:, None] * (nodes[end] - start)
    turn = about_axis(2, heading)
    return at_velocity(
        State(
            nodes=nodes @ turn.T,
            board_positions=boards @ turn.T,
            board_rotations=turn @ attitudes(attack, 0.0, lean),
            node_velocities=np.zeros_like(nodes),
            board_velocities=np.zeros((2, 3)),
            board_rates=np.zeros((2, 3)),
        ),
        tow.block_velocities.mean(0),
    )


def attitudes(yaw: float, pitch: float, roll: float) -> FloatArray:
    """Return rotations (2, 3, 3) of both boards from angles of the port board, rad.

    Yaw turns the leading edge outward, pitch is nose down, roll tips the outward normal up.
    """
    port = about_axis(2, yaw) @ about_axis(1, pitch) @ about_axis(0, roll)
    flip = np.array([1.0, -1.0, 1.0])
    return np.stack([port, flip[:, None] * port * flip])


def _lay_sweep(model: GearModel, nodes: FloatArray, side: int, board: FloatArray) -> None:
    """Lay a sweep on the line from its board to the middle of the bridles' ends."""
    gear, layout = model.gear, model.layout
    assert gear.sweep is not None
    sweep, ends = layout.sweeps[side], np.array_split(layout.bridle_ends, 2)[side]
    backstrop = max(gear.sweep.upper_backstrop_m, gear.sweep.lower_backstrop_m)
    places = backstrop + np.linspace(0.0, gear.sweep.length_m, len(sweep))
    share = places / gear.behind_boards
    nodes[sweep] = board + share[:, None] * (nodes[ends].mean(axis=0) - board)


def coarser_model(model: GearModel) -> GearModel | None:
    """Return the gear with the next coarser net, whose shape is found faster; None if none is."""
    coarser = [around for around in COARSE_AROUND if around < model.gear.netting.around]
    if not coarser:
        return None
    coarse = _coarse(model.gear, coarser[0])
    return replace(
        coarse,
        coefficients=model.coefficients,
        board=model.board,
        kite=model.kite,
        water=model.water,
    )


@lru_cache(maxsize=4)
def _coarse(gear: GearRecord, around: int) -> GearModel:
    return build_model(gear.changed('netting', around=around))


def carried_over(coarse: GearModel, found: State, model: GearModel) -> State:
    """Interpolate the shape of a coarser net as a guess for a finer one.

    The displacement from the built shape is a smooth function of the built position, which both
    nets share. Warps and bridles have the same nodes in both.
    """
    layout = coarse.layout
    built, fine = coarse.net_mesh.positions, model.net_mesh.positions
    neighbours, shares = _interpolation(built.tobytes(), fine.tobytes())
    moved = found.nodes[layout.net] - built
    nodes = np.empty((model.nodes, 3))
    nodes[model.layout.net] = fine + np.einsum('nk,nki->ni', shares, moved[neighbours])
    for ours, theirs in (
        *zip(model.layout.warps, layout.warps, strict=True),
        *zip(model.layout.bridles, layout.bridles, strict=True),
        *zip(model.layout.sweeps, layout.sweeps, strict=True),
    ):
        nodes[ours] = found.nodes[theirs]
    return replace(
        found, nodes=nodes, node_velocities=np.tile(found.node_velocities[0], (model.nodes, 1))
    )


@lru_cache(maxsize=4)
def _interpolation(known: bytes, wanted: bytes) -> tuple[IntArray, FloatArray]:
    """Return the nearest known points (n, k) of each wanted one, and their weights (n, k).

    Points come as the bytes of arrays (..., 3), which makes them hashable. Each wanted point has
    its own local interpolant: a constant and radial basis functions -r.
    """
    # Imported here: the import takes long, and warm starts do not need it.
    from scipy.spatial import KDTree

    there, here = (np.frombuffer(places).reshape(-1, 3) for places in (known, wanted))
    count = min(INTERPOLATION_NODES, len(there))
    neighbours: IntArray = KDTree(there).query(here, count)[1].reshape(len(here), count)
    near = there[neighbours]
    matrix = np.ones((len(here), count + 1, count + 1))
    matrix[:, :count, :count] = -length(near[:, :, None] - near[:, None])
    matrix[:, count, count] = 0.0
    right = np.ones((len(here), count + 1, 1))
    right[:, :count, 0] = -length(near - here[:, None])
    shares = np.linalg.solve(matrix, right)[:, :count, 0]
    return neighbours, np.asarray(shares, float)


def at_velocity(state: State, velocity: FloatArray) -> State:
    """Return the state with every part moving at one velocity (3,)."""
    return replace(
        state,
        node_velocities=np.tile(velocity, (len(state.nodes), 1)),
        board_velocities=np.tile(velocity, (2, 1)),
        board_rates=np.zeros((2, 3)),
    )


def shifted_to(model: GearModel, state: State, old: Tow, new: Tow) -> State:
    """Move a steady shape along its warps to other lengths.

    Otherwise a change would begin with slack or overstretched warps, and the boards would fall.
    Where one warp changes by more than the other, the shape first changes along its tangent.
    """
    change = new.lengths - old.lengths
    uneven = change - change.mean()
    if uneven.any():
        state = state.moved(_tangent(model, state, old, uneven))
        old = replace(old, lengths=old.lengths + uneven)
    pull = block_forces(model, state, old)
    toward_gear = pull / np.linalg.norm(pull, axis=1)[:, None]
    change = toward_gear * (new.lengths - old.lengths)[:, None]
    offset = change.mean(0)
    moved = state.shifted(offset)
    nodes = moved.nodes.copy()
    share = np.arange(1, model.warp_segments) / model.warp_segments
    for warp in model.layout.warps:
        nodes[warp] = state.nodes[warp] + share[:, None] * offset
    return at_velocity(replace(moved, nodes=nodes), new.block_velocities.mean(0))


def _tangent(model: GearModel, state: State, tow: Tow, change: FloatArray) -> FloatArray:
    """Return the first-order displacement (dof,) of a steady state for a change of both lengths."""
    longer = replace(tow, lengths=tow.lengths + 1j * STEP * change)
    push = forces(model, state, longer).imag / STEP
    stiffness = linearised(model, state, tow).stiffness
    return factorised(model.pattern, stiffness).solve(push)
