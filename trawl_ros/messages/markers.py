"""The gear as markers, for RViz and Foxglove: ropes coloured by tension, doors as plates.

Namespace and id of a marker stay the same from picture to picture, so that viewers replace
the old one instead of piling them up.
"""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.messages.stamps import header
from trawl_ros.messages.to_messages import TopicMessage
from trawl_ros.messages.topics import DOOR_FRAMES, MAP
from trawl_ros.simulation.truth import SIDES, DoorTruth, GearPicture, Polyline

FULL_SCALE = 100e3
"""Tension (N) that is drawn in full red; fixed, so that colours compare between pictures."""

LINE_WIDTH = 0.3
"""m: thin beside a net's mouth, yet visible with 900 m of warp in view."""

THICKNESS = 0.1
"""Thickness of a door as drawn, as a part of its length."""

_RAMP = np.array([[0.15, 0.35, 0.85], [0.10, 0.75, 0.55], [0.95, 0.80, 0.15], [0.85, 0.10, 0.10]])
_STEEL = ros.std_msgs__msg__ColorRGBA(0.45, 0.45, 0.50, 1.0)


def gear_markers(picture: GearPicture) -> TopicMessage:
    """Draw the gear in ``map``: a line strip per rope or row of netting, a box per door.

    ``picture.door_size`` is (length along the door's x, height along its z), m.
    """
    seen: Counter[str] = Counter()
    markers = []
    for line in picture.lines:
        markers.append(_line(picture.stamp, line, seen[line.name]))
        seen[line.name] += 1
    for side, door in zip(SIDES, picture.doors, strict=True):
        markers.append(_door(picture.stamp, side, door, picture.door_size))
    return 'truth/gear', ros.visualization_msgs__msg__MarkerArray(markers)


def tension_colour(tension: float) -> ros.std_msgs__msg__ColorRGBA:
    """Colour a tension (N) from blue (slack) over green and yellow to red (`FULL_SCALE`)."""
    place = np.clip(tension / FULL_SCALE, 0.0, 1.0) * (len(_RAMP) - 1)
    red, green, blue = (
        float(np.interp(place, np.arange(len(_RAMP)), channel)) for channel in _RAMP.T
    )
    return ros.std_msgs__msg__ColorRGBA(red, green, blue, 1.0)


def _line(stamp: int, line: Polyline, number: int) -> Any:
    return _marker(
        stamp,
        line.name,
        number,
        ros.visualization_msgs__msg__Marker.LINE_STRIP,
        scale=(LINE_WIDTH, 0.0, 0.0),
        colour=tension_colour(line.tension),
        points=[ros.geometry_msgs__msg__Point(*map(float, point)) for point in line.points],
    )


def _door(stamp: int, side: str, door: DoorTruth, size: tuple[float, float]) -> Any:
    length, height = size
    return _marker(
        stamp,
        DOOR_FRAMES[side],
        0,
        ros.visualization_msgs__msg__Marker.CUBE,
        scale=(length, THICKNESS * length, height),
        colour=_STEEL,
        position=door.position,
        orientation=door.orientation,
    )


def _marker(
    stamp: int,
    namespace: str,
    number: int,
    kind: int,
    *,
    scale: tuple[float, float, float],
    colour: ros.std_msgs__msg__ColorRGBA,
    points: Sequence[ros.geometry_msgs__msg__Point] = (),
    position: Any = (0.0, 0.0, 0.0),
    orientation: Any = (0.0, 0.0, 0.0, 1.0),
) -> ros.visualization_msgs__msg__Marker:
    no_stamp = header(0, '')
    return ros.visualization_msgs__msg__Marker(
        header=header(stamp, MAP),
        ns=namespace,
        id=number,
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
