"""QoS of recorder and publishers: messages that wait are held in memory, so few large ones do."""

import pytest

pytest.importorskip('rclpy')

from rclpy.qos import ReliabilityPolicy

from trawl_ros.nodes.runtime.qos import (
    CONSUMER,
    LARGE_TYPES,
    LARGE_WAIT_S,
    PUBLISHED_DEPTH,
    offered,
    recorder_profile,
)
from trawl_ros.records.topics import INSTRUMENTS, TRUTH

TOPICS = (*TRUTH, *INSTRUMENTS)


@pytest.mark.parametrize('topic', [topic for topic in TOPICS if topic.type in LARGE_TYPES])
def test_of_large_messages_a_minute_waits_at_their_rate(topic):
    profile = recorder_profile(topic.type, topic.rate)
    assert (
        LARGE_WAIT_S * (topic.rate or 1.0) <= profile.depth == offered(topic).depth < CONSUMER.depth
    )
    assert profile.reliability == ReliabilityPolicy.RELIABLE


def test_all_else_waits_as_long_as_it_takes():
    others = [topic for topic in TOPICS if topic.type not in LARGE_TYPES]
    assert all(recorder_profile(topic.type, topic.rate) == CONSUMER for topic in others)
    assert all(offered(topic).depth == PUBLISHED_DEPTH for topic in others)
