"""Markers of gear and ship for RViz and Foxglove: ropes coloured by tension, doors as plates.

Namespace and id of a marker stay the same in every message, so that viewers replace the earlier
marker instead of adding another.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.arrays import FloatArray
from trawl_ros.messages.pieces import TopicMessage
from trawl_ros.messages.stamps import header
from trawl_ros.records.topics import DOOR_FRAMES, MAP, VESSEL, WINCH_NAMES
from trawl_ros.records.truth import SIDES, DoorTruth, GearPicture, Polyline, SchoolTruth

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

_STEEL = ros.std_msgs__msg__ColorRGBA(0.45, 0.45, 0.50, 1.0)
_FISH = ros.std_msgs__msg__ColorRGBA(0.95, 0.65, 0.40, 0.5)


def gear_markers(picture: GearPicture) -> TopicMessage:
    """Draw the gear in the frame ``map``.

    A rope becomes a line, all netting one marker, a door a box, a school of fish an ellipsoid. The
    ship's waterline lies ahead of the towing blocks.

    Lines of one name become one marker: viewers draw two thousand points easily, but not a thousand
    markers. ``picture.door_size`` is (length along the door's x, height along its z), m.
    """
    named: dict[str, list[Polyline]] = {}
    for line in picture.lines:
        named.setdefault(line.name, []).append(line)
    markers = [
        _line(picture.stamp, lines[0]) if len(lines) == 1 else _lines(picture.stamp, name, lines)
        for name, lines in named.items()
    ]
    for side, door in zip(SIDES, picture.doors, strict=True):
        markers.append(_door(picture.stamp, side, door, picture.door_size))
    markers += _hull(picture.stamp, named)
    markers += [_school(picture.stamp, k, school) for k, school in enumerate(picture.schools)]
    return 'truth/gear', ros.visualization_msgs__msg__MarkerArray(markers)


def tension_colour(tension: float) -> ros.std_msgs__msg__ColorRGBA:
    """Colour a tension (N) from blue (slack) over green and yellow to red (`FULL_SCALE`)."""
    return _colours(np.array([tension]))[0]


def _colours(tensions: FloatArray) -> list[ros.std_msgs__msg__ColorRGBA]:
    places = np.clip(tensions / FULL_SCALE, 0.0, 1.0) * (len(RAMP) - 1)
    channels = [np.interp(places, np.arange(len(RAMP)), channel).tolist() for channel in RAMP.T]
    return [
        ros.std_msgs__msg__ColorRGBA(red, green, blue, 1.0)
        for red, green, blue in zip(*channels, strict=True)
    ]


def _points(points: FloatArray) -> list[ros.geometry_msgs__msg__Point]:
    return [ros.geometry_msgs__msg__Point(*point) for point in points.tolist()]


def _line(stamp: int, line: Polyline) -> Any:
    return _marker(
        stamp,
        line.name,
        ros.visualization_msgs__msg__Marker.LINE_STRIP,
        scale=(LINE_WIDTH, 0.0, 0.0),
        colour=tension_colour(line.tension),
        points=_points(line.points),
    )


def _lines(stamp: int, name: str, lines: Sequence[Polyline]) -> Any:
    """Line-list marker of several lines; each pair of points has a colour at both ends."""
    sizes = np.array([len(line.points) for line in lines])
    every = np.concatenate([line.points for line in lines])
    # Each point but the last of a line begins a pair.
    begins = np.delete(np.arange(len(every)), np.cumsum(sizes) - 1)
    pairs = every[np.column_stack([begins, begins + 1]).ravel()]
    colours = _colours(np.array([line.tension for line in lines]))
    marker = _marker(
        stamp,
        name,
        ros.visualization_msgs__msg__Marker.LINE_LIST,
        scale=(LINE_WIDTH, 0.0, 0.0),
        colour=_STEEL,
        points=_points(pairs),
    )
    marker.colors = [
        colour
        for size, colour in zip(sizes.tolist(), colours, strict=True)
        for _ in range(2 * (size - 1))
    ]
    return marker


def _door(stamp: int, side: str, door: DoorTruth, size: tuple[float, float]) -> Any:
    length, height = size
    return _marker(
        stamp,
        DOOR_FRAMES[side],
        ros.visualization_msgs__msg__Marker.CUBE,
        scale=(length, THICKNESS * length, height),
        colour=_STEEL,
        position=door.position,
        orientation=door.orientation,
    )


def _school(stamp: int, number: int, school: SchoolTruth) -> Any:
    marker = _marker(
        stamp,
        'schools',
        ros.visualization_msgs__msg__Marker.SPHERE,
        scale=school.size,
        colour=_FISH,
        position=school.position,
    )
    marker.id = number
    return marker


def _hull(stamp: int, named: Mapping[str, Sequence[Polyline]]) -> list[Any]:
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
    return [
        _marker(
            stamp,
            VESSEL,
            ros.visualization_msgs__msg__Marker.LINE_STRIP,
            scale=(LINE_WIDTH, 0.0, 0.0),
            colour=_STEEL,
            points=_points(np.vstack([outline, outline[:1]])),
        )
    ]


def _marker(
    stamp: int,
    namespace: str,
    kind: int,
    *,
    scale: Any,
    colour: ros.std_msgs__msg__ColorRGBA,
    points: Sequence[ros.geometry_msgs__msg__Point] = (),
    position: Any = (0.0, 0.0, 0.0),
    orientation: Any = (0.0, 0.0, 0.0, 1.0),
) -> ros.visualization_msgs__msg__Marker:
    no_stamp = header(0, '')
    return ros.visualization_msgs__msg__Marker(
        header=header(stamp, MAP),
        ns=namespace,
        id=0,
        type=kind,
        action=ros.visualization_msgs__msg__Marker.ADD,
        pose=ros.geometry_msgs__msg__Pose(
            ros.geometry_msgs__msg__Point(*map(float, position)),
            ros.geometry_msgs__msg__Quaternion(*map(float, orientation)),
        ),
        scale=ros.geometry_msgs__msg__Vector3(*map(float, scale)),
        color=colour,
        lifetime=ros.builtin_interfaces__msg__Duration(0, 0),
        frame_locked=False,
        points=list(points),
        colors=[],
        texture_resource='',
        texture=ros.sensor_msgs__msg__CompressedImage(no_stamp, '', np.zeros(0, np.uint8)),
        uv_coordinates=[],
        text='',
        mesh_resource='',
        mesh_file=ros.visualization_msgs__msg__MeshFile('', np.zeros(0, np.uint8)),
        mesh_use_embedded_materials=False,
    )
