"""Truth and samples in, messages out: each as (relative topic name, message).

Covariances carry the *stated* noise. `UNKNOWN_VARIANCE` marks a part of an orientation or
position that the sensor does not measure, `ABSENT` a whole quantity it does not have.
"""

import math
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.instruments.samples import (
    AttitudeSample,
    FixSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.messages.rotations import about_z, to_quaternion
from trawl_ros.messages.stamps import header, to_time
from trawl_ros.messages.topics import DOOR_FRAMES, TOPICS, WINCH_NAMES
from trawl_ros.simulation.truth import SIDES, DoorTruth, NetTruth, Truth, VesselTruth, WinchTruth

TopicMessage = tuple[str, Any]

UNKNOWN_VARIANCE = 1e6
"""rad² or m²: so large that every consumer reads it as 'not measured'."""

ABSENT = -1.0
"""First entry of an Imu covariance whose quantity the sensor does not have."""

FIELDS_OF_VIEW = {'spread': 0.35, 'opening_height': 0.02, 'opening_width': 0.02}
"""Beam widths (rad) of the sensors behind the ranges, for display: about 20° for an acoustic
door sensor, about 1° for a trawl sonar."""


def clock_message(stamp: int) -> TopicMessage:
    """Turn a stamp (ns) into simulated time on ``/clock``."""
    return '/clock', ros.rosgraph_msgs__msg__Clock(to_time(stamp))


def truth_messages(truth: Truth) -> list[TopicMessage]:
    """Give every truth topic but the markers for one instant."""
    messages: list[TopicMessage] = []
    for side, door in zip(SIDES, truth.doors, strict=True):
        messages += _door(truth.stamp, side, door)
    messages += _net(truth.stamp, truth.net)
    messages.append(_winches(truth.stamp, truth.winches))
    messages += _vessel(truth.stamp, truth.vessel)
    return messages


def sample_message(sample: Sample) -> TopicMessage:
    """Turn what an instrument reports into the message of its topic."""
    match sample:
        case WinchSample():
            return _winch_sample(sample)
        case PressureSample():
            return _pressure(sample)
        case AttitudeSample():
            return _attitude(sample)
        case RangeSample():
            return _range(sample)
        case VelocitySample():
            return _velocity(sample)
        case HeadingSample():
            return _heading(sample)
        case FixSample():
            return _fix(sample)


def _door(stamp: int, side: str, door: DoorTruth) -> list[TopicMessage]:
    frame = DOOR_FRAMES[side]
    odometry, angles, wrench = (
        f'truth/door/{side}/{what}' for what in ('odom', 'angles', 'wrench')
    )
    return [
        (
            odometry,
            ros.nav_msgs__msg__Odometry(
                _header(stamp, odometry),
                frame,
                _with_covariance(_pose(door.position, door.orientation)),
                _twist_with_covariance(door.velocity, door.angular_velocity),
            ),
        ),
        (
            angles,
            ros.geometry_msgs__msg__Vector3Stamped(
                _header(stamp, angles), _vector((door.attack, door.slip, door.inclination))
            ),
        ),
        (
            wrench,
            ros.geometry_msgs__msg__WrenchStamped(
                _header(stamp, wrench),
                ros.geometry_msgs__msg__Wrench(_vector(door.force), _vector(door.moment)),
            ),
        ),
    ]


def _net(stamp: int, net: NetTruth) -> list[TopicMessage]:
    mouth, opening, pose = 'truth/net/mouth', 'truth/net/opening', 'truth/sonar/pose'
    corners = [ros.geometry_msgs__msg__Point32(*map(float, point)) for point in net.mouth]
    openings = (net.horizontal_opening, net.vertical_opening, net.headrope_depth)
    return [
        (
            mouth,
            ros.geometry_msgs__msg__PolygonStamped(
                _header(stamp, mouth), ros.geometry_msgs__msg__Polygon(corners)
            ),
        ),
        (
            opening,
            ros.geometry_msgs__msg__Vector3Stamped(_header(stamp, opening), _vector(openings)),
        ),
        (
            pose,
            ros.geometry_msgs__msg__PoseStamped(
                _header(stamp, pose), _pose(net.sonar_position, net.sonar_orientation)
            ),
        ),
    ]


def _winches(stamp: int, winches: tuple[WinchTruth, WinchTruth]) -> TopicMessage:
    topic = 'truth/winch'
    columns = zip(*((winch.length, winch.speed, winch.tension) for winch in winches), strict=True)
    return topic, _joint_state(stamp, topic, *columns)


def _vessel(stamp: int, vessel: VesselTruth) -> list[TopicMessage]:
    odometry, through_water = 'truth/vessel/odom', 'truth/vessel/velocity_water'
    turning = (0.0, 0.0, vessel.yaw_rate)
    over_ground = about_z(vessel.heading).T @ vessel.velocity_ground
    pose = _pose(vessel.position, to_quaternion(0.0, 0.0, vessel.heading))
    return [
        (
            odometry,
            ros.nav_msgs__msg__Odometry(
                _header(stamp, odometry),
                'vessel',
                _with_covariance(pose),
                _twist_with_covariance(over_ground, turning),
            ),
        ),
        (
            through_water,
            ros.geometry_msgs__msg__TwistStamped(
                _header(stamp, through_water), _twist(vessel.velocity_water, turning)
            ),
        ),
    ]


def _winch_sample(sample: WinchSample) -> TopicMessage:
    topic = 'winch/joint_states'
    columns = (sample.lengths, sample.speeds, sample.tensions)
    return topic, _joint_state(sample.stamp, topic, *columns)


def _pressure(sample: PressureSample) -> TopicMessage:
    topic = 'sonar/pressure' if sample.place == 'sonar' else f'door/{sample.place}/pressure'
    return topic, ros.sensor_msgs__msg__FluidPressure(
        _header(sample.stamp, topic), float(sample.pressure), float(sample.std) ** 2
    )


def _attitude(sample: AttitudeSample) -> TopicMessage:
    topic = f'door/{sample.side}/attitude'
    variances = (sample.std**2, sample.std**2, UNKNOWN_VARIANCE)
    return topic, _imu(sample.stamp, topic, (sample.roll, sample.pitch, 0.0), variances)


def _heading(sample: HeadingSample) -> TopicMessage:
    topic = 'vessel/heading'
    variances = (UNKNOWN_VARIANCE, UNKNOWN_VARIANCE, sample.std**2)
    return topic, _imu(sample.stamp, topic, (0.0, 0.0, sample.heading), variances)


def _range(sample: RangeSample) -> TopicMessage:
    topic = 'door/spread' if sample.what == 'spread' else f'sonar/{sample.what}'
    return topic, ros.sensor_msgs__msg__Range(
        header=_header(sample.stamp, topic),
        radiation_type=ros.sensor_msgs__msg__Range.ULTRASOUND,
        field_of_view=FIELDS_OF_VIEW[sample.what],
        min_range=float(sample.min_range),
        max_range=float(sample.max_range),
        range=float(sample.distance),
        variance=float(sample.std) ** 2,
    )


def _velocity(sample: VelocitySample) -> TopicMessage:
    topic = f'vessel/velocity_{sample.over}'
    return topic, ros.geometry_msgs__msg__TwistStamped(
        _header(sample.stamp, topic), _twist(sample.velocity, (0.0, 0.0, sample.yaw_rate))
    )


def _fix(sample: FixSample) -> TopicMessage:
    topic = 'vessel/fix'
    # Any, since the stubs of rosbags expect the status of an older distribution here.
    status: Any = ros.sensor_msgs__msg__NavSatStatus
    fixed = math.isfinite(sample.latitude) and math.isfinite(sample.longitude)
    variances = (sample.std**2, sample.std**2, UNKNOWN_VARIANCE)
    return topic, ros.sensor_msgs__msg__NavSatFix(
        header=_header(sample.stamp, topic),
        status=status(status.STATUS_FIX if fixed else status.STATUS_NO_FIX, status.SERVICE_GPS),
        latitude=float(sample.latitude),
        longitude=float(sample.longitude),
        altitude=math.nan,
        position_covariance=np.diag(variances).ravel(),
        position_covariance_type=ros.sensor_msgs__msg__NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN,
    )


def _header(stamp: int, topic: str) -> ros.std_msgs__msg__Header:
    return header(stamp, TOPICS[topic].frame)


def _vector(values: Any) -> ros.geometry_msgs__msg__Vector3:
    x, y, z = values
    return ros.geometry_msgs__msg__Vector3(float(x), float(y), float(z))


def _pose(position: Any, orientation: Any) -> ros.geometry_msgs__msg__Pose:
    x, y, z = map(float, position)
    return ros.geometry_msgs__msg__Pose(
        ros.geometry_msgs__msg__Point(x, y, z),
        ros.geometry_msgs__msg__Quaternion(*map(float, orientation)),
    )


def _with_covariance(pose: Any) -> ros.geometry_msgs__msg__PoseWithCovariance:
    return ros.geometry_msgs__msg__PoseWithCovariance(pose, np.zeros(36))


def _twist(linear: Any, angular: Any) -> ros.geometry_msgs__msg__Twist:
    return ros.geometry_msgs__msg__Twist(_vector(linear), _vector(angular))


def _twist_with_covariance(
    linear: Any, angular: Any
) -> ros.geometry_msgs__msg__TwistWithCovariance:
    return ros.geometry_msgs__msg__TwistWithCovariance(_twist(linear, angular), np.zeros(36))


def _joint_state(
    stamp: int, topic: str, positions: Any, velocities: Any, efforts: Any
) -> ros.sensor_msgs__msg__JointState:
    columns = (np.array(column, dtype=float) for column in (positions, velocities, efforts))
    return ros.sensor_msgs__msg__JointState(_header(stamp, topic), list(WINCH_NAMES), *columns)


def _imu(
    stamp: int,
    topic: str,
    angles: tuple[float, float, float],
    variances: tuple[float, float, float],
) -> ros.sensor_msgs__msg__Imu:
    absent = np.zeros(9)
    absent[0] = ABSENT
    return ros.sensor_msgs__msg__Imu(
        header=_header(stamp, topic),
        orientation=ros.geometry_msgs__msg__Quaternion(*to_quaternion(*angles)),
        orientation_covariance=np.diag(variances).ravel(),
        angular_velocity=_vector((0.0, 0.0, 0.0)),
        angular_velocity_covariance=absent,
        linear_acceleration=_vector((0.0, 0.0, 0.0)),
        linear_acceleration_covariance=absent.copy(),
    )
