# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Single line of rope, with the same kernel, assembly and solvers as a whole gear.

A gear model always has boards. Here they float next to the line, without ropes or area, and as
heavy as the water they displace.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.line import BarProperties
from trawl_ros.model.net.kite_nodes import NO_KITE
from trawl_ros.model.net.sheets import NetSheets
from trawl_ros.model.pattern import build_pattern
from trawl_ros.model.state import State, Tow
from trawl_ros.model.water import Water
from trawl_ros.solver.relax import relax

Held = Literal['nowhere', 'at its start', 'at both ends']

WIRE: Mapping[str, float] = {
    'diameter_m': 0.032,
    'weight_in_water_n_m': 28.0,
    'stiffness_n': 4e7,
    'normal_drag': 1.2,
    'tangential_drag': 0.02,
}
"""Wire of the closed forms, in keys of the gear file."""

SEA = Water(density=1025.0, gravity=9.80665)

FORCE_LEFT = 1e-5
"""Largest residual force (N) of an equilibrium, far below the tolerance of the closed forms."""


def lone_line(
    wire: Mapping[str, float], segments: int, water: Water, held: Held = 'at its start'
) -> GearModel:
    """Return a gear model of a single line.

    Parameters
    ----------
    wire
        Keys of a rope in the gear file; the rest is the default gear's warp.
    segments
        Bars it is cut into, at least 3.
    held
        Ends that hang on the towing blocks, the start on the first and the end on the second.
        Ends that are free are nodes; nodes are numbered from the start.
    """
    gear = load_gear('kaifuha')
    record = gear.model_copy(
        update={'warp': gear.warp.model_copy(update={**wire, 'segments': segments})}
    )
    whole = build_model(record)
    nodes = segments + 1 - ('nowhere', 'at its start', 'at both ends').index(held)
    blocks = nodes + 6, nodes + 7
    points = list(range(nodes))
    if held != 'nowhere':
        points.insert(0, blocks[0])
    pairs = list(pairwise(points))
    if held == 'at both ends':
        # A bar at a block starts there: the assembly relies on it.
        pairs.append((blocks[1], nodes - 1))
    ends = np.array(pairs)
    top = {'nowhere': [], 'at its start': [0], 'at both ends': [0, segments - 1]}[held]
    nothing = np.zeros(nodes)
    own = whole.layout.top_warp_bars[:1]
    return replace(
        whole,
        water=water,
        board=replace(
            whole.board, volume=whole.board.mass / water.density, area=0.0, rotary_slope=0.0
        ),
        kite=replace(whole.kite, area=0.0, mass=0.0, volume=0.0),
        bars=BarProperties(*(values[own].repeat(segments) for values in vars(whole.bars).values())),
        ends=ends,
        rest=np.ones(segments),
        warp_side=np.zeros(segments, int),
        lump_mass=nothing,
        lump_volume=nothing,
        lump_drag_area=nothing,
        lump_viscous_area=nothing,
        lump_added=nothing,
        sheets=NetSheets(np.empty((0, 5), int), np.empty((0, 2, 5)), nothing[:0], nothing[:0]),
        layout=replace(whole.layout, kite=NO_KITE, top_warp_bars=np.array(top, int)),
        pattern=build_pattern(nodes, ends, NO_KITE.nodes),
    )


def loaded(model: GearModel, mass: float, volume: float, drag_area: float) -> GearModel:
    """Return the line with a lump at its last node: mass (kg), volume (m³), C_D A (m²)."""
    last = np.zeros(model.nodes)
    last[-1] = 1.0
    return replace(
        model, lump_mass=mass * last, lump_volume=volume * last, lump_drag_area=drag_area * last
    )


def holding(length: float, start: FloatArray, end: FloatArray, speed: float = 0.0) -> Tow:
    """Hold a line of unstretched ``length`` (m) at two points (3,), towed along x (m/s)."""
    return Tow(
        blocks=np.stack([start, end]),
        block_velocities=np.tile([speed, 0.0, 0.0], (2, 1)),
        lengths=np.full(2, length),
        length_rates=np.zeros(2),
    )


def lying(nodes: FloatArray, velocity: FloatArray) -> State:
    """Return a line at ``nodes`` (n, 3) that moves with one velocity (3,), m/s."""
    return State(
        nodes=nodes,
        board_positions=np.array([[0.0, 50.0, -10.0], [0.0, -50.0, -10.0]]),
        board_rotations=np.tile(np.eye(3), (2, 1, 1)),
        node_velocities=np.tile(velocity, (len(nodes), 1)),
        # A board at rest in still water has no attack angle.
        board_velocities=np.tile([1.0, 0.0, 0.0], (2, 1)),
        board_rates=np.zeros((2, 3)),
    )


def settled(model: GearModel, nodes: FloatArray, tow: Tow) -> State:
    """Return the steady state of a line that starts from ``nodes`` (n, 3).

    Raises
    ------
    NoSteadyState
        If none is found.
    """
    free = np.arange(model.dof) < 3 * model.nodes
    state, iterations, left = relax(
        model,
        lying(nodes, tow.block_velocities[0]),
        tow,
        tolerance=FORCE_LEFT,
        time_step=1.0,
        free=free,
    )
    if left > FORCE_LEFT:
        raise NoSteadyState(f'lone line: {left:.3g} N left after {iterations} iterations')
    return state
