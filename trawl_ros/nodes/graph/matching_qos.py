"""Subscriber's quality of service (QoS) that all publishers of a topic can serve."""

from collections.abc import Sequence
from copy import copy

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo


def with_history(profile: QoSProfile) -> QoSProfile:
    """Return the profile of a subscriber that also asks for what was published before it came."""
    asked = copy(profile)
    asked.durability = DurabilityPolicy.TRANSIENT_LOCAL
    return asked


def matching(publishers: Sequence[TopicEndpointInfo], asked: QoSProfile) -> QoSProfile:
    """Lower a subscriber's profile to what all publishers of a topic offer.

    Drivers often offer sensor data as best effort, which a reliable subscriber does not hear.
    """
    heard = copy(asked)
    offers = [publisher.qos_profile for publisher in publishers]
    if any(offer.reliability == ReliabilityPolicy.BEST_EFFORT for offer in offers):
        heard.reliability = ReliabilityPolicy.BEST_EFFORT
    if any(offer.durability == DurabilityPolicy.VOLATILE for offer in offers):
        heard.durability = DurabilityPolicy.VOLATILE
    return heard


def asks_more(asked: QoSProfile, heard: QoSProfile) -> bool:
    """True if a subscriber asks for more than ``heard``, so that a publisher is not heard."""
    return bool(asked.reliability != heard.reliability or asked.durability != heard.durability)
