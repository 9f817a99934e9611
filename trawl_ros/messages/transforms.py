# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Transforms between frames, and the frames of messages under the names that a user gives."""

from collections.abc import Iterable, Mapping
from typing import Any

from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.rotations import to_quaternion
from trawl_ros.messages.pieces import TopicMessage, vector
from trawl_ros.messages.stamps import header
from trawl_ros.records.frames import Mount
from trawl_ros.records.topics import (
    DOOR_FRAMES,
    MAP,
    ODOM,
    SONAR,
    STATIC_TRANSFORMS,
    TRANSFORMS,
    VESSEL,
)
from trawl_ros.records.truth import SIDES, Truth


def transforms_message(truth: Truth, *, ship: bool = True, odom: bool = False) -> TopicMessage:
    """Return the poses of all frames in ``map`` at one instant.

    The ship's is in frame ``odom`` where that is wanted, or left out without ``ship``.
    """
    vessel = (truth.vessel.position, to_quaternion(0.0, 0.0, truth.vessel.heading))
    poses = {SONAR: (truth.net.sonar_position, truth.net.sonar_orientation)}
    for side, door in zip(SIDES, truth.doors, strict=True):
        poses[DOOR_FRAMES[side]] = (door.position, door.orientation)
    return TRANSFORMS.name, ros.tf2_msgs__msg__TFMessage(
        [
            *(_ship(truth.stamp, *vessel, odom=odom) if ship else ()),
            *(_transform(truth.stamp, MAP, frame, *pose) for frame, pose in poses.items()),
        ]
    )


def ship_transform(stamp: int, position: Any, heading: float, *, odom: bool) -> TopicMessage:
    """Return the ship's pose in ``map`` from her position (3,), m, and heading (ENU yaw, rad)."""
    turned = to_quaternion(0.0, 0.0, heading)
    return TRANSFORMS.name, ros.tf2_msgs__msg__TFMessage(_ship(stamp, position, turned, odom=odom))


def mounts_message(stamp: int, mounts: Iterable[Mount]) -> TopicMessage:
    """Return the frames of sensors in those that they are fixed to."""
    return STATIC_TRANSFORMS.name, ros.tf2_msgs__msg__TFMessage(
        [
            _transform(
                stamp, mount.parent, mount.frame, mount.position, to_quaternion(*mount.angles)
            )
            for mount in mounts
        ]
    )


def rename_frames(message: Any, names: Mapping[str, str]) -> None:
    """Replace the frames of a message, and of the transforms and markers in it, by other names."""
    if hasattr(message, 'header'):
        message.header.frame_id = names.get(message.header.frame_id, message.header.frame_id)
    if hasattr(message, 'child_frame_id'):
        message.child_frame_id = names.get(message.child_frame_id, message.child_frame_id)
    for part in (*getattr(message, 'transforms', ()), *getattr(message, 'markers', ())):
        rename_frames(part, names)


def _ship(stamp: int, position: Any, orientation: Any, *, odom: bool) -> list[Any]:
    # The truth does not drift, so odom stays in map.
    still = _transform(stamp, MAP, ODOM, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    parent = ODOM if odom else MAP
    ship = _transform(stamp, parent, VESSEL, position, orientation)
    return [still, ship] if odom else [ship]


def _transform(stamp: int, parent: str, frame: str, position: Any, orientation: Any) -> Any:
    return ros.geometry_msgs__msg__TransformStamped(
        header(stamp, parent),
        frame,
        ros.geometry_msgs__msg__Transform(
            vector(position), ros.geometry_msgs__msg__Quaternion(*map(float, orientation))
        ),
    )
