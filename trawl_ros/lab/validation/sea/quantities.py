# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quantities that sources print in addition to observables: drag, area, tension, attack angle."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.equilibrium import SteadyState
from trawl_ros.solver.trimming.held_boards import rope_pulls

DERIVED = ('net_drag', 'mouth_area', 'lower_bridle_tension', 'board_attack')
"""Names of these quantities."""


def quantities(model: GearModel, steady: SteadyState) -> dict[str, float]:
    """Quantities of `DERIVED` in a steady state: N, m², N and degrees.

    Tension of the lower bridle is its mean pull at the boards, where a sweep takes its place; the
    attack angle is the mean of both boards.
    """
    found, seen = steady.equilibrium, steady.observables
    # Of the three points of a board the first is the warp's, the last the lower bridle's.
    pulls = rope_pulls(model, found.state, found.tow)
    lower = np.linalg.norm(pulls[:, 2], axis=-1)
    return {
        'net_drag': net_drag(pulls, found.tow),
        'mouth_area': mouth_area(model, found.state),
        'lower_bridle_tension': float(lower.mean()),
        'board_attack': float(np.degrees(0.5 * (seen.port_attack + seen.starboard_attack))),
    }


def net_drag(pulls: FloatArray, tow: Tow) -> float:
    """Drag (N) of everything behind the boards.

    It is the force of sweeps and bridles on the boards against the course, from ``pulls`` (2, 3, 3)
    at the boards' fastening points.
    """
    behind = pulls[:, 1:].sum(axis=(0, 1))
    course: FloatArray = tow.block_velocities.mean(axis=0)
    return float(-behind @ course / np.linalg.norm(course))


def mouth_area(model: GearModel, state: State) -> float:
    """Area (m²) within headrope, footrope and the ropes of the wings' ends, seen from ahead."""
    lines = {name: points for name, points, _ in model.layout.lines}
    head, foot = model.layout.headrope, model.layout.footrope
    port, starboard = lines['port_wing_end'], lines['starboard_wing_end']
    # Both ropes of the wings' ends run from the headrope to the footrope.
    assert port[0] == head[0]
    assert starboard[0] == head[-1]
    rim = [*head, *starboard[1:], *foot[::-1][1:], *port[::-1][1:-1]]
    y, z = state.nodes[rim, 1], state.nodes[rim, 2]
    return float(0.5 * abs(np.sum(y * np.roll(z, -1) - z * np.roll(y, -1))))
