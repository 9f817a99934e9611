# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Decoding of messages into pieces of truth: the reverse of `truth_to_messages`."""

import math
from typing import Any

import numpy as np

from trawl_ros.core.rotations import about_z
from trawl_ros.messages.pieces import (
    joint_column,
    read_angles,
    read_orientation,
    read_vector,
    winch_columns,
)
from trawl_ros.messages.point_clouds import read_point_cloud
from trawl_ros.messages.truth_to_messages import SCHOOL_FIELDS
from trawl_ros.records.observables import OBSERVABLES, Observables
from trawl_ros.records.truth import (
    DoorTruth,
    NetTruth,
    SchoolTruth,
    SeabedTruth,
    VesselTruth,
    WinchTruth,
)


def door_truth(
    topic: str, odometry: Any, angles: Any | None = None, wrench: Any | None = None
) -> DoorTruth:
    """Build the truth of a door from its odometry and, if given, its angles and wrench.

    Values that are not given are NaN: a pressure sensor needs only the pose. ``topic`` is that of
    the odometry, for error messages.
    """
    missing = np.full(3, math.nan)
    pose, twist = odometry.pose.pose, odometry.twist.twist
    attack, slip, inclination = missing if angles is None else read_vector(angles.vector)
    return DoorTruth(
        position=read_vector(pose.position),
        orientation=read_orientation(topic, pose.orientation),
        velocity=read_vector(twist.linear),
        angular_velocity=read_vector(twist.angular),
        attack=float(attack),
        slip=float(slip),
        inclination=float(inclination),
        force=missing if wrench is None else read_vector(wrench.wrench.force),
        moment=missing if wrench is None else read_vector(wrench.wrench.torque),
    )


def winch_truth(topic: str, joint_state: Any) -> tuple[WinchTruth, WinchTruth]:
    """Read both winches (port first) from ``truth/winch``."""
    lengths, speeds, tensions = winch_columns(topic, joint_state)
    port, starboard = zip(lengths, speeds, tensions, strict=True)
    return WinchTruth(*port), WinchTruth(*starboard)


def net_truth(
    opening: Any, sonar_pose: Any, mouth: Any | None = None, section: Any | None = None
) -> NetTruth:
    """Build the truth of the net from opening, sonar pose and, if given, mouth and section.

    Without mouth or section their points have shape (0, 3).
    """
    through = np.zeros((0, 3))
    if section is not None:
        through = read_point_cloud('truth/sonar/section', section, ('x', 'y', 'diameter'))
    corners = [] if mouth is None else mouth.polygon.points
    horizontal, vertical, depth = read_vector(opening.vector)
    return NetTruth(
        mouth=np.array([read_vector(point) for point in corners]).reshape(-1, 3),
        horizontal_opening=float(horizontal),
        vertical_opening=float(vertical),
        headrope_depth=float(depth),
        sonar_position=read_vector(sonar_pose.pose.position),
        sonar_orientation=read_orientation('truth/sonar/pose', sonar_pose.pose.orientation),
        section=through,
    )


def schools_truth(cloud: Any) -> tuple[SchoolTruth, ...]:
    """Read the schools of fish from ``truth/schools``."""
    rows = read_point_cloud('truth/schools', cloud, SCHOOL_FIELDS)
    return tuple(SchoolTruth(row[:3], row[3:6], float(row[6])) for row in rows)


def seabed_truth(depths: Any) -> SeabedTruth:
    """Read the depth of the seabed from ``truth/seabed``."""
    under_ship, under_headrope, _ = read_vector(depths.vector)
    return SeabedTruth(float(under_ship), float(under_headrope))


def observables_truth(joint_state: Any) -> Observables:
    """Read the observables from ``truth/observables``; missing ones are NaN."""
    values = joint_column('truth/observables', joint_state, 'position')
    return Observables(**{name: values.get(name, math.nan) for name in OBSERVABLES})


def vessel_truth(odometry: Any, velocity_water: Any) -> VesselTruth:
    """Build the truth of the ship from its odometry and its velocity through the water."""
    pose, twist = odometry.pose.pose, odometry.twist.twist
    _, _, heading = read_angles('truth/vessel/odom', pose.orientation)
    return VesselTruth(
        position=read_vector(pose.position),
        heading=heading,
        yaw_rate=float(twist.angular.z),
        velocity_ground=about_z(heading) @ read_vector(twist.linear),
        velocity_water=read_vector(velocity_water.twist.linear),
    )
