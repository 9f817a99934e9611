# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quality of service (QoS) by role, so that no node chooses its own."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from trawl_ros.records.topics import Topic

PUBLISHED_DEPTH = 1000
"""Messages a publisher keeps for subscribers that have not acknowledged them yet: a recorder that
waits for a processor acknowledges nothing for a second, and a machine may be that busy."""


def _profile(depth: int, durability: DurabilityPolicy) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=durability,
    )


STREAM = _profile(PUBLISHED_DEPTH, DurabilityPolicy.VOLATILE)
"""QoS of publishers and instruments."""

LATCHED = _profile(1, DurabilityPolicy.TRANSIENT_LOCAL)
"""The last message also for those who come late."""

CONSUMER = _profile(5000, DurabilityPolicy.VOLATILE)
"""QoS of recorder and estimators: not one message is to be dropped."""

LARGE_TYPES = ('sensor_msgs/msg/Image', 'sensor_msgs/msg/PointCloud2')
LARGE_WAIT_S = 60.0
"""Of messages that may be tens of megabytes, a minute waits: what waits is held in memory."""


def recorder_profile(type_name: str, rate: float | None = None) -> QoSProfile:
    """Return the profile of a recorder of messages of a type, at a rate (Hz, None if unknown)."""
    if type_name in LARGE_TYPES:
        return _profile(round(LARGE_WAIT_S * max(rate or 0.0, 1.0)), DurabilityPolicy.VOLATILE)
    return CONSUMER


def offered(topic: Topic | None) -> QoSProfile:
    """Return the profile of a publisher; None stands for a topic of somebody else."""
    if topic is None:
        return STREAM
    if topic.type in LARGE_TYPES:
        return recorder_profile(topic.type, topic.rate)
    return LATCHED if topic.latched else STREAM


def consumed(topic: Topic | None) -> QoSProfile:
    """Return the profile of a subscriber that must not lose anything."""
    return LATCHED if topic is not None and topic.latched else CONSUMER


def overriding() -> QoSOverridingOptions:
    """Let users override history, depth and reliability by parameters, as ROS 2 does."""
    return QoSOverridingOptions.with_default_policies()
