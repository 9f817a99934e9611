"""Section of the gear in the sonar's plane, and the axes of that plane."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State
from trawl_ros.records.truth import single


def sonar_axes(model: GearModel, state: State) -> FloatArray:
    """Axes of frame ``sonar`` as columns (3, 3): z forward along the mouth's normal, x down in
    the mouth, y port.
    """
    layout = model.layout
    head, foot = layout.headrope, layout.footrope
    port = state.nodes[head[0]] - state.nodes[head[-1]]
    down = state.nodes[foot[len(foot) // 2]] - state.nodes[head[len(head) // 2]]
    down = down - (down @ port) / (port @ port) * port
    x, y = down / np.linalg.norm(down), port / np.linalg.norm(port)
    return np.column_stack([x, y, np.cross(x, y)])


def section_of(model: GearModel, state: State, axes: FloatArray) -> FloatArray:
    """Section: intersections of ropes and twine with the plane z = 0 of frame ``sonar``.

    A numerical bar that stands for several real ones passes once, with the diameter of one. The
    sonar's own node is left out.

    Parameters
    ----------
    model, state
        The gear.
    axes
        From `sonar_axes`.

    Returns
    -------
    array
        Shape (k, 3), as in `NetTruth`.
    """
    head, foot = model.layout.headrope, model.layout.footrope
    sonar, middle = head[len(head) // 2], foot[len(foot) // 2]
    positions = (state.nodes - state.nodes[sonar]) @ axes
    # Both lie in the plane by its definition, and rounding must not say which bars cross there.
    positions[[sonar, middle], 2] = 0.0
    # Bars at boards and ship end beyond the last node: they are far ahead of the mouth.
    inner = np.flatnonzero((model.ends < model.nodes).all(axis=1) & (model.bars.normal_area > 0))
    start, end = model.ends[inner].T
    behind = positions[:, 2] < 0.0
    through = (behind[start] != behind[end]) & (start != sonar) & (end != sonar)
    bars, a, b = inner[through], positions[start[through]], positions[end[through]]
    share = a[:, 2] / (a[:, 2] - b[:, 2])
    places = (a + share[:, None] * (b - a))[:, :2]
    # n bars of diameter d have the volume n π d² / 4 and the area n d per metre.
    diameters = 4 / np.pi * model.bars.volume[bars] / model.bars.normal_area[bars]
    # The footrope touches the plane with its middle, and need not pass through it anywhere.
    lowest = [*positions[middle, :2], model.gear.footrope.diameter_m]
    return single(np.vstack([np.column_stack([places, diameters]), lowest]))
