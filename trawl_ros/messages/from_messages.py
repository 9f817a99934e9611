# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Decoding of messages into samples: the reverse of `to_messages`.

Messages may come from bags of other projects and are decoded with the definitions in the bag, so
only attributes are used. Missing readings become NaN. Content that contradicts the topic raises
`MessageError`, which names the topic.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from trawl_ros.core.errors import MessageError
from trawl_ros.core.foreign import short
from trawl_ros.messages.pieces import ABSENT, ANGLES, read_angles, read_vector, winch_columns
from trawl_ros.messages.point_clouds import read_point_cloud
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.records.registry import Sensor, changed, with_numbers
from trawl_ros.records.samples import (
    FixSample,
    Sample,
    SchoolsSample,
    SonarImageSample,
    SonarPointsSample,
    SonarScanSample,
    WinchSample,
)
from trawl_ros.records.sensors import SENSORS

Row = Sensor[Sample]


def to_sample(topic: str, message: Any) -> Sample:
    """Turn the message of an instrument topic (relative name) into a sample.

    Raises
    ------
    MessageError
        If the topic carries no sample, or the message contradicts the topic.
    """
    if topic not in SENSORS:
        raise MessageError(
            f'{topic}: not a topic with samples; expected one of {", ".join(SAMPLE_TOPICS)}'
        )
    try:
        return _READERS[SENSORS[topic].type](SENSORS[topic], message)
    except MessageError:
        raise
    # Of another type, or of this one as somebody else defines it.
    except Exception as reason:
        kind = getattr(message, '__msgtype__', type(message).__name__)
        raise MessageError(
            f'{topic}: a {kind} that lacks the fields of its readings ({short(reason)})'
        ) from reason


def _winch_sample(row: Row, message: Any) -> WinchSample:
    lengths, speeds, tensions = winch_columns(row.name, message)
    return WinchSample(stamp_of(message), lengths, speeds, tensions)


def _pressure(row: Row, message: Any) -> Sample:
    std = _deviation(row.name, message.variance)
    return changed(
        row.blank, stamp=stamp_of(message), pressure=float(message.fluid_pressure), std=std
    )


def _orientation(row: Row, message: Any) -> Any:
    blank = changed(row.blank, stamp=stamp_of(message))
    if message.orientation_covariance[0] == ABSENT:
        return blank
    angles = dict(zip(ANGLES, read_angles(row.name, message.orientation), strict=True))
    measured = with_numbers(blank, {field: angles[field.at] for field in row.fields})
    entry = 4 * min(ANGLES.index(field.at) for field in row.fields)
    return changed(measured, std=_deviation(row.name, message.orientation_covariance[entry]))


def _vector(row: Row, message: Any) -> Any:
    blank = changed(row.blank, stamp=stamp_of(message))
    return with_numbers(
        blank, {field: float(getattr(message.vector, field.at)) for field in row.fields}
    )


def _range(row: Row, message: Any) -> Sample:
    return changed(
        row.blank,
        stamp=stamp_of(message),
        distance=float(message.range),
        # Range has had no variance before ROS 2 Iron; 0 stands for unknown in those that do.
        std=_deviation(row.name, getattr(message, 'variance', 0.0)),
        min_range=float(message.min_range),
        max_range=float(message.max_range),
    )


def _sonar_image(row: Row, message: Any) -> SonarImageSample:
    beams, cells, step = int(message.height), int(message.width), int(message.step)
    data = np.asarray(message.data, dtype=np.uint8)
    if message.encoding != 'mono8' or step < cells or len(data) != beams * step:
        raise MessageError(
            f'{row.name}: {len(data)} bytes of {message.encoding}, {beams} rows of {step} bytes; '
            'expected mono8 and as many bytes as rows have'
        )
    image = data.reshape(beams, step)[:, :cells]
    return SonarImageSample(stamp_of(message), image)


def _sonar_scan(row: Row, message: Any) -> SonarScanSample:
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


def _sonar_points(row: Row, message: Any) -> SonarPointsSample:
    points = read_point_cloud(row.name, message, ('x', 'y', 'z', 'intensity'))
    return SonarPointsSample(stamp_of(message), points)


def _seen_schools(row: Row, message: Any) -> SchoolsSample:
    positions = [read_vector(pose.position) for pose in message.poses]
    return SchoolsSample(stamp_of(message), np.array(positions).reshape(-1, 3))


def _velocity(row: Row, message: Any) -> Sample:
    return changed(
        row.blank,
        stamp=stamp_of(message),
        velocity=read_vector(message.twist.linear),
        yaw_rate=float(message.twist.angular.z),
    )


def _fix(row: Row, message: Any) -> FixSample:
    if message.status.status < 0:
        return FixSample(stamp_of(message), math.nan, math.nan, math.nan)
    if not (abs(message.latitude) <= 90.0 and abs(message.longitude) <= 360.0):
        raise MessageError(
            f'{row.name}: latitude {message.latitude:g}, longitude {message.longitude:g} with a '
            'valid fix; expected degrees within ±90 and ±360'
        )
    std = _deviation(row.name, message.position_covariance[0])
    return FixSample(stamp_of(message), float(message.latitude), float(message.longitude), std)


def _deviation(topic: str, variance: float) -> float:
    if variance < 0:
        raise MessageError(f'{topic}: variance {variance:g}; expected 0 (unknown) or more')
    return math.sqrt(variance)


_READERS: dict[str, Callable[[Row, Any], Sample]] = {
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
"""Readers by type of message."""

SAMPLE_TOPICS = tuple(SENSORS)
"""Relative names of the topics whose messages are samples."""
