"""Drivers that offer sensor data as best effort are heard by whoever asks for more."""

from dataclasses import replace

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data  # noqa: E402

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import VESSEL_COMMAND, vessel_command  # noqa: E402
from trawl_ros.messages.diagnostics import diagnostic_array  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.autopilot_node import AutopilotNode  # noqa: E402
from trawl_ros.nodes.autotrawl_node import AutotrawlNode  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.discrepancy_node import DiscrepancyNode  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.nodes.nmea_out import NmeaOut  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import LATCHED, STREAM  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.trial_node import IDENTIFICATION, TrialNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.records.samples import HeadingSample, RangeSample, WinchSample  # noqa: E402

pytestmark = pytest.mark.ros

WINCH = WinchSample(0, (500.0, 500.0), (0.0, 0.0), (2e4, 2e4))
SPREAD = RangeSample(0, 'spread', 100.0, 1.0, 1.0, 300.0)
HEADING = HeadingSample(0, 0.5, 0.01)


class Driver(TrawlNode):
    """Publishes one sample again and again with a profile of its own."""

    def __init__(self, name, profile, sample, **kwargs):
        super().__init__(name, **kwargs)
        self.sample = sample
        topic, message = sample_message(sample)
        self.advertise(topic, message.__msgtype__, profile)
        self.every(0.05, self.tell)

    def tell(self):
        self.sample = replace(self.sample, stamp=self.sample.stamp + SECOND)
        self.send(*sample_message(self.sample))


def drive(graph, name, profile, sample):
    return graph.add(lambda **kwargs: Driver(name, profile, sample, **kwargs))


@pytest.mark.parametrize(
    ('kind', 'sample'),
    [
        (IdentificationNode, WINCH),
        (DiscrepancyNode, SPREAD),
        (AutotrawlNode, WINCH),
        (AutopilotNode, HEADING),
        (NmeaOut, SPREAD),
        (BagRecorder, HEADING),
    ],
)
def test_a_driver_with_the_qos_of_sensor_data_is_heard(graph, tmp_path, kind, sample):
    given = {'output': str(tmp_path / 'bag')} if kind is BagRecorder else {}
    given |= {'links': [f'pty:{tmp_path}/line']} if kind is NmeaOut else {}
    node = graph.add(kind, **given)
    lossy = drive(graph, 'driver', qos_profile_sensor_data, sample)
    topic = node.full_name(sample_message(sample)[0])

    def heard():
        return node.traffic.counts('received')[topic]

    graph.until(lambda: heard() > 2)
    assert not node._troubles
    # A reliable driver in its place is heard too.
    graph.remove(lossy)
    before = heard()
    drive(graph, 'other_driver', STREAM, sample)
    graph.until(lambda: heard() > before + 2)


def test_instruments_hear_a_truth_of_best_effort(graph, gear_path):
    winches = graph.add(WinchNode, gear=str(gear_path))

    class Lossy(SimNode):
        def advertise(self, topic, type_name=None, profile=None):
            lossy = qos_profile_sensor_data if 'truth' in topic else profile
            return super().advertise(topic, type_name, lossy)

    graph.add(Lossy, gear=str(gear_path))
    graph.until(lambda: winches.traffic.counts('published')['/trawl/winch/joint_states'] > 2)


def test_a_ship_obeys_commands_of_best_effort(graph, gear_path):
    simulation = graph.add(SimNode, gear=str(gear_path))
    helm = graph.add(lambda **kwargs: TrawlNode('helm', **kwargs))
    helm.advertise(VESSEL_COMMAND, None, qos_profile_sensor_data)
    helm.every(0.1, lambda: helm.send(*vessel_command(0, 2.3, 0.0)))
    graph.until(lambda: simulation._tow.simulation.command.speed == 2.3)


def test_a_latched_topic_is_heard_from_one_who_does_not_keep_it(graph):
    trial = graph.add(TrialNode)
    estimator = graph.add(lambda **kwargs: TrawlNode('estimator', **kwargs))
    volatile = QoSProfile(depth=1, durability=DurabilityPolicy.VOLATILE)
    assert LATCHED.durability != volatile.durability
    estimator.advertise(IDENTIFICATION, None, volatile)
    estimator.every(0.1, lambda: estimator.send(IDENTIFICATION, diagnostic_array(SECOND, [])))
    graph.until(lambda: trial.traffic.counts('received')[trial.full_name(IDENTIFICATION)] > 2)
