"""A graph for tests of other people's nodes: its waits, commands, faults, and what it says."""

import time
from functools import partial

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.node import Node  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import Header  # noqa: E402

from trawl_ros.core.errors import TrawlError  # noqa: E402
from trawl_ros.testing import open_graph  # noqa: E402

pytestmark = pytest.mark.ros


class Echo(Node):
    """A node as others write it, which answers the winches on a topic of its own."""

    def __init__(self, **kwargs):
        super().__init__('echo', namespace='trawl', **kwargs)
        self.frame = self.declare_parameter('frame', 'echo').value
        self.sender = self.create_publisher(Header, 'answer', 10)
        self.create_subscription(JointState, 'winch/joint_states', self.answer, 100)

    def answer(self, winches):
        self.sender.publish(Header(stamp=winches.header.stamp, frame_id=self.frame))


@pytest.fixture(scope='module')
def tow(coarse_gear):
    return {
        'description': 'A short tow',
        'gear': str(coarse_gear),
        'start': {'warp_length_m': 300.0, 'speed_m_s': 2.1},
        'steps': [{'name': 'tow', 'minutes': 60.0}],
    }


@pytest.fixture(scope='module')
def graph(tow):
    with open_graph(['winch_node', Echo], tow) as graph:
        yield graph


# The tests share the graph, in the order of one tow.


def test_it_records_from_the_first_message_on(graph):
    truth = graph.record('truth/winch')
    graph.wait(3.0)
    assert truth.times[0] == 0.0
    assert np.diff(truth.times) == pytest.approx(0.1)
    assert truth.values(lambda message: message.position, since_s=1.0).shape == (len(truth) - 10, 2)
    assert graph.record('truth/winch') is truth


def test_a_node_of_others_works_in_simulated_time_on_topics_of_its_own(graph):
    answers = graph.record('answer', 'std_msgs/msg/Header')
    begun = graph.time_s
    graph.until(lambda: len(answers) > 4)
    assert graph.time_s - begun < 10.0
    assert answers.latest.frame_id == 'echo'
    other = graph.add(Echo, frame='other')
    assert other.get_parameter('use_sim_time').value
    graph.until(lambda: answers.latest.frame_id == 'other')
    graph.remove(other)


def test_a_command_moves_the_winches_of_a_scenario(graph):
    truth = graph.record('truth/winch')
    graph.command_winches(302.0, float('nan'))
    graph.wait(10.0)
    assert list(truth.latest.position) == pytest.approx([302.0, 300.0], abs=0.1)


def test_a_fault_is_switched(graph):
    winches = graph.record('winch/joint_states')
    graph.wait(1.0)
    graph.fault('winch/joint_states/port/tension', 'lost')
    graph.until(lambda: np.isnan(winches.latest.effort[0]))
    graph.fault('winch/joint_states/port/tension', 'none')
    graph.until(lambda: np.isfinite(winches.latest.effort[0]))


def test_a_wait_that_fails_says_what_was_not_heard(graph):
    spread = graph.record('door/spread')
    with pytest.raises(AssertionError) as raised:
        graph.until(lambda: len(spread), 2.0)
    assert '2 s of simulated time' in str(raised.value)
    assert '/trawl/door/spread: nothing heard; nobody publishes it' in str(raised.value)
    with pytest.raises(AssertionError, match='nobody publishes it'):
        _ = spread.latest
    with pytest.raises(AssertionError, match='nothing since 99999 s'):
        graph.record('truth/winch').values(lambda message: message.effort, since_s=99999.0)


def test_a_service_is_called(graph):
    assert graph.call('pause').success
    paused = graph.time_s
    graph.rest(0.3)
    assert graph.time_s == pytest.approx(paused, abs=1.0)
    assert graph.call('resume').success
    graph.wait(1.0)


@pytest.mark.parametrize('name', ['winsh_node', 'starting'])
def test_a_name_of_no_node_is_an_error(trawl_graph, name):
    with pytest.raises(TrawlError, match=f'{name}: .* expected a name such as winch_node'):
        trawl_graph([name])


def test_without_a_scenario_a_wait_is_in_wall_time(trawl_graph):
    graph = trawl_graph([partial(Node, 'somebody')])
    with pytest.raises(AssertionError, match='0 s of wall time'):
        graph.until(lambda: False, 0.2)


def test_a_node_that_compiles_for_long_does_not_stand_still(trawl_graph):
    graph = trawl_graph([])
    busy, done = Node('busy', context=graph.context), []

    def compile_loops():
        time.sleep(3.0)
        done.append(1)

    busy.create_timer(0.01, compile_loops)
    graph.executor.add_node(busy)
    graph.until(lambda: len(done) == 2, timeout_s=2.5)


def test_nodes_of_the_package_run_as_processes(trawl_graph, tow):
    graph = trawl_graph(['winch_node', Echo], tow, processes=True)
    answers = graph.record('answer', 'std_msgs/msg/Header')
    graph.until(lambda: len(answers) > 3, 30.0)
    assert 'winch_node' not in {node.get_name() for node in graph.executor.get_nodes()}
