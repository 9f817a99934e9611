"""Finite numbers that no tow and no instrument has are refused where they come in."""

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.diagnostics import OK, Status  # noqa: E402
from trawl_ros.messages.pieces import joint_state  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.autopilot_node import AutopilotNode  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.records.samples import VelocitySample  # noqa: E402

pytestmark = pytest.mark.ros


def give(node, topic, message):
    """Hand a node a message as the middleware does."""
    (entry,) = (one for one in node.subscriptions if one.topic_name == f'/trawl/{topic}')
    entry.callback(serialize(message), {'publication_sequence_number': 1})


def refused(node):
    (said,) = (status for status in node.all_statuses() if status.name == 'messages')
    return said.message


def test_truth_that_is_huge_gives_no_reading(graph):
    node = graph.add(WinchNode)
    columns = (np.array([300.0, 300.0]), np.zeros(2), np.array([1e300, 5e4]))
    give(node, 'truth/winch', joint_state(SECOND, 'truth/winch', *columns))
    assert 'truth/winch: sensor_msgs__msg__JointState.effort ' in (refused(node))
    assert node.traffic.counts('published')['/trawl/winch/joint_states'] == 0


def test_a_reading_that_cannot_be_does_not_steer(graph):
    node = graph.add(AutopilotNode)
    sample = VelocitySample(SECOND, 'ground', np.array([1e300, 0.0, 0.0]), 0.0)
    give(node, *sample_message(sample))
    assert 'vessel/velocity_ground: east ' in refused(node)


def test_what_a_node_says_is_bounded(graph):
    node = graph.add(lambda **kwargs: Talkative('talkative', **kwargs))
    (said,) = (status for status in node.all_statuses() if status.name == 'names')
    assert len(said.message) <= 1000
    assert len(said.values['all']) <= 1000


class Talkative(TrawlNode):
    def statuses(self):
        names = ', '.join(map(str, range(1000)))
        return [Status('names', OK, names, {'all': names})]
