# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion of truth into messages, each as (relative topic name, message)."""

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.messages import pieces
from trawl_ros.messages.pieces import TopicMessage
from trawl_ros.messages.point_clouds import point_cloud
from trawl_ros.messages.rotations import about_z, to_quaternion
from trawl_ros.messages.stamps import to_time
from trawl_ros.records.observables import OBSERVABLES, Observables
from trawl_ros.records.topics import DOOR_FRAMES, VESSEL
from trawl_ros.records.truth import (
    SIDES,
    DoorTruth,
    NetTruth,
    SchoolTruth,
    SeabedTruth,
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
    messages.append(_seabed(truth.stamp, truth.seabed))
    if truth.observables is not None:
        messages.append(_observables(truth.stamp, truth.observables))
    return messages


def _door(stamp: int, side: str, door: DoorTruth, std: float) -> list[TopicMessage]:
    frame = DOOR_FRAMES[side]
    odometry, angles, wrench = (
        f'truth/door/{side}/{what}' for what in ('odom', 'angles', 'wrench')
    )
    return [
        (
            odometry,
            ros.nav_msgs__msg__Odometry(
                pieces.topic_header(stamp, odometry),
                frame,
                pieces.with_covariance(pieces.pose(door.position, door.orientation), std),
                pieces.twist_with_covariance(door.velocity, door.angular_velocity, std),
            ),
        ),
        (
            angles,
            ros.geometry_msgs__msg__Vector3Stamped(
                pieces.topic_header(stamp, angles),
                pieces.vector((door.attack, door.slip, door.inclination)),
            ),
        ),
        (
            wrench,
            ros.geometry_msgs__msg__WrenchStamped(
                pieces.topic_header(stamp, wrench),
                ros.geometry_msgs__msg__Wrench(
                    pieces.vector(door.force), pieces.vector(door.moment)
                ),
            ),
        ),
    ]


def _net(stamp: int, net: NetTruth) -> list[TopicMessage]:
    mouth, opening, pose = 'truth/net/mouth', 'truth/net/opening', 'truth/sonar/pose'
    section, seen = 'truth/sonar/section', 'truth/sonar/opening'
    x, y, diameters = net.section.T
    corners = [ros.geometry_msgs__msg__Point32(*map(float, point)) for point in net.mouth]
    openings = (net.horizontal_opening, net.vertical_opening, net.headrope_depth)
    return [
        (
            mouth,
            ros.geometry_msgs__msg__PolygonStamped(
                pieces.topic_header(stamp, mouth), ros.geometry_msgs__msg__Polygon(corners)
            ),
        ),
        (
            opening,
            ros.geometry_msgs__msg__Vector3Stamped(
                pieces.topic_header(stamp, opening), pieces.vector(openings)
            ),
        ),
        (
            pose,
            ros.geometry_msgs__msg__PoseStamped(
                pieces.topic_header(stamp, pose),
                pieces.pose(net.sonar_position, net.sonar_orientation),
            ),
        ),
        (
            section,
            point_cloud(
                pieces.topic_header(stamp, section),
                {'x': x, 'y': y, 'z': 0.0 * x, 'diameter': diameters},
            ),
        ),
        (
            seen,
            ros.geometry_msgs__msg__Vector3Stamped(
                pieces.topic_header(stamp, seen),
                pieces.vector((net.section_height, net.section_width, 0.0)),
            ),
        ),
    ]


def _winches(stamp: int, winches: tuple[WinchTruth, WinchTruth]) -> TopicMessage:
    topic = 'truth/winch'
    columns = zip(*((winch.length, winch.speed, winch.tension) for winch in winches), strict=True)
    return topic, pieces.joint_state(stamp, topic, *columns)


def _vessel(stamp: int, vessel: VesselTruth, std: float) -> list[TopicMessage]:
    odometry, through_water = 'truth/vessel/odom', 'truth/vessel/velocity_water'
    turning = (0.0, 0.0, vessel.yaw_rate)
    over_ground = about_z(vessel.heading).T @ vessel.velocity_ground
    pose = pieces.pose(vessel.position, to_quaternion(0.0, 0.0, vessel.heading))
    return [
        (
            odometry,
            ros.nav_msgs__msg__Odometry(
                pieces.topic_header(stamp, odometry),
                VESSEL,
                pieces.with_covariance(pose, std),
                pieces.twist_with_covariance(over_ground, turning, std),
            ),
        ),
        (
            through_water,
            ros.geometry_msgs__msg__TwistStamped(
                pieces.topic_header(stamp, through_water),
                pieces.twist(vessel.velocity_water, turning),
            ),
        ),
    ]


def _schools(stamp: int, schools: tuple[SchoolTruth, ...]) -> TopicMessage:
    topic = 'truth/schools'
    rows = [[*school.position, *school.size, school.density] for school in schools]
    columns = np.array(rows, dtype=float).reshape(-1, len(SCHOOL_FIELDS)).T
    return topic, point_cloud(
        pieces.topic_header(stamp, topic), dict(zip(SCHOOL_FIELDS, columns, strict=True))
    )


def _seabed(stamp: int, seabed: SeabedTruth) -> TopicMessage:
    topic = 'truth/seabed'
    depths = pieces.vector((seabed.under_ship, seabed.under_headrope, 0.0))
    return topic, ros.geometry_msgs__msg__Vector3Stamped(pieces.topic_header(stamp, topic), depths)


def _observables(stamp: int, observables: Observables) -> TopicMessage:
    topic = 'truth/observables'
    return topic, ros.sensor_msgs__msg__JointState(
        pieces.topic_header(stamp, topic),
        list(OBSERVABLES),
        observables.array(),
        np.zeros(0),
        np.zeros(0),
    )
