"""Transforms of ship, doors and sonar to ``map``, for tools that read a frame tree."""

from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.messages.pieces import TopicMessage, vector
from trawl_ros.messages.rotations import to_quaternion
from trawl_ros.messages.stamps import header
from trawl_ros.messages.topics import DOOR_FRAMES, MAP, SONAR, TRANSFORMS, VESSEL
from trawl_ros.simulation.truth import SIDES, Truth


def transforms_message(truth: Truth) -> TopicMessage:
    """Return the poses of all frames in ``map`` at one instant."""
    poses: dict[str, tuple[np.ndarray, Any]] = {
        VESSEL: (truth.vessel.position, to_quaternion(0.0, 0.0, truth.vessel.heading)),
        SONAR: (truth.net.sonar_position, truth.net.sonar_orientation),
    }
    for side, door in zip(SIDES, truth.doors, strict=True):
        poses[DOOR_FRAMES[side]] = (door.position, door.orientation)
    return TRANSFORMS.name, ros.tf2_msgs__msg__TFMessage(
        [_transform(truth.stamp, frame, *pose) for frame, pose in poses.items()]
    )


def _transform(stamp: int, frame: str, position: np.ndarray, orientation: Any) -> Any:
    return ros.geometry_msgs__msg__TransformStamped(
        header(stamp, MAP),
        frame,
        ros.geometry_msgs__msg__Transform(
            vector(position), ros.geometry_msgs__msg__Quaternion(*map(float, orientation))
        ),
    )
