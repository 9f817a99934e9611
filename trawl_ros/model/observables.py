# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Observables of a state of the gear.

Their loop is compiled for complex numbers, for the complex step, as the boards' law is.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.bar_pass import WaterTable, add_bar_forces, water_of
from trawl_ros.model.board_law import angle_at, fill_flow
from trawl_ros.model.compiled import as_kind, compiled, njit_device, stepped_among
from trawl_ros.model.current import current_at
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.records.observables import OBSERVABLES, Observables

COLLAPSED_NORMAL = -0.35
"""Vertical part of a board's outward normal below which it has fallen on its face."""

LEAST_SPAN_UPWARD = 0.5
"""Vertical part of a board's span below which it lies down or hangs upside down."""

LYING_NORMAL = np.sin(np.radians(50.0))
"""Vertical part of a board's outward normal, up or down, above which it lies over."""

TOP_ENDS = np.array([[0, 2], [1, 3]])
"""Ends of the highest bars of both warps among the blocks and the nodes below them."""


def observe(model: GearModel, state: State, tow: Tow) -> Observables:
    """Return the observables of a state; complex states give complex values."""
    at = observed_nodes(model)
    parts = (
        state.nodes[at],
        state.board_positions,
        state.board_rotations,
        state.node_velocities[at],
        state.board_velocities,
        state.board_rates,
    )
    there = tow.blocks, tow.block_velocities, tow.lengths, tow.length_rates
    given = [part[None] for part in (*parts, *there)]
    values = observed_values(model, State(*given[:6]), Tow(*given[6:]))[0]
    found = values if stepped_among(*given) else values.real
    return Observables(*found.tolist())


def observed_values(model: GearModel, states: State, tows: Tow) -> FloatArray:
    """Return observables (m, 24), complex, of m states that have the `observed_nodes` only."""
    top, segments = model.layout.top_warp_bars, float(model.warp_segments)
    given = as_kind(
        complex,
        *vars(states).values(),
        tows.blocks,
        tows.block_velocities,
        tows.lengths / segments,
        tows.length_rates / segments,
    )
    values = np.empty((len(given[0]), len(OBSERVABLES)), complex)
    bars = model.bars.chosen(top).columns
    middles, outward = as_kind(complex, model.board.middles, OUTWARD)
    fill_observables(*given, TOP_ENDS, bars, middles, outward, water_of(model.water), values)
    return values


def observed_nodes(model: GearModel) -> IntArray:
    """Return the nodes (6,) that the observables depend on.

    They are both ends of the headrope, the centres of headrope and footrope, and the highest node
    of either warp.
    """
    head, foot = model.layout.headrope, model.layout.footrope
    mouth = head[0], head[-1], head[len(head) // 2], foot[len(foot) // 2]
    return np.array([*mouth, *model.ends[model.layout.top_warp_bars, 1]])


@njit_device
def _length(vector: FloatArray) -> float:
    """Return the length of a vector (3,), without conjugation."""
    size: float = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    return size


@compiled
def fill_attitude(rotation: FloatArray, angles: FloatArray) -> None:
    """Fill in pitch, roll and inclination (rad) of one board with a rotation (3, 3).

    Pitch is positive nose down, roll positive with the top to starboard. The inclination δ is that
    of the board's z axis against the vertical (eq. 38), without sign. Pitch and roll are those of
    R = Rz(yaw) Ry(pitch) Rx(roll) in the right-handed door frame.
    """
    level = np.sqrt(rotation[0, 0] ** 2 + rotation[1, 0] ** 2)
    flat = np.sqrt(rotation[0, 2] ** 2 + rotation[1, 2] ** 2)
    angles[0] = angle_at(-rotation[2, 0], level)
    angles[1] = angle_at(rotation[2, 1], rotation[2, 2])
    angles[2] = angle_at(flat, rotation[2, 2])


@compiled
def fill_observables(
    nodes: FloatArray,
    boards: FloatArray,
    rotations: FloatArray,
    node_velocities: FloatArray,
    board_velocities: FloatArray,
    rates: FloatArray,
    blocks: FloatArray,
    block_velocities: FloatArray,
    rest: FloatArray,
    rest_rate: FloatArray,
    ends: IntArray,
    bars: tuple[FloatArray, ...],
    middles: FloatArray,
    outward: FloatArray,
    water: WaterTable,
    values: FloatArray,
) -> None:
    """Fill in the observables (m, 24) in the order of `OBSERVABLES`.

    Parameters
    ----------
    nodes, node_velocities
        Positions and velocities of the `observed_nodes`, (m, 6, 3).
    boards, rotations, board_velocities, rates, blocks, block_velocities
        Arrays of `State` and `Tow`, with m as the first axis.
    rest, rest_rate
        Unstretched lengths of the highest bar of either warp and their rates, (m, 2).
    ends, bars
        Ends of these among both blocks and the nodes below them, and their properties.
    middles, outward
        Means (2, 3) of the boards' fastening points in their outward frames, whose signs are (2,).
    """
    x, v, pull = np.empty((3, 4, 3), values.dtype)
    relative, flow = np.empty((2, 2, 3), values.dtype)
    attack, slip = np.empty((2, 2), values.dtype)
    angles, between = np.empty((2, 3), values.dtype)
    shear = np.empty(3)
    for case in range(len(values)):
        seen = values[case]
        head, other, centre, below = nodes[case, 0], nodes[case, 1], nodes[case, 2], nodes[case, 3]
        for i in range(3):
            between[i] = boards[case, 0, i] - boards[case, 1, i]
        seen[0] = _length(between)
        seen[1], seen[2] = -boards[case, 0, 2], -boards[case, 1, 2]
        seen[5], seen[6] = -centre[2], centre[2] - below[2]
        for i in range(3):
            between[i] = head[i] - other[i]
        seen[7] = _length(between)
        for side in range(2):
            for i in range(3):
                x[side, i], x[2 + side, i] = blocks[case, side, i], nodes[case, 4 + side, i]
                v[side, i] = block_velocities[case, side, i]
                v[2 + side, i] = node_velocities[case, 4 + side, i]
        pull[:] = 0.0
        add_bar_forces(ends, x, v, rest[case], rest_rate[case], bars, water, pull)
        # Warps leave over the stern: their angles are measured from straight astern.
        across, ahead = x[0, 0] - x[1, 0], x[0, 1] - x[1, 1]
        wide = np.sqrt(across**2 + ahead**2)
        across, ahead = across / wide, ahead / wide
        for side in range(2):
            tension = pull[side]
            level = np.sqrt(tension[0] ** 2 + tension[1] ** 2)
            astern = tension[1] * across - tension[0] * ahead
            aside = tension[0] * across + tension[1] * ahead
            seen[3 + side] = _length(tension)
            seen[12 + side] = angle_at(aside * outward[side], astern)
            seen[14 + side] = angle_at(-tension[2], level)
            current_at(water[3], water[4], boards[case, side, 2], relative[side], shear)
            for i in range(3):
                relative[side, i] -= board_velocities[case, side, i]
            fill_attitude(rotations[case, side], angles)
            seen[8 + side], seen[10 + side], seen[20 + side] = angles[0], angles[1], angles[2]
        fill_flow(middles, outward, rotations[case], relative, rates[case], flow, attack, slip)
        for side in range(2):
            seen[16 + side], seen[18 + side] = attack[side], slip[side]
            for i in range(3):
                middle = 0.5 * (blocks[case, 0, i] + blocks[case, 1, i])
                between[i] = boards[case, side, i] - middle
            seen[22 + side] = _length(between)


def outward_normal_lift(state: State) -> FloatArray:
    """Return the vertical part (2,) of the boards' outward unit normals; positive is up."""
    lift: FloatArray = state.board_rotations[:, 2, 1] * OUTWARD
    return lift


def fallen_boards(state: State) -> tuple[bool, bool]:
    """Return True for each board, port first, that lies on its face or back or upside down."""
    up = np.real(state.board_rotations[:, 2, 2])
    port, starboard = (outward_normal_lift(state) < COLLAPSED_NORMAL) | (up < LEAST_SPAN_UPWARD)
    return bool(port), bool(starboard)


def lies_by_attitude(pitch: float, roll: float) -> bool:
    """Return True if a board with this pitch and roll (rad) lies down or hangs upside down.

    It does from an inclination of 60°. The inclination decides, not the roll: a board on its face
    may lean hardly more than a board that stands.
    """
    return bool(np.cos(pitch) * np.cos(roll) < LEAST_SPAN_UPWARD)


def lies_over(model: GearModel, state: State) -> bool:
    """Return True if a board leans by 50° or more; the plates of a pair trawl may lie anyhow."""
    return not model.paired and bool(np.abs(outward_normal_lift(state)).max() > LYING_NORMAL)


def highest_point(model: GearModel, state: State) -> float:
    """Return the height (m) of the highest node or board edge; above zero it is in the air."""
    half = 0.5 * model.board.span
    tops = state.board_positions[:, 2] + half * np.abs(state.board_rotations[:, 2, 2])
    return float(max(state.nodes[:, 2].max(), tops.max()))
