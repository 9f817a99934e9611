"""Decoding of messages into samples and pieces of truth: the reverse of `to_messages`.

Messages may come from bags of others, decoded with the definitions they carry, so only
attributes are relied on. Readings that say they are missing become NaN; content that
contradicts the topic raises `MessageError` naming it.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import MessageError
from trawl_ros.core.foreign import short
from trawl_ros.messages.pieces import ABSENT
from trawl_ros.messages.point_clouds import read_point_cloud
from trawl_ros.messages.rotations import about_z, to_angles
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.truth_to_messages import SCHOOL_FIELDS
from trawl_ros.records.samples import (
    AttitudeSample,
    FixSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    SchoolsSample,
    SonarImageSample,
    SonarPointsSample,
    SonarScanSample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.records.topics import RANGES, WINCH_NAMES
from trawl_ros.records.truth import (
    DoorTruth,
    NetTruth,
    SchoolTruth,
    SeabedTruth,
    VesselTruth,
    WinchTruth,
)


def to_sample(topic: str, message: Any) -> Sample:
    """Turn the message of an instrument topic (relative name) into a sample.

    Raises
    ------
    MessageError
        If the topic carries no sample, or the message contradicts the topic.
    """
    if topic not in _READERS:
        raise MessageError(
            f'{topic}: not a topic with samples; expected one of {", ".join(SAMPLE_TOPICS)}'
        )
    try:
        return _READERS[topic](topic, message)
    except MessageError:
        raise
    # Of another type, or of this one as somebody else defines it.
    except Exception as reason:
        kind = getattr(message, '__msgtype__', type(message).__name__)
        raise MessageError(
            f'{topic}: a {kind} without what its readings are taken from ({short(reason)})'
        ) from reason


def door_truth(
    topic: str, odometry: Any, angles: Any | None = None, wrench: Any | None = None
) -> DoorTruth:
    """Assemble a door from its odometry and, where given, its angles and wrench.

    What was not given is NaN: a pressure sensor needs no more than the pose. ``topic`` is
    the odometry's, for error messages.
    """
    missing = np.full(3, math.nan)
    pose, twist = odometry.pose.pose, odometry.twist.twist
    attack, slip, inclination = missing if angles is None else _vector(angles.vector)
    return DoorTruth(
        position=_vector(pose.position),
        orientation=_orientation(topic, pose.orientation),
        velocity=_vector(twist.linear),
        angular_velocity=_vector(twist.angular),
        attack=float(attack),
        slip=float(slip),
        inclination=float(inclination),
        force=missing if wrench is None else _vector(wrench.wrench.force),
        moment=missing if wrench is None else _vector(wrench.wrench.torque),
    )


def winch_truth(topic: str, joint_state: Any) -> tuple[WinchTruth, WinchTruth]:
    """Read both winches (port first) from ``truth/winch``."""
    lengths, speeds, tensions = _winch_columns(topic, joint_state)
    port, starboard = zip(lengths, speeds, tensions, strict=True)
    return WinchTruth(*port), WinchTruth(*starboard)


def net_truth(
    opening: Any, sonar_pose: Any, mouth: Any | None = None, section: Any | None = None
) -> NetTruth:
    """Assemble the net from its opening, the sonar's pose and, where given, mouth and section.

    Without them their points have shape (0, 3).
    """
    through = np.zeros((0, 3))
    if section is not None:
        through = read_point_cloud('truth/sonar/section', section, ('x', 'y', 'diameter'))
    corners = [] if mouth is None else mouth.polygon.points
    horizontal, vertical, depth = _vector(opening.vector)
    return NetTruth(
        mouth=np.array([_vector(point) for point in corners]).reshape(-1, 3),
        horizontal_opening=float(horizontal),
        vertical_opening=float(vertical),
        headrope_depth=float(depth),
        sonar_position=_vector(sonar_pose.pose.position),
        sonar_orientation=_orientation('truth/sonar/pose', sonar_pose.pose.orientation),
        section=through,
    )


def schools_truth(cloud: Any) -> tuple[SchoolTruth, ...]:
    """Read the schools of fish from ``truth/schools``."""
    rows = read_point_cloud('truth/schools', cloud, SCHOOL_FIELDS)
    return tuple(SchoolTruth(row[:3], row[3:6], float(row[6])) for row in rows)


def seabed_truth(depths: Any) -> SeabedTruth:
    """Read the depth of the seabed from ``truth/seabed``."""
    under_ship, under_headrope, _ = _vector(depths.vector)
    return SeabedTruth(float(under_ship), float(under_headrope))


def vessel_truth(odometry: Any, velocity_water: Any) -> VesselTruth:
    """Assemble the ship from its odometry and its velocity through the water."""
    pose, twist = odometry.pose.pose, odometry.twist.twist
    _, _, heading = _angles('truth/vessel/odom', pose.orientation)
    return VesselTruth(
        position=_vector(pose.position),
        heading=heading,
        yaw_rate=float(twist.angular.z),
        velocity_ground=about_z(heading) @ _vector(twist.linear),
        velocity_water=_vector(velocity_water.twist.linear),
    )


def joint_column(topic: str, joint_state: Any, field: str) -> dict[str, float]:
    """Read one field of a JointState by joint name; an empty field is a missing one (NaN).

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


def _winch_columns(topic: str, message: Any) -> list[tuple[float, float]]:
    missing = [name for name in WINCH_NAMES if name not in message.name]
    if missing:
        raise MessageError(
            f'{topic}: no {" and no ".join(missing)} among names {list(message.name)}; '
            f'expected {" and ".join(WINCH_NAMES)}'
        )
    port, starboard = WINCH_NAMES
    columns = (joint_column(topic, message, field) for field in ('position', 'velocity', 'effort'))
    return [(column[port], column[starboard]) for column in columns]


def _winch_sample(topic: str, message: Any) -> WinchSample:
    lengths, speeds, tensions = _winch_columns(topic, message)
    return WinchSample(stamp_of(message), lengths, speeds, tensions)


def _pressure(topic: str, message: Any) -> PressureSample:
    place = 'sonar' if topic == 'sonar/pressure' else topic.split('/')[1]
    std = _deviation(topic, message.variance)
    return PressureSample(stamp_of(message), place, float(message.fluid_pressure), std)


def _attitude(topic: str, message: Any) -> AttitudeSample:
    side = topic.split('/')[1]
    roll, pitch, _, std = _imu(topic, message, 0)
    return AttitudeSample(stamp_of(message), side, pitch, roll, std)


def _heading(topic: str, message: Any) -> HeadingSample:
    _, _, yaw, std = _imu(topic, message, 8)
    return HeadingSample(stamp_of(message), yaw, std)


def _imu(topic: str, message: Any, entry: int) -> tuple[float, float, float, float]:
    """Roll, pitch, yaw, and the standard deviation in one diagonal entry of the covariance."""
    if message.orientation_covariance[0] == ABSENT:
        return math.nan, math.nan, math.nan, math.nan
    std = _deviation(topic, message.orientation_covariance[entry])
    return *_angles(topic, message.orientation), std


def _range(topic: str, message: Any) -> RangeSample:
    # Range has had no variance before ROS 2 Iron; 0 stands for unknown in those that do.
    std = _deviation(topic, getattr(message, 'variance', 0.0))
    return RangeSample(
        stamp=stamp_of(message),
        what=_DISTANCES[topic],
        distance=float(message.range),
        std=std,
        min_range=float(message.min_range),
        max_range=float(message.max_range),
    )


def _sonar_image(topic: str, message: Any) -> SonarImageSample:
    beams, cells, step = int(message.height), int(message.width), int(message.step)
    data = np.asarray(message.data, dtype=np.uint8)
    if message.encoding != 'mono8' or step < cells or len(data) != beams * step:
        raise MessageError(
            f'{topic}: {len(data)} bytes of {message.encoding}, {beams} rows of {step} bytes; '
            'expected mono8 and as many bytes as rows have'
        )
    image = data.reshape(beams, step)[:, :cells]
    return SonarImageSample(stamp_of(message), image)


def _sonar_scan(topic: str, message: Any) -> SonarScanSample:
    return SonarScanSample(
        stamp=stamp_of(message),
        ranges=np.asarray(message.ranges, dtype=float),
        intensities=np.asarray(message.intensities, dtype=float),
        angle_min=float(message.angle_min),
        angle_increment=float(message.angle_increment),
        min_range=float(message.range_min),
        max_range=float(message.range_max),
        sweep_s=float(message.scan_time),
    )


def _sonar_points(topic: str, message: Any) -> SonarPointsSample:
    points = read_point_cloud(topic, message, ('x', 'y', 'z', 'intensity'))
    return SonarPointsSample(stamp_of(message), points)


def _seen_schools(topic: str, message: Any) -> SchoolsSample:
    positions = [_vector(pose.position) for pose in message.poses]
    return SchoolsSample(stamp_of(message), np.array(positions).reshape(-1, 3))


def _velocity(topic: str, message: Any) -> VelocitySample:
    over = topic.removeprefix('vessel/velocity_')
    twist = message.twist
    return VelocitySample(stamp_of(message), over, _vector(twist.linear), float(twist.angular.z))


def _fix(topic: str, message: Any) -> FixSample:
    if message.status.status < 0:
        return FixSample(stamp_of(message), math.nan, math.nan, math.nan)
    if not (abs(message.latitude) <= 90.0 and abs(message.longitude) <= 360.0):
        raise MessageError(
            f'{topic}: latitude {message.latitude:g}, longitude {message.longitude:g} with a '
            'valid fix; expected degrees within ±90 and ±360'
        )
    std = _deviation(topic, message.position_covariance[0])
    return FixSample(stamp_of(message), float(message.latitude), float(message.longitude), std)


def _deviation(topic: str, variance: float) -> float:
    if variance < 0:
        raise MessageError(f'{topic}: variance {variance:g}; expected 0 (unknown) or more')
    return math.sqrt(variance)


def _vector(message: Any) -> FloatArray:
    return np.array([message.x, message.y, message.z], dtype=float)


def _orientation(topic: str, message: Any) -> FloatArray:
    _angles(topic, message)
    return np.array([message.x, message.y, message.z, message.w], dtype=float)


def _angles(topic: str, message: Any) -> tuple[float, float, float]:
    try:
        return to_angles((message.x, message.y, message.z, message.w))
    except ValueError as error:
        raise MessageError(f'{topic}: {error}') from error


_DISTANCES = {topic: what for what, topic in RANGES.items()}

_READERS: dict[str, Callable[[str, Any], Sample]] = {
    'winch/joint_states': _winch_sample,
    'door/port/pressure': _pressure,
    'door/starboard/pressure': _pressure,
    'door/port/attitude': _attitude,
    'door/starboard/attitude': _attitude,
    'door/spread': _range,
    'sonar/pressure': _pressure,
    'sonar/opening_height': _range,
    'sonar/opening_width': _range,
    'sonar/bottom': _range,
    'sonar/image': _sonar_image,
    'sonar/scan': _sonar_scan,
    'sonar/points': _sonar_points,
    'vessel/velocity_water': _velocity,
    'vessel/velocity_ground': _velocity,
    'vessel/heading': _heading,
    'vessel/fix': _fix,
    'vessel/echo_sounder/depth': _range,
    'vessel/echo_sounder/school': _range,
    'vessel/fish_sonar': _seen_schools,
}

SAMPLE_TOPICS = tuple(_READERS)
"""Relative names of the topics whose messages are samples."""
