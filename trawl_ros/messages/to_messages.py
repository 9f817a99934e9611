"""Conversion of samples into messages, each as (relative topic name, message)."""

import math
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.messages import pieces
from trawl_ros.messages.pieces import UNKNOWN_VARIANCE, TopicMessage
from trawl_ros.messages.point_clouds import point_cloud
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
from trawl_ros.records.topics import RANGES

FIELDS_OF_VIEW = {
    'spread': 0.35,
    'opening_height': 0.02,
    'opening_width': 0.02,
    'bottom': 0.26,
    'depth': 0.12,
    'school': 0.12,
}
"""Beam widths (rad) of the sensors behind the ranges, for display: about 20° for an acoustic
door sensor, 15° for a sounder on the headrope, 7° for a ship's, 1° for a trawl sonar."""


def sample_message(sample: Sample) -> TopicMessage:
    """Convert a sample into the message of its topic."""
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
        case SonarImageSample():
            return _sonar_image(sample)
        case SonarScanSample():
            return _sonar_scan(sample)
        case SonarPointsSample():
            return _sonar_points(sample)
        case SchoolsSample():
            return _seen_schools(sample)


def _winch_sample(sample: WinchSample) -> TopicMessage:
    topic = 'winch/joint_states'
    columns = (sample.lengths, sample.speeds, sample.tensions)
    return topic, pieces.joint_state(sample.stamp, topic, *columns)


def _pressure(sample: PressureSample) -> TopicMessage:
    topic = 'sonar/pressure' if sample.place == 'sonar' else f'door/{sample.place}/pressure'
    return topic, ros.sensor_msgs__msg__FluidPressure(
        pieces.topic_header(sample.stamp, topic), float(sample.pressure), float(sample.std) ** 2
    )


def _attitude(sample: AttitudeSample) -> TopicMessage:
    topic = f'door/{sample.side}/attitude'
    variances = (sample.std**2, sample.std**2, UNKNOWN_VARIANCE)
    return topic, pieces.imu(sample.stamp, topic, (sample.roll, sample.pitch, 0.0), variances)


def _heading(sample: HeadingSample) -> TopicMessage:
    topic = 'vessel/heading'
    variances = (UNKNOWN_VARIANCE, UNKNOWN_VARIANCE, sample.std**2)
    return topic, pieces.imu(sample.stamp, topic, (0.0, 0.0, sample.heading), variances)


def _range(sample: RangeSample) -> TopicMessage:
    topic = RANGES[sample.what]
    return topic, ros.sensor_msgs__msg__Range(
        header=pieces.topic_header(sample.stamp, topic),
        radiation_type=ros.sensor_msgs__msg__Range.ULTRASOUND,
        field_of_view=FIELDS_OF_VIEW[sample.what],
        min_range=float(sample.min_range),
        max_range=float(sample.max_range),
        range=float(sample.distance),
        variance=float(sample.std) ** 2,
    )


def _sonar_image(sample: SonarImageSample) -> TopicMessage:
    topic = 'sonar/image'
    beams, cells = sample.image.shape
    return topic, ros.sensor_msgs__msg__Image(
        header=pieces.topic_header(sample.stamp, topic),
        height=beams,
        width=cells,
        encoding='mono8',
        is_bigendian=0,
        step=cells,
        data=np.ascontiguousarray(sample.image, dtype=np.uint8).ravel(),
    )


def _sonar_scan(sample: SonarScanSample) -> TopicMessage:
    topic = 'sonar/scan'
    beams = len(sample.ranges)
    return topic, ros.sensor_msgs__msg__LaserScan(
        header=pieces.topic_header(sample.stamp, topic),
        angle_min=float(sample.angle_min),
        angle_max=float(sample.angle_min + (beams - 1) * sample.angle_increment),
        angle_increment=float(sample.angle_increment),
        time_increment=float(sample.sweep_s / beams),
        scan_time=float(sample.sweep_s),
        range_min=float(sample.min_range),
        range_max=float(sample.max_range),
        ranges=np.asarray(sample.ranges, dtype=np.float32),
        intensities=np.asarray(sample.intensities, dtype=np.float32),
    )


def _sonar_points(sample: SonarPointsSample) -> TopicMessage:
    topic = 'sonar/points'
    columns = zip(('x', 'y', 'z', 'intensity'), sample.points.reshape(-1, 4).T, strict=True)
    return topic, point_cloud(pieces.topic_header(sample.stamp, topic), dict(columns))


def _seen_schools(sample: SchoolsSample) -> TopicMessage:
    topic = 'vessel/fish_sonar'
    poses = [pieces.pose(position, (0.0, 0.0, 0.0, 1.0)) for position in sample.positions]
    return topic, ros.geometry_msgs__msg__PoseArray(pieces.topic_header(sample.stamp, topic), poses)


def _velocity(sample: VelocitySample) -> TopicMessage:
    topic = f'vessel/velocity_{sample.over}'
    return topic, ros.geometry_msgs__msg__TwistStamped(
        pieces.topic_header(sample.stamp, topic),
        pieces.twist(sample.velocity, (0.0, 0.0, sample.yaw_rate)),
    )


def _fix(sample: FixSample) -> TopicMessage:
    topic = 'vessel/fix'
    # Any, since the stubs of rosbags expect the status of an older distribution here.
    status: Any = ros.sensor_msgs__msg__NavSatStatus
    fixed = math.isfinite(sample.latitude) and math.isfinite(sample.longitude)
    variances = (sample.std**2, sample.std**2, UNKNOWN_VARIANCE)
    return topic, ros.sensor_msgs__msg__NavSatFix(
        header=pieces.topic_header(sample.stamp, topic),
        status=status(status.STATUS_FIX if fixed else status.STATUS_NO_FIX, status.SERVICE_GPS),
        latitude=float(sample.latitude),
        longitude=float(sample.longitude),
        altitude=math.nan,
        position_covariance=np.diag(variances).ravel(),
        position_covariance_type=ros.sensor_msgs__msg__NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN,
    )
