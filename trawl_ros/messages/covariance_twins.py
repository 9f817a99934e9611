# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Readings with their covariance, next to those without: input of estimators of poses.

robot_localization takes them as they are. What a sensor does not measure has `UNKNOWN_VARIANCE`.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.messages import pieces
from trawl_ros.messages.pieces import UNKNOWN_VARIANCE, TopicMessage
from trawl_ros.records.samples import PressureSample, Sample, VelocitySample
from trawl_ros.records.topics import WITH_COVARIANCE

_NO_TURN = (0.0, 0.0, 0.0, 1.0)


def covariance_twin(sample: Sample, depth: Callable[[float], float]) -> TopicMessage | None:
    """Return the message with covariance that goes with a sample.

    Parameters
    ----------
    sample
        Of any instrument.
    depth
        Depth (m) for an absolute pressure (Pa).

    Returns
    -------
    tuple of str and message, or None
        None for other samples, for those that miss a reading, and without a stated noise.
    """
    if isinstance(sample, VelocitySample):
        return _velocity(sample)
    if isinstance(sample, PressureSample):
        return _depth(sample, depth)
    return None


def _velocity(sample: VelocitySample) -> TopicMessage | None:
    std, turn_std = sample.stated
    if not std or not np.isfinite(sample.velocity).all():
        return None
    turns = turn_std > 0.0 and math.isfinite(sample.yaw_rate)
    topic = f'{sample.topic}{WITH_COVARIANCE}'
    twist = pieces.twist(sample.velocity, (0.0, 0.0, sample.yaw_rate if turns else 0.0))
    variances = [UNKNOWN_VARIANCE] * 6
    variances[0] = variances[1] = std**2
    if turns:
        variances[5] = turn_std**2
    return topic, ros.geometry_msgs__msg__TwistWithCovarianceStamped(
        pieces.topic_header(sample.stamp, topic),
        ros.geometry_msgs__msg__TwistWithCovariance(twist, _diagonal(variances)),
    )


def _depth(sample: PressureSample, depth: Callable[[float], float]) -> TopicMessage | None:
    if not (sample.std > 0.0 and math.isfinite(sample.pressure)):
        return None
    topic = f'{sample.topic.replace("pressure", "depth")}{WITH_COVARIANCE}'
    std = depth(sample.pressure + sample.std) - depth(sample.pressure)
    variances = [UNKNOWN_VARIANCE] * 6
    variances[2] = std**2
    pose = pieces.pose((0.0, 0.0, -depth(sample.pressure)), _NO_TURN)
    return topic, ros.geometry_msgs__msg__PoseWithCovarianceStamped(
        pieces.topic_header(sample.stamp, topic),
        ros.geometry_msgs__msg__PoseWithCovariance(pose, _diagonal(variances)),
    )


def _diagonal(variances: list[float]) -> Any:
    return np.diag(variances).ravel()
