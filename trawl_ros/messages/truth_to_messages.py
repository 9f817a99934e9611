# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion of truth into messages, each as (relative topic name, message)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.rotations import about_z, to_quaternion
from trawl_ros.messages import pieces
from trawl_ros.messages.pieces import TopicMessage
from trawl_ros.messages.point_clouds import point_cloud
from trawl_ros.messages.stamps import to_time
from trawl_ros.records.observables import OBSERVABLES, Observables
from trawl_ros.records.topics import DOOR_FRAMES, VESSEL
from trawl_ros.records.truth import (
    SIDES,
    DoorTruth,
    NetTruth,
    SchoolTruth,
    Truth,
    VesselTruth,
    WinchTruth,
)

SCHOOL_FIELDS = ('x', 'y', 'z', 'length', 'width', 'height', 'density')
"""Fields of each school in ``truth/schools``."""


def clock_message(stamp: int) -> TopicMessage:
    """Convert a stamp (ns) into simulated time on ``/clock``."""
    return '/clock', ros.rosgraph_msgs__msg__Clock(to_time(stamp))


def truth_messages(truth: Truth, odometry_std: float = 0.0) -> list[TopicMessage]:
    """Convert the truth of one instant into messages on all truth topics except the markers.

    Odometry states ``odometry_std`` (m, rad, m/s, rad/s) as its noise; 0 states none.
    """
    messages: list[TopicMessage] = []
    for side, door in zip(SIDES, truth.doors, strict=True):
        messages += _door(truth.stamp, side, door, odometry_std)
    messages += _net(truth.stamp, truth.net)
    messages.append(_winches(truth.stamp, truth.winches))
    messages += _vessel(truth.stamp, truth.vessel, odometry_std)
    messages.append(_schools(truth.stamp, truth.schools))
    depths = (truth.seabed.under_ship, truth.seabed.under_headrope, 0.0)
    messages.append(_vector(truth.stamp, 'truth/seabed', depths))
    if truth.observables is not None:
        messages.append(_observables(truth.stamp, truth.observables))
    return messages


def _stamped(stamp: int, topic: str, kind: Any, *content: Any) -> TopicMessage:
    """Return the message of a topic: its header, then the content."""
    return topic, kind(pieces.topic_header(stamp, topic), *content)


def _vector(stamp: int, topic: str, values: Any) -> TopicMessage:
    return _stamped(stamp, topic, ros.geometry_msgs__msg__Vector3Stamped, pieces.vector(values))


def _cloud(stamp: int, topic: str, columns: Mapping[str, FloatArray]) -> TopicMessage:
    return topic, point_cloud(pieces.topic_header(stamp, topic), columns)


def _door(stamp: int, side: str, door: DoorTruth, std: float) -> list[TopicMessage]:
    topic = f'truth/door/{side}'
    pose = pieces.with_covariance(pieces.pose(door.position, door.orientation), std)
    twist = pieces.twist_with_covariance(door.velocity, door.angular_velocity, std)
    wrench = ros.geometry_msgs__msg__Wrench(pieces.vector(door.force), pieces.vector(door.moment))
    odometry = ros.nav_msgs__msg__Odometry
    return [
        _stamped(stamp, f'{topic}/odom', odometry, DOOR_FRAMES[side], pose, twist),
        _vector(stamp, f'{topic}/angles', (door.attack, door.slip, door.inclination)),
        _stamped(stamp, f'{topic}/wrench', ros.geometry_msgs__msg__WrenchStamped, wrench),
    ]


def _net(stamp: int, net: NetTruth) -> list[TopicMessage]:
    x, y, diameters = net.section.T
    corners = [ros.geometry_msgs__msg__Point32(*map(float, point)) for point in net.mouth]
    mouth = ros.geometry_msgs__msg__Polygon(corners)
    openings = (net.horizontal_opening, net.vertical_opening, net.headrope_depth)
    pose = pieces.pose(net.sonar_position, net.sonar_orientation)
    section = {'x': x, 'y': y, 'z': 0.0 * x, 'diameter': diameters}
    return [
        _stamped(stamp, 'truth/net/mouth', ros.geometry_msgs__msg__PolygonStamped, mouth),
        _vector(stamp, 'truth/net/opening', openings),
        _stamped(stamp, 'truth/sonar/pose', ros.geometry_msgs__msg__PoseStamped, pose),
        _cloud(stamp, 'truth/sonar/section', section),
        _vector(stamp, 'truth/sonar/opening', (net.section_height, net.section_width, 0.0)),
    ]


def _winches(stamp: int, winches: tuple[WinchTruth, WinchTruth]) -> TopicMessage:
    topic = 'truth/winch'
    columns = zip(*((winch.length, winch.speed, winch.tension) for winch in winches), strict=True)
    return topic, pieces.joint_state(stamp, topic, *columns)


def _vessel(stamp: int, vessel: VesselTruth, std: float) -> list[TopicMessage]:
    turning = (0.0, 0.0, vessel.yaw_rate)
    over_ground = about_z(vessel.heading).T @ vessel.velocity_ground
    pose = pieces.pose(vessel.position, to_quaternion(0.0, 0.0, vessel.heading))
    odometry = (
        VESSEL,
        pieces.with_covariance(pose, std),
        pieces.twist_with_covariance(over_ground, turning, std),
    )
    through_water = pieces.twist(vessel.velocity_water, turning)
    twist = ros.geometry_msgs__msg__TwistStamped
    return [
        _stamped(stamp, 'truth/vessel/odom', ros.nav_msgs__msg__Odometry, *odometry),
        _stamped(stamp, 'truth/vessel/velocity_water', twist, through_water),
    ]


def _schools(stamp: int, schools: tuple[SchoolTruth, ...]) -> TopicMessage:
    rows = [[*school.position, *school.size, school.density] for school in schools]
    columns = np.array(rows, dtype=float).reshape(-1, len(SCHOOL_FIELDS)).T
    return _cloud(stamp, 'truth/schools', dict(zip(SCHOOL_FIELDS, columns, strict=True)))


def _observables(stamp: int, observables: Observables) -> TopicMessage:
    content = list(OBSERVABLES), observables.array(), np.zeros(0), np.zeros(0)
    return _stamped(stamp, 'truth/observables', ros.sensor_msgs__msg__JointState, *content)
