"""The gear as its markers show it, drawn from above and from the side."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from trawl_ros.messages.topics import DOOR_FRAMES

ROPES = ('_warp', '_bridle', 'headrope', 'footrope', *DOOR_FRAMES.values())
"""Ends of the names of what is drawn bold."""

SURFACE = '#1f77b4'


@dataclass(frozen=True)
class _Lines:
    """Straight pieces (n, 2, 3), m, each with its colour (n, 3), under one name."""

    name: str
    pieces: np.ndarray
    colours: np.ndarray


def gear_figure(gear: Any | None) -> Figure:
    """Draw the gear with the ship's stern at the origin.

    Parameters
    ----------
    gear
        A message of ``truth/gear``; None gives empty axes.
    """
    figure = Figure(figsize=(10.0, 4.2), layout='constrained')
    lines = [] if gear is None else _in_ships_axes(_lines(gear))
    every = np.concatenate([line.pieces.reshape(-1, 3) for line in lines] or [np.eye(3)])
    _, width, height = np.ptp(every, axis=0)
    top, side = figure.subplots(2, 1, sharex=True, height_ratios=(width, height))
    for line in lines:
        width = 1.6 if line.name.endswith(ROPES) else 0.4
        for axes, down in ((top, 1), (side, 2)):
            pieces = list(line.pieces[:, :, (0, down)])
            axes.add_collection(LineCollection(pieces, colors=line.colours, linewidths=width))
    side.axhline(0.0, color=SURFACE, lw=0.8)
    top.set_title('The gear at the end of the trial: from slack (blue) to tight (red)')
    top.set_ylabel('to port / m')
    side.set_ylabel('height / m')
    side.set_xlabel('behind the ship / m')
    for axes in (top, side):
        axes.set_aspect('equal')
        axes.autoscale_view()
        axes.grid(alpha=0.3)
    return figure


def _lines(gear: Any) -> list[_Lines]:
    """The markers as straight pieces, doors as their two middle lines."""
    found = []
    for marker in gear.markers:
        points = np.array([[p.x, p.y, p.z] for p in marker.points]).reshape(-1, 3)
        if marker.type == marker.LINE_STRIP:
            pieces = np.stack([points[:-1], points[1:]], axis=1)
        elif marker.type == marker.LINE_LIST:
            pieces = points.reshape(-1, 2, 3)
        elif marker.type == marker.CUBE:
            pieces = _door(marker)
        else:
            continue
        per_point = [marker.color] * len(pieces) if not marker.colors else marker.colors[::2]
        colours = np.array([[colour.r, colour.g, colour.b] for colour in per_point])
        found.append(_Lines(marker.ns, pieces, colours))
    return found


def _door(marker: Any) -> np.ndarray:
    place, turn = marker.pose.position, marker.pose.orientation
    axes = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).as_matrix()
    middle = np.array([place.x, place.y, place.z])
    halves = 0.5 * np.array([marker.scale.x * axes[:, 0], marker.scale.z * axes[:, 2]])
    return np.stack([middle - halves, middle + halves], axis=1)


def _in_ships_axes(lines: list[_Lines]) -> list[_Lines]:
    """Turn ``map`` into astern, to port, up, from midway between the towing blocks."""
    blocks = [line.pieces[0, 0] for line in lines if line.name.endswith('_warp')]
    origin = np.mean(blocks, axis=0)
    astern = np.concatenate([line.pieces.reshape(-1, 3) for line in lines]).mean(axis=0) - origin
    astern[2] = 0.0
    astern /= np.linalg.norm(astern)
    basis = np.array([astern, [astern[1], -astern[0], 0.0], [0.0, 0.0, 1.0]])
    return [_Lines(line.name, (line.pieces - origin) @ basis.T, line.colours) for line in lines]
