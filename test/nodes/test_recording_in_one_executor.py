"""The whole graph in one executor: towed, measured, recorded, and played back."""

import os
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from mcap.reader import make_reader  # noqa: E402
from rosbags.rosbag2 import Reader  # noqa: E402

from trawl_ros.bags.reader import Bag  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.instruments.suite import InstrumentSuite  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.from_messages import SAMPLE_TOPICS, to_sample  # noqa: E402
from trawl_ros.messages.truth_to_messages import truth_messages  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.door_sensor_node import DoorSensorNode  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.trawl_sonar_node import TrawlSonarNode  # noqa: E402
from trawl_ros.nodes.vessel_node import VesselNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.records.topics import TWINS, absolute  # noqa: E402
from trawl_ros.scenario.run import Trial  # noqa: E402
from trawl_ros.scenario.scenario import load_scenario  # noqa: E402

pytestmark = pytest.mark.ros

INSTRUMENTS = (WinchNode, DoorSensorNode, TrawlSonarNode, VesselNode)
TRUTHS = 241


@pytest.fixture(scope='module')
def tow(open_graph, scenario_path, tmp_path_factory):
    """The bag of one tow as fast as the graph follows, and what each publisher has counted."""
    path = tmp_path_factory.mktemp('tow') / 'bag'
    scenario = str(scenario_path)
    with open_graph() as graph:
        graph.add(BagRecorder, output=str(path), use_sim_time=True)
        instruments = [
            graph.add(kind, scenario=scenario, use_sim_time=True, wait_for=['bag_recorder'])
            for kind in INSTRUMENTS
        ]
        names = ['bag_recorder', *(node.get_name() for node in instruments)]
        simulation = graph.add(
            SimNode, scenario=scenario, time_scale=0.0, exit_at_end=True, wait_for=names
        )
        graph.until(lambda: simulation.exit_code is not None)
        graph.settle()
        published = Counter()
        for node in (simulation, *instruments):
            published.update(node.traffic.counts('published'))
    return SimpleNamespace(path=path, published=published, exit_code=simulation.exit_code)


def of_the_tow(counts):
    twins = (absolute(topic.name) for topic in TWINS)
    left_out = ('/clock', '/diagnostics', '/trawl/sync/progress', *twins)
    return {topic: count for topic, count in counts.items() if count and topic not in left_out}


def test_the_simulation_ends_with_the_scenario(tow):
    assert tow.exit_code == 0
    assert tow.published['/trawl/truth/winch'] == TRUTHS
    assert tow.published['/clock'] == TRUTHS
    assert tow.published['/trawl/truth/gear'] == 25


def test_not_one_message_is_lost(tow):
    recorded = Counter(raw.topic for raw in Bag(tow.path).raw())
    del recorded['/diagnostics']
    assert recorded == of_the_tow(tow.published)
    # No ship of these has a slant range.
    expected = {absolute(name) for name in SAMPLE_TOPICS if not name.endswith('slant_range')}
    assert expected <= set(recorded)


def test_the_clock_stays_out_of_the_bag(tow):
    assert '/clock' not in Bag(tow.path).topics


def test_rosbags_and_mcap_read_the_counts_of_the_metadata(tow):
    with Reader(tow.path) as reader:
        stated = {c.topic: c.msgcount for c in reader.connections}
        read = Counter(connection.topic for connection, _, _ in reader.messages())
    assert read == stated
    (file,) = tow.path.glob('*.mcap')
    with file.open('rb') as stream:
        by_mcap = Counter(channel.topic for _, channel, _ in make_reader(stream).iter_messages())
    assert by_mcap == stated


def test_messages_are_logged_at_their_stamps(tow):
    for received in Bag(tow.path).messages({'/trawl/truth/winch', '/trawl/door/spread'}):
        header = received.message.header
        assert received.log_time == header.stamp.sec * SECOND + header.stamp.nanosec


def test_the_data_are_those_of_one_process(tow, scenario_path):
    scenario = load_scenario(scenario_path)
    trial = Trial(scenario)
    suite = InstrumentSuite(
        scenario.instruments, surroundings=scenario.surroundings, draws=scenario.draws
    )
    sensor_effects = scenario.sensor_effects()
    truth, samples = {}, {}
    while (instant := trial.step()) is not None:
        for topic, message in truth_messages(instant):
            truth.setdefault(absolute(topic), []).append(serialize(message))
        for sample in map(sensor_effects, suite.observe(instant)):
            samples.setdefault(type(sample).__name__, []).append(sample)
    recorded = {}
    for raw in Bag(tow.path).raw(truth):
        recorded.setdefault(raw.topic, []).append(raw.data)
    assert recorded == truth
    names = {absolute(name): name for name in SAMPLE_TOPICS}
    measured = {}
    for received in Bag(tow.path).messages(names):
        sample = to_sample(names[received.topic], received.message)
        measured.setdefault(type(sample).__name__, []).append(sample)
    for kind, expected in samples.items():
        assert same(sorted(measured[kind], key=repr), sorted(expected, key=repr)), kind


def same(found, expected):
    """Equal but for the last bits, which headings lose on the way through a quaternion.

    The stated errors of velocities are in their twins with covariance alone.
    """
    flat = [
        [
            value
            for sample in listed
            for value in numbers(part for name, part in vars(sample).items() if name != 'stated')
        ]
        for listed in (found, expected)
    ]
    return len(found) == len(expected) and flat[0] == pytest.approx(
        flat[1], rel=1e-6, abs=1e-9, nan_ok=True
    )


def numbers(values):
    for value in values:
        if isinstance(value, (int, float)):
            yield value
        elif isinstance(value, np.ndarray):
            yield from value.ravel().tolist()
        elif not isinstance(value, str):
            yield from numbers(value)


def test_the_player_gives_the_bag_back_message_for_message(tow, open_graph, tmp_path):
    copy = tmp_path / 'copy'
    with open_graph() as graph:
        graph.add(BagRecorder, output=str(copy))
        player = graph.add(BagPlayer, bag=str(tow.path), rate=0.0, wait_for=['bag_recorder'])
        # What the nodes say of themselves now is not what was recorded.
        topics = sorted(set(Bag(tow.path).topics) - {'/diagnostics'})
        graph.until(lambda: player.exit_code is not None)
        assert player.exit_code == 0
        graph.settle()
    assert contents(copy, topics) == contents(tow.path, topics)


def contents(path, topics):
    found = {}
    for raw in Bag(path).raw(set(topics)):
        found.setdefault((raw.topic, raw.type), []).append((raw.log_time, raw.data))
    return found


def test_discovery_stays_on_this_machine():
    assert os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] == 'LOCALHOST'
