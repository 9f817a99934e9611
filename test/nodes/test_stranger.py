"""A stranger disturbs a graph in just the way it was asked to."""

from types import SimpleNamespace

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from endurance.stranger import Stranger  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.cdr import deserialize  # noqa: E402
from trawl_ros.messages.stamps import from_time, stamp_of  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.messages.truth_to_messages import clock_message  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.records.samples import RangeSample  # noqa: E402

pytestmark = pytest.mark.ros

SPREAD, SPREAD_TYPE = 'door/spread', 'sensor_msgs/msg/Range'
CLOCK_TYPE, HEADER_TYPE = 'rosgraph_msgs/msg/Clock', 'std_msgs/msg/Header'
METRES = 100.0


class Ship(TrawlNode):
    """Gives the time and a spread ten times a second, and hears what else is said."""

    def __init__(self, **kwargs):
        super().__init__('ship', **kwargs)
        self.stamp = 0
        self.heard = {SPREAD: [], '/clock': [], 'sync/progress': []}
        self.advertise('/clock')
        self.advertise(SPREAD)
        for topic, kind in zip(self.heard, (SPREAD_TYPE, CLOCK_TYPE, HEADER_TYPE)):
            self.listen_raw(topic, kind, self.keeper(topic, kind), CONSUMER)
        self.every(0.1, self.speak)

    def keeper(self, topic, kind):
        return lambda data: self.heard[topic].append(deserialize(data, kind))

    def speak(self):
        self.stamp += SECOND
        self.send(*clock_message(self.stamp))
        self.send(*sample_message(RangeSample(self.stamp, 'spread', METRES, 1.0, 1.0, 300.0)))


@pytest.fixture
def heard(open_graph):
    """What is said while a stranger of some kind is there until something is heard."""

    def hear(kind, target, enough):
        with open_graph() as graph:
            ship = graph.add(Ship)
            with Stranger(graph.environment, kind, target) as stranger:
                seen = SimpleNamespace(
                    spread=ship.heard[SPREAD],
                    clock=ship.heard['/clock'],
                    progress=ship.heard['sync/progress'],
                )
                graph.until(lambda: enough(seen))
            return seen, stranger

    return hear


def test_a_second_publisher_repeats_each_reading_once_and_too_large(heard):
    seen, _ = heard('second publisher', SPREAD, lambda s: len({m.range for m in s.spread}) > 1
                    and len(s.spread) > 12)  # fmt: skip
    wrong = [stamp_of(m) for m in seen.spread if m.range == pytest.approx(1.15 * METRES)]
    assert wrong
    assert len(wrong) == len(set(wrong))
    assert {round(m.range) for m in seen.spread} == {100, 115}


def test_a_flood_repeats_a_message_many_hundred_times_a_second(heard):
    seen, stranger = heard('flood', SPREAD, lambda s: len(s.spread) > 500)
    assert {m.range for m in seen.spread} == {METRES}
    assert stranger.sent > 400


def test_a_clock_is_off_by_what_was_asked(heard):
    seen, _ = heard('clock', '-1000', lambda s: any(from_time(m.clock) < 0 for m in s.clock))
    off = min(from_time(m.clock) for m in seen.clock)
    assert -1000 * SECOND < off < 0


def test_a_stamp_is_the_latest_there_can_be(heard):
    last = (2**31 - 1) * SECOND
    heard('stamp', SPREAD, lambda s: any(stamp_of(m) == last for m in s.spread))


def test_progress_never_gets_on(heard):
    seen, _ = heard('progress', 'sync/progress', lambda s: len(s.progress) > 3)
    assert {(m.frame_id, from_time(m.stamp)) for m in seen.progress} == {('stranger', SECOND)}
