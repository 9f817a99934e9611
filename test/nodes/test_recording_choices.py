"""What the recorder takes, how it says what was offered, and into how many files it writes."""

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

import numpy as np  # noqa: E402
import yaml  # noqa: E402
from mcap.reader import make_reader  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: E402
from rosbags.interfaces import QosDurability, QosReliability  # noqa: E402
from rosbags.rosbag2 import Reader  # noqa: E402

from trawl_ros.bags.reader import Bag  # noqa: E402
from trawl_ros.core.errors import TrawlError  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.runtime.credit import IDLE_S  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER, STREAM  # noqa: E402
from trawl_ros.records.samples import HeadingSample, WinchSample  # noqa: E402

pytestmark = pytest.mark.ros

IMU = 'sensor_msgs/msg/Imu'
BEST_EFFORT = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(
    depth=3,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class Source(TrawlNode):
    """Publishes headings on topics with profiles of their own."""

    def __init__(self, offers, name='source', **kwargs):
        super().__init__(name, **kwargs)
        self.offers = offers
        for topic, profile in offers.items():
            self.advertise(topic, IMU, profile)

    def tell(self, topic, stamp):
        self.send(topic, sample_message(HeadingSample(stamp, 0.5, 0.1))[1])

    def heard(self):
        return all(matched for matched, _ in self.subscribers().values())


def source(graph, offers, **parameters):
    return graph.add(lambda **kwargs: Source(offers, **kwargs), **parameters)


def record(graph, path, offers, stamps=(7 * SECOND,), **parameters):
    """Record what a source says on each of its topics, and give the bag."""
    recorder = graph.add(BagRecorder, output=str(path), **parameters)
    node = source(graph, offers)
    graph.until(node.heard)
    for stamp in stamps:
        for topic in offers:
            node.tell(topic, stamp)
    wanted = len(stamps) * len(offers)
    graph.until(lambda: recorder.traffic.total('received') >= wanted)
    graph.until(lambda: sum(count_of(recorder, topic) for topic in offers) == wanted)
    graph.remove(recorder)
    graph.remove(node)
    return Bag(path)


def count_of(recorder, topic):
    return recorder._bag.counts.get(recorder.full_name(topic), 0)


def test_the_bag_says_what_publishers_really_offer(graph, tmp_path):
    offers = {
        '/lab/fast': BEST_EFFORT,
        '/lab/kept': LATCHED,
        # A topic of the project, offered otherwise than the project does it.
        'vessel/heading': BEST_EFFORT,
    }
    bag = record(graph, tmp_path / 'bag', offers, topics=[*offers])
    found = {topic: profiles[0] for topic, profiles in bag.offered().items()}
    policies = {topic: (qos.reliability, qos.durability) for topic, qos in found.items()}
    best_effort = (QosReliability.BEST_EFFORT, QosDurability.VOLATILE)
    assert policies == {
        '/lab/fast': best_effort,
        '/lab/kept': (QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL),
        '/trawl/vessel/heading': best_effort,
    }
    with Reader(bag.path) as reader:
        assert sum(1 for _ in reader.messages()) == 3


def test_what_was_recorded_is_offered_again_also_to_those_who_come_late(graph, tmp_path):
    offers = {'/lab/fast': BEST_EFFORT, '/lab/kept': LATCHED}
    bag = record(graph, tmp_path / 'bag', offers, topics=[*offers])
    player = graph.add(BagPlayer, bag=str(bag.path), start_paused=True)
    graph.until(lambda: player._began)
    graph.call('/trawl/bag_player/play_next')
    graph.call('/trawl/bag_player/play_next')

    class Late(TrawlNode):
        def __init__(self, **kwargs):
            super().__init__('late', **kwargs)
            self.kept, self.fast = [], []
            self.listen('/lab/kept', self.kept.append, LATCHED, IMU)
            self.listen('/lab/fast', self.fast.append, BEST_EFFORT, IMU)

    late = graph.add(Late)
    graph.until(lambda: late.kept)
    graph.rest(0.3)
    assert (len(late.kept), late.fast) == (1, [])
    (fast,), (kept,) = map(late.get_publishers_info_by_topic, offers)
    assert fast.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
    assert kept.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL


def test_an_override_by_parameter_is_what_the_bag_says_and_stays_with_its_topic(graph, tmp_path):
    path = tmp_path / 'bag'
    recorder = graph.add(BagRecorder, output=str(path))
    override = {'qos_overrides./trawl/vessel/heading.publisher.reliability': 'best_effort'}
    node = source(graph, {'vessel/heading': STREAM, 'door/port/attitude': STREAM}, **override)
    graph.until(node.heard)
    for topic in node.offers:
        node.tell(topic, SECOND)
    graph.until(lambda: all(count_of(recorder, topic) for topic in node.offers))
    graph.remove(recorder)
    found = {topic: profile[0].reliability for topic, profile in Bag(path).offered().items()
             if topic != '/diagnostics'}  # fmt: skip
    assert found == {
        '/trawl/vessel/heading': QosReliability.BEST_EFFORT,
        '/trawl/door/port/attitude': QosReliability.RELIABLE,
    }
    assert STREAM.reliability == CONSUMER.reliability == ReliabilityPolicy.RELIABLE


@pytest.mark.parametrize(
    ('parameters', 'taken'),
    [
        ({'topics': ['all']}, {'/lab/a', '/lab/b', '/trawl/vessel/heading'}),
        ({'topics': ['all'], 'exclude_regex': '/lab/'}, {'/trawl/vessel/heading'}),
        ({'regex': '^/lab/.$'}, {'/lab/a', '/lab/b'}),
        ({'regex': '^/lab/.$', 'exclude_regex': 'b$'}, {'/lab/a'}),
        ({'topics': ['vessel/heading'], 'regex': '/b'}, {'/lab/b', '/trawl/vessel/heading'}),
        ({}, {'/trawl/vessel/heading'}),
    ],
    ids=['all', 'all but', 'regex', 'regex but', 'named and regex', 'those of the project'],
)
def test_topics_are_chosen_by_name_and_by_pattern(graph, tmp_path, parameters, taken):
    recorder = graph.add(BagRecorder, output=str(tmp_path / 'bag'), **parameters)
    offers = dict.fromkeys(('/lab/a', '/lab/b', 'vessel/heading'), STREAM)
    node = source(graph, offers)
    graph.until(lambda: sum(bool(n) for n, _ in node.subscribers().values()) == len(taken))
    for topic in offers:
        node.tell(topic, SECOND)
    graph.until(lambda: taken <= set(recorder._bag.counts))
    graph.rest(0.2)
    assert set(recorder._bag.counts) - {'/diagnostics'} == taken


def test_a_pattern_that_is_none_is_refused(graph, tmp_path):
    with pytest.raises(TrawlError, match=r"parameter regex: found '\('"):
        graph.add(BagRecorder, output=str(tmp_path / 'bag'), regex='(')
    assert not (tmp_path / 'bag').exists()


def test_a_long_recording_goes_into_several_files(graph, tmp_path):
    stamps = [number * SECOND for number in range(1, 26)]
    bag = record(
        graph,
        tmp_path / 'bag',
        {'vessel/heading': STREAM},
        stamps,
        topics=['vessel/heading'],
        max_bag_duration=10,
        compression='lz4',
    )
    information = yaml.safe_load((bag.path / 'metadata.yaml').read_text())
    files = information['rosbag2_bagfile_information']['files']
    assert [(f['path'], f['message_count']) for f in files] == [
        ('bag_0.mcap', 11),
        ('bag_1.mcap', 11),
        ('bag_2.mcap', 3),
    ]
    assert [message.log_time for message in bag.raw()] == stamps
    with Reader(bag.path) as reader:
        assert [stamp for _, stamp, _ in reader.messages()] == stamps
    with (bag.path / 'bag_1.mcap').open('rb') as stream:
        assert make_reader(stream).get_summary().chunk_indexes[0].compression == 'lz4'


def test_diagnostics_by_another_clock_than_the_tow_do_not_tear_the_bag_apart(graph, tmp_path):
    recorder = graph.add(
        BagRecorder, output=str(tmp_path / 'bag'), max_bag_duration=600.0, use_sim_time=True
    )
    # Its diagnostics carry the time of the wall.
    teller = source(graph, {'vessel/heading': STREAM})
    graph.until(teller.heard)
    before = recorder.traffic.counts('received').get('/diagnostics', 0)
    for second in range(1, 4):
        teller.tell('vessel/heading', second * SECOND)
        graph.until(
            lambda: recorder.traffic.counts('received').get('/diagnostics', 0) > before + second  # noqa: B023
        )
    recorder.finish_work()
    assert len(recorder._bag.files) == 1


@pytest.mark.parametrize('truth', [False, True])
def test_a_recorder_that_has_heard_readings_alone_is_not_waited_for(graph, tmp_path, truth):
    recorder = graph.add(BagRecorder, output=str(tmp_path / 'bag'))
    node = source(graph, {'vessel/heading': STREAM})
    node.advertise('truth/winch')
    graph.until(node.heard)
    if truth:
        winch = WinchSample(7 * SECOND, np.zeros(2), np.zeros(2), np.zeros(2))
        node.send('truth/winch', sample_message(winch)[1])
    node.tell('vessel/heading', 7 * SECOND)
    graph.until(lambda: recorder._progress.stamp == 7 * SECOND)
    graph.rest(1.5 * IDLE_S)
    # Otherwise a simulation that has gone on meanwhile would wait for what never comes.
    assert (recorder._progress.stamp > 7 * SECOND) is not truth
    graph.remove(recorder)
    graph.remove(node)
