"""`trawl_sonar_node` gives what its instruments give, from all the truth it listens to."""

import math
from dataclasses import replace

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.gear.load import load_gear  # noqa: E402
from trawl_ros.instruments.errors.instrument import SeedPlan  # noqa: E402
from trawl_ros.instruments.parameters import load_instruments  # noqa: E402
from trawl_ros.instruments.trawl_sonar import SonarInstruments  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.commands import fault_command  # noqa: E402
from trawl_ros.messages.from_messages import to_sample  # noqa: E402
from trawl_ros.messages.stamps import stamp_of  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.messages.truth_to_messages import truth_messages  # noqa: E402
from trawl_ros.model.gear_model import GearModel  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.trawl_sonar_node import TrawlSonarNode  # noqa: E402
from trawl_ros.records.truth import SchoolTruth, SeabedTruth, Truth  # noqa: E402
from trawl_ros.scenario.sea import build_surroundings  # noqa: E402
from trawl_ros.simulation.command import Command  # noqa: E402
from trawl_ros.simulation.simulation import Simulation  # noqa: E402

pytestmark = pytest.mark.ros

SEED = 6


@pytest.fixture(scope='module')
def truths(model: GearModel) -> list[Truth]:
    """A net that goes ahead for 40 s, over a seabed and through a school."""
    start = Simulation(model, Command(300.0, 300.0, 2.1)).truth()
    school = SchoolTruth(
        start.net.sonar_position + [20.1, 3.3, -30.7], np.array([60.3, 20.2, 15.1]), 0.31
    )
    seabed = SeabedTruth(math.inf, start.net.headrope_depth + 110.0)
    found = []
    for k in range(81):
        way = np.array([2.1 * k / 2, 0.0, 0.0])
        net = replace(start.net, sonar_position=start.net.sonar_position + way)
        found.append(
            replace(start, stamp=k * SECOND // 2, net=net, schools=(school,), seabed=seabed)
        )
    return found


class Deck(TrawlNode):
    """Says what is true, and collects what the sonar makes of it."""

    def __init__(self, **kwargs):
        super().__init__('deck', **kwargs)
        self.heard = {topic: [] for topic in TrawlSonarNode.SAMPLES}
        for topic in (*TrawlSonarNode.TRUTH, 'command/fault'):
            self.advertise(topic)
        for topic, messages in self.heard.items():
            self.listen(topic, messages.append, CONSUMER)

    def tell(self, truth):
        for topic, message in truth_messages(truth):
            if topic in TrawlSonarNode.TRUTH:
                self.send(topic, message)

    def connected(self):
        return all(self.count_subscribers(f'/trawl/{t}') for t in TrawlSonarNode.TRUTH) and all(
            self.count_publishers(f'/trawl/{t}') for t in TrawlSonarNode.SAMPLES
        )


def on_deck(graph, gear_path, **parameters):
    deck = graph.add(Deck)
    graph.add(TrawlSonarNode, gear=str(gear_path), seed=SEED, **parameters)
    graph.until(deck.connected)
    graph.rest(0.5)
    return deck


@pytest.fixture
def deck(graph, gear_path):
    return on_deck(graph, gear_path)


def test_the_node_sends_byte_for_byte_what_the_instruments_give(graph, deck, truths, gear_path):
    instruments = SonarInstruments(
        load_instruments().sonar,
        SeedPlan(SEED),
        surroundings=build_surroundings(load_gear(gear_path)),
    )
    expected = {topic: [] for topic in TrawlSonarNode.SAMPLES}
    for truth in truths:
        for sample in instruments.observe(truth):
            topic, message = sample_message(sample)
            expected[topic].append(serialize(message))
    for truth in truths:
        deck.tell(truth)
        graph.rest(0.01)
    graph.until(
        lambda: all(len(deck.heard[topic]) >= len(sent) for topic, sent in expected.items())
    )
    graph.settle()
    heard = {topic: list(map(serialize, messages)) for topic, messages in deck.heard.items()}
    assert heard == expected
    assert len(heard['sonar/image']) == 2
    # The fish and the seabed have come through: without them there is less to see.
    image = to_sample('sonar/image', deck.heard['sonar/image'][0]).image
    assert (image[28:48, 325:] > 200).any()


def test_a_fault_by_command_silences_image_and_readings_and_goes_again(graph, deck, truths):
    deck.send(*fault_command('sonar/image', 'silent'))
    graph.rest(0.3)
    for truth in truths:
        deck.tell(truth)
    graph.until(lambda: len(deck.heard['sonar/pressure']) == 41)
    swept = [topic for topic in deck.heard if topic not in ('sonar/pressure', 'sonar/bottom')]
    assert not any(deck.heard[topic] for topic in swept)
    deck.send(*fault_command('sonar/image', 'none'))
    graph.rest(0.3)
    for truth in truths[:21]:
        later = replace(truth, stamp=truth.stamp + 45 * SECOND)
        deck.tell(later)
    graph.until(lambda: all(deck.heard[topic] for topic in swept))
    assert {stamp_of(deck.heard[topic][0]) for topic in swept} == {32 * SECOND}


def test_sweeps_are_stamped_at_their_end_where_asked(graph, truths, gear_path):
    deck = on_deck(graph, gear_path, sweep_stamp='end')
    swept = [topic for topic in deck.heard if topic not in ('sonar/pressure', 'sonar/bottom')]
    for truth in truths:
        deck.tell(truth)
        if any(deck.heard[topic] for topic in swept):
            break
        graph.rest(0.02)
    graph.until(lambda: all(deck.heard[topic] for topic in swept))
    sweep = round(SECOND / load_instruments().sonar.sweep.rate_hz)
    stamps = {stamp_of(deck.heard[topic][0]) for topic in swept}
    assert stamps == {sweep}
    # A ray has no time of its own, so nobody asks tf2 for the future.
    assert deck.heard['sonar/scan'][0].time_increment == 0.0
