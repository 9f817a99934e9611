"""Of 500 messages per second on all topics of the project, each one is in the bag."""

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.lab.benchmark.full_chain import TOPICS, schedule  # noqa: E402
from trawl_ros.lab.benchmark.recording import record  # noqa: E402
from trawl_ros.records.topics import absolute  # noqa: E402

pytestmark = pytest.mark.ros

RATE, SECONDS = 500.0, 3.0


def test_the_schedule_has_the_rate_and_every_topic():
    due = schedule(60.0, RATE)
    assert len(due) == pytest.approx(60.0 * RATE, rel=0.01)
    assert {number for _, number in due} == set(range(len(TOPICS)))
    busiest = max(sum(second <= time < second + 1 for time, _ in due) for second in range(60))
    assert busiest < 1.1 * RATE


def test_the_recorder_has_as_many_messages_of_each_topic_as_were_published(tmp_path):
    found = record(tmp_path, RATE, SECONDS)
    assert sum(found.published.values()) == pytest.approx(RATE * SECONDS, rel=0.02)
    assert set(found.published) == {absolute(topic.name) for topic in TOPICS}
    recorded = {topic: found.recorded.get(topic, 0) for topic in found.published}
    assert recorded == found.published
    assert found.lost == 0
