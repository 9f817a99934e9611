# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reading and writing of parts of messages: vectors, poses, covariances and winches.

Covariances hold the *stated* noise. `UNKNOWN_VARIANCE` marks a component of an orientation or
position that the sensor does not measure, and `ABSENT` a quantity that it does not have.
"""

import math
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import MessageError
from trawl_ros.core.rotations import to_angles, to_quaternion
from trawl_ros.messages.stamps import header
from trawl_ros.records.topics import TOPICS, WINCH_NAMES

TopicMessage = tuple[str, Any]

ANGLES = ('roll', 'pitch', 'yaw')
"""Angles of an orientation, in order."""

_IN_ORDER = list(WINCH_NAMES)

UNKNOWN_VARIANCE = 1e6
"""Variance (rad² or m²) so large that consumers treat the component as not measured."""

ABSENT = -1.0
"""First element of an Imu covariance if the sensor does not have the quantity."""


def topic_header(stamp: int, topic: str) -> ros.std_msgs__msg__Header:
    """Return the header of a topic at a stamp (ns)."""
    return header(stamp, TOPICS[topic].frame)


def vector(values: Any) -> ros.geometry_msgs__msg__Vector3:
    """Return a Vector3 of three numbers."""
    x, y, z = values
    return ros.geometry_msgs__msg__Vector3(float(x), float(y), float(z))


def pose(position: Any, orientation: Any) -> ros.geometry_msgs__msg__Pose:
    """Return a Pose of a position (3,) and a quaternion (x, y, z, w)."""
    x, y, z = map(float, position)
    return ros.geometry_msgs__msg__Pose(
        ros.geometry_msgs__msg__Point(x, y, z),
        ros.geometry_msgs__msg__Quaternion(*map(float, orientation)),
    )


def with_covariance(pose: Any, std: float) -> ros.geometry_msgs__msg__PoseWithCovariance:
    """Return a pose with one standard deviation (m and rad); 0 is not known."""
    return ros.geometry_msgs__msg__PoseWithCovariance(pose, _even_covariance(std))


def twist(linear: Any, angular: Any) -> ros.geometry_msgs__msg__Twist:
    """Return a Twist of linear (m/s) and angular (rad/s) velocity."""
    return ros.geometry_msgs__msg__Twist(vector(linear), vector(angular))


def twist_with_covariance(
    linear: Any, angular: Any, std: float
) -> ros.geometry_msgs__msg__TwistWithCovariance:
    """Return a twist with one standard deviation (m/s and rad/s); 0 is not known."""
    covariance = _even_covariance(std)
    return ros.geometry_msgs__msg__TwistWithCovariance(twist(linear, angular), covariance)


def _even_covariance(std: float) -> FloatArray:
    """Return the covariance (36,) of six components with the same standard deviation."""
    covariance: FloatArray = (std**2 * np.eye(6)).ravel()
    return covariance


def joint_state(
    stamp: int, topic: str, positions: Any, velocities: Any, efforts: Any
) -> ros.sensor_msgs__msg__JointState:
    """Return the joint state of both winches, port first."""
    columns = (np.array(column, dtype=float) for column in (positions, velocities, efforts))
    return ros.sensor_msgs__msg__JointState(topic_header(stamp, topic), list(WINCH_NAMES), *columns)


def imu(
    stamp: int,
    topic: str,
    angles: tuple[float, float, float],
    variances: tuple[float, float, float],
) -> ros.sensor_msgs__msg__Imu:
    """Return an Imu with orientation only: roll, pitch, yaw (rad) and their variances."""
    absent = np.zeros(9)
    absent[0] = ABSENT
    return ros.sensor_msgs__msg__Imu(
        header=topic_header(stamp, topic),
        orientation=ros.geometry_msgs__msg__Quaternion(*to_quaternion(*angles)),
        orientation_covariance=np.diag(variances).ravel(),
        angular_velocity=vector((0.0, 0.0, 0.0)),
        angular_velocity_covariance=absent,
        linear_acceleration=vector((0.0, 0.0, 0.0)),
        linear_acceleration_covariance=absent.copy(),
    )


def joint_column(topic: str, joint_state: Any, field: str) -> dict[str, float]:
    """Read one field of a JointState by joint name; an empty field gives NaN.

    Raises
    ------
    MessageError
        If names repeat, or the field has neither as many entries as there are names nor none.
    """
    names, values = list(joint_state.name), getattr(joint_state, field)
    if len(set(names)) != len(names):
        raise MessageError(f'{topic}: names {names} repeat; expected each joint once')
    if len(values) not in (0, len(names)):
        raise MessageError(
            f'{topic}: {field} has {len(values)} entries for {len(names)} names; '
            'expected as many as names, or none'
        )
    if len(values) == 0:
        return dict.fromkeys(names, math.nan)
    return {name: float(value) for name, value in zip(names, values, strict=True)}


def winch_columns(topic: str, message: Any) -> list[tuple[float, float]]:
    """Read lengths, speeds and tensions, each of port and starboard, from a JointState."""
    read = (message.position, message.velocity, message.effort)
    if message.name == _IN_ORDER and all(len(values) == len(_IN_ORDER) for values in read):
        # As nearly all are: a tow has thousands of them.
        return [(float(port), float(starboard)) for port, starboard in read]
    missing = [name for name in WINCH_NAMES if name not in message.name]
    if missing:
        raise MessageError(
            f'{topic}: no {" and no ".join(missing)} among names {list(message.name)}; '
            f'expected {" and ".join(WINCH_NAMES)}'
        )
    port, starboard = WINCH_NAMES
    columns = (joint_column(topic, message, field) for field in ('position', 'velocity', 'effort'))
    return [(column[port], column[starboard]) for column in columns]


def read_vector(message: Any) -> FloatArray:
    """Read a Vector3 or Point as an array (3,)."""
    return np.array([message.x, message.y, message.z], dtype=float)


def read_orientation(topic: str, message: Any) -> FloatArray:
    """Read a Quaternion as an array (x, y, z, w).

    Raises
    ------
    MessageError
        If it is no rotation.
    """
    read_angles(topic, message)
    return np.array([message.x, message.y, message.z, message.w], dtype=float)


def read_angles(topic: str, message: Any) -> tuple[float, float, float]:
    """Read a Quaternion as roll, pitch and yaw (rad).

    Raises
    ------
    MessageError
        If it is no rotation.
    """
    try:
        return to_angles((message.x, message.y, message.z, message.w))
    except ValueError as error:
        raise MessageError(f'{topic}: {error}') from error
