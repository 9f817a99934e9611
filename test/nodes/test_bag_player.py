"""`bag_player` plays what it is asked to, at the pace it is asked for, and ends by itself."""

import time

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.bags.reader import Bag  # noqa: E402
from trawl_ros.bags.writer import BagWriter  # noqa: E402
from trawl_ros.errors import BagError, TrawlError  # noqa: E402
from trawl_ros.instruments.samples import HeadingSample, PressureSample  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.stamps import SECOND, from_time, stamp_of  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.messages.topics import absolute  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.qos import CONSUMER  # noqa: E402

pytestmark = pytest.mark.ros

DOMAIN = 89
START = 1_785_000_000
COUNT = 20
HZ = 10


class Listener(TrawlNode):
    def __init__(self, **kwargs):
        super().__init__('listener', **kwargs)
        self.headings, self.pressures, self.clocks = [], [], []
        self.listen('vessel/heading', self.headings.append, CONSUMER)
        self.listen('sonar/pressure', self.pressures.append, CONSUMER)
        self.listen('/clock', self.clocks.append, CONSUMER)


@pytest.fixture
def bag(tmp_path):
    """Two seconds of two topics."""
    path = tmp_path / 'bag'
    with BagWriter(path) as writer:
        for number in range(COUNT):
            stamp = START * SECOND + number * SECOND // HZ
            for sample in (
                HeadingSample(stamp, 0.01 * number, 0.001),
                PressureSample(stamp, 'sonar', 1e6 + number, 1e3),
            ):
                topic, message = sample_message(sample)
                writer.write(absolute(topic), message.__msgtype__, serialize(message), stamp)
    return path


@pytest.fixture
def graph(open_graph):
    with open_graph(DOMAIN) as graph:
        yield graph


def times(messages):
    return [(stamp_of(message) - START * SECOND) / SECOND for message in messages]


def test_it_plays_at_its_rate_with_a_clock_and_ends(graph, bag):
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), rate=2)
    graph.until(lambda: listener.headings)
    began = time.monotonic()
    graph.until(lambda: len(listener.headings) == COUNT)
    assert time.monotonic() - began == pytest.approx((COUNT - 1) / HZ / 2, abs=0.25)
    graph.until(lambda: player.exit_code is not None)
    assert player.exit_code == 0
    assert times(listener.headings) == pytest.approx([n / HZ for n in range(COUNT)])
    assert len(listener.pressures) == COUNT
    assert [from_time(c.clock) for c in listener.clocks] == list(map(stamp_of, listener.headings))


def test_only_what_is_asked_for_is_played(graph, bag):
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), topics=['sonar/pressure'], start=1, rate=1)
    graph.until(lambda: player.exit_code is not None)
    assert not listener.headings
    assert times(listener.pressures) == pytest.approx([n / HZ for n in range(10, COUNT)])
    assert not listener.clocks


def test_in_a_loop_it_begins_again(graph, bag):
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), rate=40, loop=True)
    graph.until(lambda: len(listener.headings) >= 2 * COUNT + 5)
    assert player.exit_code is None
    assert times(listener.headings)[COUNT : 2 * COUNT] == times(listener.headings)[:COUNT]


def test_time_set_back_while_recording_is_said(graph, bag, tmp_path):
    recorder = graph.add(BagRecorder, output=str(tmp_path / 'looped'))
    graph.add(BagPlayer, bag=str(bag), rate=40, loop=True)
    graph.until(lambda: 'time was set back' in recorder.statuses()[0].message)
    (status,) = recorder.statuses()
    assert 'expected one tow per bag' in status.message


def test_what_is_readable_of_a_cut_bag_is_played(graph, bag):
    (file,) = bag.glob('*.mcap')
    file.write_bytes(file.read_bytes()[:-200])
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), rate=40)
    graph.until(lambda: player.exit_code is not None)
    assert player.exit_code == 0
    assert listener.headings
    assert any(file.name in problem for problem in player._bag.problems)


@pytest.mark.parametrize(
    ('parameters', 'error', 'reason'),
    [
        ({'bag': '{bag}x'}, BagError, 'no such bag'),
        ({'bag': '{bag}', 'topics': ['door/spread']}, BagError, 'no topic /trawl/door/spread'),
        ({'bag': '{bag}', 'start': 60.0}, BagError, 'expected an earlier start'),
        ({'bag': '{bag}', 'rate': 0.0}, TrawlError, 'found 0 without wait_for'),
        ({'bag': '{bag}', 'rate': -1.0}, TrawlError, 'rate'),
        ({}, TrawlError, 'parameter bag: missing'),
    ],
)
def test_what_cannot_be_played_is_an_error(graph, bag, parameters, error, reason):
    given = {
        key: value.format(bag=bag) if isinstance(value, str) else value
        for key, value in parameters.items()
    }
    with pytest.raises(error) as raised:
        graph.add(BagPlayer, **given)
    assert reason in str(raised.value)


def test_topics_of_others_are_recorded_when_asked_for(graph, bag, tmp_path):
    class Other(TrawlNode):
        def __init__(self, **kwargs):
            super().__init__('other', **kwargs)
            self.advertise('/elsewhere/heading', 'sensor_msgs/msg/Imu')

    path = tmp_path / 'others'
    recorder = graph.add(BagRecorder, output=str(path), topics=['/elsewhere/heading'])
    other = graph.add(Other)
    graph.until(lambda: other.subscribers()['/elsewhere/heading'][0])
    _, message = sample_message(HeadingSample(7 * SECOND, 0.5, 0.1))
    other.send('/elsewhere/heading', message)
    graph.until(lambda: recorder.traffic.total('received'))
    graph.remove(recorder)
    (raw,) = Bag(path).raw()
    assert (raw.topic, raw.log_time) == ('/elsewhere/heading', 7 * SECOND)
    assert raw.data == serialize(message)
