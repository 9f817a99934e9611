# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quality of service (QoS) by role, so that no node chooses its own."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from trawl_ros.records.topics import Topic

PUBLISHED_DEPTH = 100
"""Messages a publisher keeps for subscribers that have not acknowledged them yet."""


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
LARGE_DEPTH = 60
"""Of messages that may be tens of megabytes, a minute at the rate of the sonar waits: what waits
is held in memory."""


def recorder_profile(type_name: str) -> QoSProfile:
    """Return the profile of a recorder of messages of a type."""
    if type_name in LARGE_TYPES:
        return _profile(LARGE_DEPTH, DurabilityPolicy.VOLATILE)
    return CONSUMER


def offered(topic: Topic | None) -> QoSProfile:
    """Return the profile of a publisher; None stands for a topic of somebody else."""
    return LATCHED if topic is not None and topic.latched else STREAM


def consumed(topic: Topic | None) -> QoSProfile:
    """Return the profile of a subscriber that must not lose anything."""
    return LATCHED if topic is not None and topic.latched else CONSUMER


def overriding() -> QoSOverridingOptions:
    """Let users override history, depth and reliability by parameters, as ROS 2 does."""
    return QoSOverridingOptions.with_default_policies()
