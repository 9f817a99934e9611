# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Markers of gear and ship for RViz and Foxglove: ropes coloured by tension, doors as plates.

Namespace and id of a marker stay the same in every message, so that viewers replace the earlier
marker instead of adding another.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr_writer import CdrWriter, Encoded
from trawl_ros.messages.pieces import TopicMessage
from trawl_ros.records.topics import DOOR_FRAMES, MAP, VESSEL, WINCH_NAMES
from trawl_ros.records.truth import SIDES, GearPicture, Polyline, SchoolTruth

FULL_SCALE = 200e3
"""Tension (N) drawn in full red; it is fixed, so that colours of two pictures can be compared."""

LINE_WIDTH = 0.3
"""Line width, m: thin near the net's mouth, and visible with 900 m of warp in view."""

THICKNESS = 0.1
"""Thickness of a drawn door as a share of its length."""

VESSEL_LENGTH = 100.0
"""Length of the drawn ship, m; assumed, since the project has no length of the ship."""

_HULL = np.array(
    [[0.0, 1.0], [0.65, 1.0], [0.85, 0.6], [1.0, 0.0], [0.85, -0.6], [0.65, -1.0], [0.0, -1.0]]
)
"""Waterline as (lengths ahead of the blocks, half beams to port), from the port quarter around."""

_BEAM_PER_BLOCKS = 20.0 / 12.0
"""Beam over the distance between the blocks, as on the ship of the default gear."""

RAMP = np.array([[0.15, 0.35, 0.85], [0.10, 0.75, 0.55], [0.95, 0.80, 0.15], [0.85, 0.10, 0.10]])
"""Red, green and blue (0 to 1) at equal steps from slack to `FULL_SCALE`."""

_Kind = ros.visualization_msgs__msg__Marker
_Colour = tuple[float, float, float, float]
_STEEL: _Colour = (0.45, 0.45, 0.50, 1.0)
_FISH: _Colour = (0.95, 0.65, 0.40, 0.5)
_NO_BYTES = np.zeros(0, np.uint8)


@dataclass(frozen=True)
class _Marker:
    """Marker: scale (m), colour, points (n, 3) and colours of points (n, 4), pose in ``map``."""

    namespace: str
    kind: int
    scale: Sequence[float]
    colour: Sequence[float]
    points: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    colours: FloatArray = field(default_factory=lambda: np.zeros((0, 4)))
    position: Any = (0.0, 0.0, 0.0)
    orientation: Any = (0.0, 0.0, 0.0, 1.0)
    number: int = 0


def gear_markers(picture: GearPicture, frame: str = MAP) -> TopicMessage:
    """Draw the gear in a frame, as a message that is encoded already.

    A rope becomes a line, all netting one marker, a door a box, a school of fish an ellipsoid. The
    ship's waterline lies ahead of the towing blocks.

    Lines of one name become one marker: viewers draw two thousand points easily, but not a thousand
    markers. ``picture.door_size`` is (length along the door's x, height along its z), m.
    """
    named: dict[str, list[Polyline]] = {}
    for line in picture.lines:
        named.setdefault(line.name, []).append(line)
    markers = [
        _line(lines[0]) if len(lines) == 1 else _lines(name, lines) for name, lines in named.items()
    ]
    length, height = picture.door_size
    for side, door in zip(SIDES, picture.doors, strict=True):
        size = (length, THICKNESS * length, height)
        markers.append(
            _Marker(
                DOOR_FRAMES[side], _Kind.CUBE, size, _STEEL,
                position=door.position, orientation=door.orientation,
            )
        )  # fmt: skip
    markers += _hull(named)
    markers += [_school(number, school) for number, school in enumerate(picture.schools)]
    writer = CdrWriter()
    writer.numbers('I', len(markers))
    for marker in markers:
        _write(writer, picture.stamp, frame, marker)
    return 'truth/gear', Encoded('visualization_msgs/msg/MarkerArray', writer.data())


def tension_colours(tensions: FloatArray) -> FloatArray:
    """Colour tensions (n,) (N) from blue (slack) over green and yellow to red (`FULL_SCALE`).

    Returns red, green, blue and opacity, shape (n, 4).
    """
    places = np.clip(tensions / FULL_SCALE, 0.0, 1.0) * (len(RAMP) - 1)
    channels = [np.interp(places, np.arange(len(RAMP)), channel) for channel in RAMP.T]
    return np.column_stack([*channels, np.ones(len(tensions))])


def _line(line: Polyline) -> _Marker:
    (colour,) = tension_colours(np.array([line.tension])).tolist()
    width = (LINE_WIDTH, 0.0, 0.0)
    return _Marker(line.name, _Kind.LINE_STRIP, width, colour, line.points)


def _lines(name: str, lines: Sequence[Polyline]) -> _Marker:
    """Line-list marker of several lines; each pair of points has a colour at both ends."""
    sizes = np.array([len(line.points) for line in lines])
    every = np.concatenate([line.points for line in lines])
    # Each point but the last of a line begins a pair.
    begins = np.delete(np.arange(len(every)), np.cumsum(sizes) - 1)
    pairs = every[np.column_stack([begins, begins + 1]).ravel()]
    colours = tension_colours(np.array([line.tension for line in lines]))
    each = np.repeat(colours, 2 * (sizes - 1), axis=0)
    return _Marker(name, _Kind.LINE_LIST, (LINE_WIDTH, 0.0, 0.0), _STEEL, pairs, each)


def _school(number: int, school: SchoolTruth) -> _Marker:
    return _Marker(
        'schools',
        _Kind.SPHERE,
        school.size.tolist(),
        _FISH,
        position=school.position,
        number=number,
    )


def _hull(named: Mapping[str, Sequence[Polyline]]) -> list[_Marker]:
    """Waterline of the ship; empty without both warps, whose ends give the ship's position."""
    if not all(name in named for name in WINCH_NAMES):
        return []
    port, starboard = (named[name][0].points[0] for name in WINCH_NAMES)
    across = 0.5 * (port - starboard)
    ahead = np.array([across[1], -across[0], 0.0]) / np.hypot(*across[:2])
    outline = (
        0.5 * (port + starboard)
        + VESSEL_LENGTH * _HULL[:, :1] * ahead
        + _BEAM_PER_BLOCKS * _HULL[:, 1:] * across
    )
    closed = np.vstack([outline, outline[:1]])
    return [_Marker(VESSEL, _Kind.LINE_STRIP, (LINE_WIDTH, 0.0, 0.0), _STEEL, closed)]


def _write(writer: CdrWriter, stamp: int, frame: str, marker: _Marker) -> None:
    """Write a ``visualization_msgs/Marker``, its fields in order."""
    writer.numbers('iI', *divmod(int(stamp), SECOND))
    writer.text(frame)
    writer.text(marker.namespace)
    writer.numbers('3i', marker.number, marker.kind, _Kind.ADD)
    writer.numbers('7d', *marker.position, *marker.orientation)
    writer.numbers('3d', *marker.scale)
    writer.numbers('4f', *marker.colour)
    writer.numbers('iI', 0, 0)  # lifetime
    writer.numbers('?', False)  # frame_locked
    writer.rows(marker.points.astype('<f8'))
    writer.rows(marker.colours.astype('<f4'))
    writer.text('')  # texture_resource
    writer.numbers('iI', 0, 0)  # texture: stamp, frame, format, data
    writer.text('')
    writer.text('')
    writer.rows(_NO_BYTES)
    writer.rows(_NO_BYTES)  # uv_coordinates
    writer.text('')  # text
    writer.text('')  # mesh_resource
    writer.text('')  # mesh_file: name, data
    writer.rows(_NO_BYTES)
    writer.numbers('?', False)  # mesh_use_embedded_materials
