"""QoS of the recorder: messages that wait are held in memory, so few large ones do."""

import pytest

pytest.importorskip('rclpy')

from rclpy.qos import ReliabilityPolicy

from trawl_ros.nodes.runtime.qos import CONSUMER, LARGE_DEPTH, LARGE_TYPES, recorder_profile
from trawl_ros.records.topics import INSTRUMENTS, TRUTH


@pytest.mark.parametrize('type_name', LARGE_TYPES)
def test_few_large_messages_wait_and_none_is_dropped_at_the_rate_of_the_sonar(type_name):
    profile = recorder_profile(type_name)
    fastest = max(topic.rate or 0 for topic in INSTRUMENTS if topic.type == type_name)
    assert 60.0 * fastest <= profile.depth == LARGE_DEPTH < CONSUMER.depth
    assert profile.reliability == ReliabilityPolicy.RELIABLE


def test_all_else_waits_as_long_as_it_takes():
    others = {topic.type for topic in (*TRUTH, *INSTRUMENTS)} - {*LARGE_TYPES}
    assert all(recorder_profile(name) == CONSUMER for name in others)
