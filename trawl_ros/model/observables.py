"""Observation: the observables of a state of the gear."""

from typing import cast

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.assembly import block_forces
from trawl_ros.model.board import flow_at, inclination, pitch_and_roll
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.numerics import angle, distance, length
from trawl_ros.model.state import State, Tow
from trawl_ros.records.observables import Observables

COLLAPSED_NORMAL, LYING_SPAN = -0.35, 0.5
"""Vertical parts of a board's outward normal, below which it has fallen on its face, and of its
span, below which, inclined by 60°, it lies on its back or hangs upside down.
"""

LYING = np.sin(np.radians(50.0))
"""Vertical part of a board's outward normal, up or down, from which it lies over."""


def observe(model: GearModel, state: State, tow: Tow) -> Observables:
    """Compute the observables of a state; complex states give complex values, and states whose
    arrays have dimensions in front give as many values of each.
    """
    port, starboard = state.board_positions[..., 0, :], state.board_positions[..., 1, :]
    flow = flow_at(
        model.board,
        OUTWARD,
        state.board_positions,
        state.board_rotations,
        state.board_velocities,
        state.board_rates,
        model.water,
    )
    pitch, roll = pitch_and_roll(state.board_rotations)
    lean = inclination(state.board_rotations)
    pull = block_forces(model, state, tow)
    tension = length(pull)
    # Warps leave over the stern: their angles count from straight astern.
    to_port = tow.blocks[..., 0, :2] - tow.blocks[..., 1, :2]
    to_port = (to_port / length(to_port)[..., None])[..., None, :]
    astern = pull[..., 1] * to_port[..., 0] - pull[..., 0] * to_port[..., 1]
    aside = pull[..., 0] * to_port[..., 0] + pull[..., 1] * to_port[..., 1]
    divergence = angle(aside * OUTWARD, astern)
    declination = angle(-pull[..., 2], length(pull[..., :2]))
    ends, centre, below = _mouth_nodes(model)
    top = state.nodes[..., centre, :]
    values = {
        'door_spread': distance(port, starboard),
        'port_door_depth': -port[..., 2],
        'starboard_door_depth': -starboard[..., 2],
        'port_tension': tension[..., 0],
        'starboard_tension': tension[..., 1],
        'net_depth': -top[..., 2],
        'vertical_opening': top[..., 2] - state.nodes[..., below, 2],
        'horizontal_opening': distance(state.nodes[..., ends[0], :], state.nodes[..., ends[1], :]),
        'port_pitch': pitch[..., 0],
        'starboard_pitch': pitch[..., 1],
        'port_roll': roll[..., 0],
        'starboard_roll': roll[..., 1],
        'port_divergence': divergence[..., 0],
        'starboard_divergence': divergence[..., 1],
        'port_declination': declination[..., 0],
        'starboard_declination': declination[..., 1],
        'port_attack': flow.attack[..., 0],
        'starboard_attack': flow.attack[..., 1],
        'port_slip': flow.slip[..., 0],
        'starboard_slip': flow.slip[..., 1],
        'port_inclination': lean[..., 0],
        'starboard_inclination': lean[..., 1],
    }
    # Numbers of one state, arrays of many.
    return Observables(**cast(dict[str, float], values))


def _mouth_nodes(model: GearModel) -> tuple[tuple[int, int], int, int]:
    """Both ends of the headrope, its centre, and the footrope's."""
    head, foot = model.layout.headrope, model.layout.footrope
    ends = int(head[0]), int(head[-1])
    return ends, int(head[len(head) // 2]), int(foot[len(foot) // 2])


def observed_nodes(model: GearModel) -> IntArray:
    """Nodes (k,) that the observables depend on: of the mouth, and the highest of the warps."""
    ends, centre, below = _mouth_nodes(model)
    return np.unique([*ends, centre, below, *model.ends[model.layout.top_warp_bars, 1]])


def outward_normal_lift(state: State) -> FloatArray:
    """Vertical part (2,) of the boards' outward unit normals; positive points up."""
    lift: FloatArray = state.board_rotations[:, 2, 1] * OUTWARD
    return lift


def fallen_boards(state: State) -> tuple[bool, bool]:
    """True for each board, port first, that lies on its face or back or hangs upside down."""
    up = np.real(state.board_rotations[:, 2, 2])
    port, starboard = (outward_normal_lift(state) < COLLAPSED_NORMAL) | (up < LYING_SPAN)
    return bool(port), bool(starboard)


def lies_over(model: GearModel, state: State) -> bool:
    """True if a board leans by 50° and more; the plates of a pair trawl may lie as they will."""
    return not model.paired and bool(np.abs(outward_normal_lift(state)).max() > LYING)


def highest_point(model: GearModel, state: State) -> float:
    """Height (m) of the highest node or board edge; above zero means out of the water."""
    half = 0.5 * model.board.span
    tops = state.board_positions[:, 2] + half * np.abs(state.board_rotations[:, 2, 2])
    return float(max(state.nodes[:, 2].max(), tops.max()))
