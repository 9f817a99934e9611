"""Who waits for topics that are published in another namespace is told which one."""

from dataclasses import replace

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import VESSEL_COMMAND, vessel_command  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.autotrawl_node import AutotrawlNode  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.discrepancy_node import DiscrepancyNode  # noqa: E402
from trawl_ros.nodes.graph.graph_checks import elsewhere  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.records.samples import RangeSample, WinchSample  # noqa: E402

pytestmark = pytest.mark.ros

SAMPLES = (
    WinchSample(0, (500.0, 500.0), (0.0, 0.0), (2e4, 2e4)),
    RangeSample(0, 'spread', 100.0, 1.0, 1.0, 300.0),
)


class Driver(TrawlNode):
    """Publishes winches and spread."""

    def __init__(self, **kwargs):
        super().__init__('driver', **kwargs)
        self.stamp = 0
        for sample in SAMPLES:
            self.advertise(*named(sample))
        self.every(0.1, self.tell)

    def tell(self):
        self.stamp += SECOND
        for sample in SAMPLES:
            self.send(*sample_message(replace(sample, stamp=self.stamp)))


def named(sample):
    topic, message = sample_message(sample)
    return topic, message.__msgtype__


def in_namespace(graph, kind, namespace, **parameters):
    return graph.add(lambda **kwargs: kind(namespace=namespace, **kwargs), **parameters)


def said(node):
    return '; '.join(status.message for status in node.all_statuses())


@pytest.mark.parametrize('kind', [IdentificationNode, DiscrepancyNode, AutotrawlNode])
@pytest.mark.parametrize('namespace', ['/ship', '/fleet/ship_2', '/'])
def test_the_namespace_of_a_driver_is_named(graph, kind, namespace):
    in_namespace(graph, Driver, namespace)
    mode = {'mode': 'lengths'} if kind is AutotrawlNode else {}
    node = graph.add(kind, **mode)
    graph.until(lambda: ' in /trawl, but the graph does in namespace' in said(node))
    messages, _, own, *_ = node.all_statuses()
    for status in (messages, own):
        assert f'in namespace {namespace}; expected one namespace' in status.message
        assert f'__ns:={namespace}' in status.message


def test_the_answer_to_finish_names_it_too(graph):
    in_namespace(graph, Driver, '/ship')
    node = graph.add(IdentificationNode)
    graph.until(lambda: 'in namespace /ship' in said(node))
    answer = graph.call('identification/finish')
    assert not answer.success
    assert 'no readings on ' in answer.message
    assert 'in namespace /ship' in answer.message


def test_consumers_that_report_in_another_namespace_are_found(graph, gear_path, tmp_path):
    simulation = graph.add(SimNode, gear=str(gear_path), wait_for=['bag_recorder'])
    in_namespace(graph, BagRecorder, '/ship', output=str(tmp_path / 'bag'))
    graph.until(lambda: 'sync/progress in /trawl, but' in simulation.statuses()[0].message)
    assert 'in namespace /ship' in simulation.statuses()[0].message


def test_commands_to_nobody_are_told_to_the_ship_but_those_of_another_ship_are_not(
    graph, gear_path
):
    simulation = graph.add(SimNode, gear=str(gear_path))
    helm = in_namespace(graph, lambda **kwargs: TrawlNode('helm', **kwargs), '/other')
    helm.advertise(VESSEL_COMMAND)
    helm.send(*vessel_command(0, 2.0, 0.0))
    graph.until(lambda: f'nobody publishes {VESSEL_COMMAND} in /trawl' in said(simulation))
    other = in_namespace(graph, lambda **kwargs: TrawlNode('other_ship', **kwargs), '/other')
    other.listen(VESSEL_COMMAND, lambda message: None, CONSUMER)
    graph.until(lambda: 'nobody publishes' not in said(simulation))


def test_nothing_is_said_of_another_ship_where_readings_come_in(graph):
    in_namespace(graph, Driver, '/other')
    in_namespace(graph, IdentificationNode, '/other')
    node = graph.add(IdentificationNode)
    graph.until(lambda: 'in namespace /other' in said(node))
    graph.add(Driver)
    graph.until(lambda: node.traffic.counts('received')['/trawl/door/spread'] > 1)
    assert elsewhere(node, node.subscribed) == ''


def test_a_topic_of_another_type_is_another_topic(graph):
    node = graph.add(IdentificationNode)
    stranger = in_namespace(graph, lambda **kwargs: TrawlNode('stranger', **kwargs), '/ship')
    stranger.advertise('door/spread', 'std_msgs/msg/Header')
    graph.until(lambda: node.count_publishers('/ship/door/spread'))
    graph.rest(0.3)
    assert elsewhere(node, node.subscribed) == ''
