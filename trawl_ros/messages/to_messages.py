# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion of samples into messages, each as (relative topic name, message)."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.messages import pieces
from trawl_ros.messages.pieces import UNKNOWN_VARIANCE, TopicMessage
from trawl_ros.messages.point_clouds import point_cloud
from trawl_ros.records.registry import Sensor
from trawl_ros.records.samples import (
    FixSample,
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
from trawl_ros.records.sensors import SENSORS

Row = Sensor[Sample]


def sample_message(sample: Sample) -> TopicMessage:
    """Convert a sample into the message of its topic."""
    row = SENSORS[sample.topic]
    return row.name, _WRITERS[row.type](row, sample)


def _winch_sample(row: Row, sample: WinchSample) -> Any:
    columns = (sample.lengths, sample.speeds, sample.tensions)
    return pieces.joint_state(sample.stamp, row.name, *columns)


def _pressure(row: Row, sample: PressureSample) -> Any:
    return ros.sensor_msgs__msg__FluidPressure(
        pieces.topic_header(sample.stamp, row.name), float(sample.pressure), float(sample.std) ** 2
    )


def _orientation(row: Row, sample: Any) -> Any:
    angles = {field.at: field.get(sample) for field in row.fields}
    roll, pitch, yaw = (angles.get(name, 0.0) for name in pieces.ANGLES)
    said = (sample.std**2 if name in angles else UNKNOWN_VARIANCE for name in pieces.ANGLES)
    roll_variance, pitch_variance, yaw_variance = said
    return pieces.imu(
        sample.stamp, row.name, (roll, pitch, yaw), (roll_variance, pitch_variance, yaw_variance)
    )


def _vector(row: Row, sample: Any) -> Any:
    parts = {field.at: field.get(sample) for field in row.fields}
    return ros.geometry_msgs__msg__Vector3Stamped(
        pieces.topic_header(sample.stamp, row.name),
        pieces.vector([parts.get(axis, 0.0) for axis in 'xyz']),
    )


def _range(row: Row, sample: RangeSample) -> Any:
    return ros.sensor_msgs__msg__Range(
        header=pieces.topic_header(sample.stamp, row.name),
        radiation_type=ros.sensor_msgs__msg__Range.ULTRASOUND,
        field_of_view=row.beam_width,
        min_range=float(sample.min_range),
        max_range=float(sample.max_range),
        range=float(sample.distance),
        variance=float(sample.std) ** 2,
    )


def _sonar_image(row: Row, sample: SonarImageSample) -> Any:
    beams, cells = sample.image.shape
    return ros.sensor_msgs__msg__Image(
        header=pieces.topic_header(sample.stamp, row.name),
        height=beams,
        width=cells,
        encoding='mono8',
        is_bigendian=0,
        step=cells,
        data=np.ascontiguousarray(sample.image, dtype=np.uint8).ravel(),
    )


def _sonar_scan(row: Row, sample: SonarScanSample) -> Any:
    beams = len(sample.ranges)
    return ros.sensor_msgs__msg__LaserScan(
        header=pieces.topic_header(sample.stamp, row.name),
        angle_min=float(sample.angle_min),
        angle_max=float(sample.angle_min + (beams - 1) * sample.angle_increment),
        angle_increment=float(sample.angle_increment),
        time_increment=0.0 if sample.stamped_at_end else float(sample.sweep_s / beams),
        scan_time=float(sample.sweep_s),
        range_min=float(sample.min_range),
        range_max=float(sample.max_range),
        ranges=np.asarray(sample.ranges, dtype=np.float32),
        intensities=np.asarray(sample.intensities, dtype=np.float32),
    )


def _sonar_points(row: Row, sample: SonarPointsSample) -> Any:
    columns = zip(('x', 'y', 'z', 'intensity'), sample.points.reshape(-1, 4).T, strict=True)
    return point_cloud(pieces.topic_header(sample.stamp, row.name), dict(columns))


def _seen_schools(row: Row, sample: SchoolsSample) -> Any:
    poses = [pieces.pose(position, (0.0, 0.0, 0.0, 1.0)) for position in sample.positions]
    return ros.geometry_msgs__msg__PoseArray(pieces.topic_header(sample.stamp, row.name), poses)


def _velocity(row: Row, sample: VelocitySample) -> Any:
    return ros.geometry_msgs__msg__TwistStamped(
        pieces.topic_header(sample.stamp, row.name),
        pieces.twist(sample.velocity, (0.0, 0.0, sample.yaw_rate)),
    )


def _fix(row: Row, sample: FixSample) -> Any:
    # Any, since the stubs of rosbags expect the status of an older distribution here.
    status: Any = ros.sensor_msgs__msg__NavSatStatus
    fixed = math.isfinite(sample.latitude) and math.isfinite(sample.longitude)
    variances = (sample.std**2, sample.std**2, UNKNOWN_VARIANCE)
    return ros.sensor_msgs__msg__NavSatFix(
        header=pieces.topic_header(sample.stamp, row.name),
        status=status(status.STATUS_FIX if fixed else status.STATUS_NO_FIX, status.SERVICE_GPS),
        latitude=float(sample.latitude),
        longitude=float(sample.longitude),
        altitude=math.nan,
        position_covariance=np.diag(variances).ravel(),
        position_covariance_type=ros.sensor_msgs__msg__NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN,
    )


_WRITERS: dict[str, Callable[[Row, Any], Any]] = {
    'sensor_msgs/msg/JointState': _winch_sample,
    'sensor_msgs/msg/FluidPressure': _pressure,
    'sensor_msgs/msg/Imu': _orientation,
    'sensor_msgs/msg/Range': _range,
    'sensor_msgs/msg/NavSatFix': _fix,
    'sensor_msgs/msg/Image': _sonar_image,
    'sensor_msgs/msg/LaserScan': _sonar_scan,
    'sensor_msgs/msg/PointCloud2': _sonar_points,
    'geometry_msgs/msg/TwistStamped': _velocity,
    'geometry_msgs/msg/Vector3Stamped': _vector,
    'geometry_msgs/msg/PoseArray': _seen_schools,
}
"""Writers by type of message."""
