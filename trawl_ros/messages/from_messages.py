"""Decoding of messages into samples: the reverse of `to_messages`.

Messages may come from bags of others, decoded with the definitions they carry, so only
attributes are relied on. Readings that say they are missing become NaN; content that
contradicts the topic raises `MessageError` naming it.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from trawl_ros.core.errors import MessageError
from trawl_ros.core.foreign import short
from trawl_ros.messages.pieces import ABSENT, read_angles, read_vector, winch_columns
from trawl_ros.messages.point_clouds import read_point_cloud
from trawl_ros.messages.stamps import stamp_of
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


def _winch_sample(topic: str, message: Any) -> WinchSample:
    lengths, speeds, tensions = winch_columns(topic, message)
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
    return *read_angles(topic, message.orientation), std


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
    positions = [read_vector(pose.position) for pose in message.poses]
    return SchoolsSample(stamp_of(message), np.array(positions).reshape(-1, 3))


def _velocity(topic: str, message: Any) -> VelocitySample:
    over = topic.removeprefix('vessel/velocity_')
    twist = message.twist
    return VelocitySample(
        stamp_of(message), over, read_vector(twist.linear), float(twist.angular.z)
    )


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
