"""`bag_player` plays what it is asked to, at the pace it is asked for, and ends by itself."""

import time

import pytest
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.qos import DurabilityPolicy  # noqa: E402

from trawl_ros.bags.reader import Bag  # noqa: E402
from trawl_ros.bags.storage.qos import project_profile  # noqa: E402
from trawl_ros.bags.storage.stored import Definition  # noqa: E402
from trawl_ros.bags.writer import BagWriter  # noqa: E402
from trawl_ros.core.errors import BagError, TrawlError  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.cdr import STORE, message_definition, serialize  # noqa: E402
from trawl_ros.messages.stamps import from_time, stamp_of  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer, main  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.runtime.credit import ConsumerProgress  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.records.samples import HeadingSample, PressureSample  # noqa: E402
from trawl_ros.records.topics import absolute  # noqa: E402

pytestmark = pytest.mark.ros

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


def finish(graph, player):
    """Play to the end, and let those hear it who share the executor."""
    graph.until(lambda: player.exit_code is not None)
    graph.settle()


def times(messages):
    return [(stamp_of(message) - START * SECOND) / SECOND for message in messages]


def test_it_plays_at_its_rate_with_a_clock_and_ends(graph, bag):
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), rate=2)
    graph.until(lambda: listener.headings)
    began = time.monotonic()
    graph.until(lambda: len(listener.headings) == COUNT)
    assert time.monotonic() - began > 0.9 * (COUNT - 1) / HZ / 2, 'no faster than it should'
    finish(graph, player)
    assert player.exit_code == 0
    assert times(listener.headings) == pytest.approx([n / HZ for n in range(COUNT)])
    assert len(listener.pressures) == COUNT
    assert [from_time(c.clock) for c in listener.clocks] == list(map(stamp_of, listener.headings))


class Busy(TrawlNode):
    """Consumer that takes long to deal with a heading in the middle of the bag."""

    LONG_S = 4.0

    def __init__(self, **kwargs):
        super().__init__('busy', **kwargs)
        self.heard, self.until, self.ahead = [], 0.0, None
        self.progress = ConsumerProgress(self, busy=lambda: self.until > 0 and self.ahead is None)
        self.listen('vessel/heading', self._take, CONSUMER)
        self.every(0.1, self._look)

    def _take(self, message):
        self.heard.append(stamp_of(message))
        if len(self.heard) == COUNT // 2:
            self.until = time.monotonic() + self.LONG_S
        elif not self.until:
            self.progress.done(self.heard[-1])

    def _look(self):
        if self.until and time.monotonic() > self.until:
            self.ahead = len(self.heard) if self.ahead is None else self.ahead
            self.progress.done(self.heard[-1])


def test_a_consumer_that_is_busy_for_long_is_waited_for(graph, bag):
    # It heard the rest of the bag meanwhile once, topic by topic, and had to refuse it.
    busy = graph.add(Busy)
    player = graph.add(BagPlayer, bag=str(bag), rate=0.0, wait_for=['busy'], lead_s=0.5)
    finish(graph, player)
    assert busy.ahead <= COUNT // 2 + 0.5 * HZ + 1
    assert len(busy.heard) == COUNT


def test_only_what_is_asked_for_is_played(graph, bag):
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), topics=['sonar/pressure'], start=1, rate=1)
    finish(graph, player)
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
    assert 'one tow' in status.message


def test_what_is_readable_of_a_cut_bag_is_played(graph, bag):
    (file,) = bag.glob('*.mcap')
    file.write_bytes(file.read_bytes()[:-200])
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), rate=40)
    finish(graph, player)
    assert player.exit_code == 0
    assert listener.headings
    assert any(file.name in problem for problem in player._bag.problems)


@pytest.mark.parametrize(
    ('parameters', 'error', 'reason'),
    [
        ({'bag': '{bag}x'}, BagError, 'no such bag'),
        ({'bag': '{bag}', 'topics': ['door/spread']}, BagError, 'no topic /trawl/door/spread'),
        ({'bag': '{bag}', 'start': 60.0}, BagError, 'expected an earlier start'),
        ({'bag': '{bag}', 'start': 1.0, 'end': 0.5}, TrawlError, 'start (1)'),
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


def test_it_ends_where_it_is_asked_to(graph, bag):
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), start=0.45, end=1.2)
    finish(graph, player)
    assert player.exit_code == 0
    assert times(listener.headings) == pytest.approx([n / HZ for n in range(5, 13)])


def test_a_loop_repeats_the_stretch_that_is_asked_for(graph, bag):
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), start=1.0, end=1.2, rate=20, loop=True)
    graph.until(lambda: len(listener.headings) >= 9)
    assert times(listener.headings)[:9] == pytest.approx([1.0, 1.1, 1.2] * 3)
    player.parameters._values['loop'] = False
    finish(graph, player)


def test_it_pauses_plays_one_by_one_and_goes_on(graph, bag):
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(bag), start_paused=True)

    def asked(service):
        return graph.call(f'/trawl/bag_player/{service}')

    graph.until(lambda: player._began)
    graph.rest(0.2)
    assert not listener.headings
    assert asked('play_next').message.startswith('played /trawl/vessel/heading ')
    assert asked('play_next').message.startswith('played /trawl/sonar/pressure ')
    graph.until(lambda: listener.pressures)
    assert player.statuses()[0].message == 'paused'
    assert asked('toggle_paused').success
    graph.until(lambda: len(listener.headings) >= 4)
    assert asked('pause').success
    graph.rest(0.1)
    count = len(listener.headings)
    graph.rest(0.3)
    assert len(listener.headings) == count
    assert asked('resume').success
    assert not asked('play_next').success
    finish(graph, player)
    assert times(listener.headings) == pytest.approx([n / HZ for n in range(COUNT)])


def test_topics_are_remapped_one_by_one(graph, bag):
    class Elsewhere(TrawlNode):
        def __init__(self, **kwargs):
            super().__init__('elsewhere', **kwargs)
            self.headings, self.pressures = [], []
            self.listen('/mast/heading', self.headings.append, CONSUMER, 'sensor_msgs/msg/Imu')
            self.listen('sonar/pressure', self.pressures.append, CONSUMER)

    listener = graph.add(Elsewhere)
    rules = ['--ros-args', '-r', 'vessel/heading:=/mast/heading']
    player = graph.add(
        lambda **kwargs: BagPlayer(cli_args=rules, **kwargs),
        bag=str(bag),
        topics=['vessel/heading', 'sonar/pressure'],
        rate=10,
    )
    finish(graph, player)
    assert (len(listener.headings), len(listener.pressures)) == (COUNT, COUNT)


def test_a_bag_whose_metadata_and_content_disagree_is_refused_with_the_reason(bag, capsys):
    path = bag / 'metadata.yaml'
    path.write_text(path.read_text().replace('message_count: 20', 'message_count: 19'))
    code = main(['bag_player', '--ros-args', '-p', f'bag:={bag}'])
    assert code == 1
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert line.startswith('bag_player: ')
    assert '19 messages of sensor_msgs/msg/' in line
    assert 'the data has 20' in line


def write_strange(bag, topic, type_name, text):
    """Add to a copy of a bag one message of a type as its definition has it."""
    path = bag.parent / 'strange'
    with BagWriter(path) as writer:
        for message in Bag(bag).raw():
            writer.write(message.topic, message.type, message.data, message.log_time)
        writer.declare(topic, Definition(type_name, 'cdr', 'ros2msg', text.encode()))
        writer.write(topic, type_name, b'\x00\x01\x00\x00' + bytes(8), START * SECOND)
    return path


OLDER = message_definition('sensor_msgs/msg/Range').replace('float32 variance\n', '')


@pytest.mark.parametrize(
    ('type_name', 'text', 'reason'),
    [
        ('lab_msgs/msg/Thing', 'float64 weight', 'no installed package'),
        ('sensor_msgs/msg/Range', OLDER, 'another type'),
    ],
    ids=['unknown type', 'older definition'],
)
def test_what_subscribers_here_could_not_read_is_left_out_and_said(
    graph, bag, type_name, text, reason
):
    strange = write_strange(bag, '/lab/thing', type_name, text)
    listener = graph.add(Listener)
    player = graph.add(BagPlayer, bag=str(strange), rate=10)
    assert '/lab/thing ' in player.statuses()[0].message
    assert reason in player.statuses()[0].message
    finish(graph, player)
    assert len(listener.headings) == COUNT
    assert not player.get_publishers_info_by_topic('/lab/thing')
    with pytest.raises(BagError, match='/lab/thing '):
        graph.add(BagPlayer, bag=str(strange), topics=['/lab/thing'])


def test_the_qos_of_version_9_is_offered_again(graph, tmp_path, bag):
    path = tmp_path / 'nine'
    with RosbagsWriter(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, profile in (('/lab/kept', project_profile(True)), ('/lab/plain', None)):
            offered = [profile] if profile else []
            connection = writer.add_connection(
                topic, 'sensor_msgs/msg/Imu', typestore=STORE, offered_qos_profiles=offered
            )
            message = sample_message(HeadingSample(START * SECOND, 0.5, 0.1))[1]
            writer.write(connection, START * SECOND, serialize(message))
    player = graph.add(BagPlayer, bag=str(path))
    durabilities = [
        player.get_publishers_info_by_topic(topic)[0].qos_profile.durability
        for topic in ('/lab/kept', '/lab/plain')
    ]
    assert durabilities == [DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE]


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
