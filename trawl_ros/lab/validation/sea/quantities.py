"""Quantities that sources print beside the observables: drag of the net, area of its mouth."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.equilibrium import SteadyState
from trawl_ros.solver.trimming.held_boards import rope_pulls

DERIVED = ('net_drag', 'mouth_area')
"""Names of these quantities."""


def quantities(model: GearModel, steady: SteadyState) -> dict[str, float]:
    """Quantities of `DERIVED` in a steady state, N and m²."""
    found = steady.equilibrium
    return {
        'net_drag': net_drag(model, found.state, found.tow),
        'mouth_area': mouth_area(model, found.state),
    }


def net_drag(model: GearModel, state: State, tow: Tow) -> float:
    """Drag (N) of all that is behind the boards: the pull of sweeps and bridles on them against the
    course.
    """
    # Of the three points of a board the first is the warp's.
    pull = rope_pulls(model, state, tow)[:, 1:].sum(axis=(0, 1))
    course: FloatArray = tow.block_velocities.mean(axis=0)
    return float(-pull @ course / np.linalg.norm(course))


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
