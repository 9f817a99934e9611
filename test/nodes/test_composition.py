"""Nodes in one process work under each executor, and none ends another."""

import threading
import time
from functools import partial

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.callback_groups import ReentrantCallbackGroup  # noqa: E402
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.autopilot_node import AutopilotNode  # noqa: E402
from trawl_ros.nodes.autotrawl_node import AutotrawlNode  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.discrepancy_node import DiscrepancyNode  # noqa: E402
from trawl_ros.nodes.door_sensor_node import DoorSensorNode  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.nodes.nmea_out import NmeaOut  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.parameters import Number  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.runtime.run import NodeExecutor  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.trawl_sonar_node import TrawlSonarNode  # noqa: E402
from trawl_ros.nodes.trial_node import TrialNode  # noqa: E402
from trawl_ros.nodes.vessel_node import VesselNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.records.samples import HeadingSample  # noqa: E402

pytestmark = pytest.mark.ros

EXECUTORS = {
    'single': SingleThreadedExecutor,
    'multi': partial(MultiThreadedExecutor, num_threads=4),
    'events': NodeExecutor,
}
TOWED_S = 6.0
FOLLOWERS = (
    WinchNode, DoorSensorNode, TrawlSonarNode, VesselNode, TrialNode, IdentificationNode,
    DiscrepancyNode,
)  # fmt: skip
HEADING = 'vessel/heading'


@pytest.fixture(params=EXECUTORS.values(), ids=EXECUTORS)
def graph(request, open_graph):
    with open_graph(make_executor=request.param) as graph:
        yield graph


def serve(graph, during):
    """Spin from a thread, as an application does, and give what came out of the executor."""
    errors, over = [], threading.Event()

    def spin():
        try:
            while not over.is_set() and graph.context.ok():
                graph.executor.spin_once(timeout_sec=0.02)
        except Exception as reason:
            errors.append(reason)

    thread = threading.Thread(target=spin)
    thread.start()
    try:
        during()
    finally:
        over.set()
        thread.join()
    return errors


def test_all_nodes_of_a_tow_share_a_process(graph, gear_path, tmp_path):
    gear = str(gear_path)
    followers = [graph.add(kind, use_sim_time=True, gear=gear) for kind in FOLLOWERS]
    followers += [graph.add(kind, use_sim_time=True) for kind in (AutotrawlNode, AutopilotNode)]
    speaker = graph.add(NmeaOut, links=[f'pty:{tmp_path}/line'], use_sim_time=True)
    recorder = graph.add(BagRecorder, output=str(tmp_path / 'bag'), use_sim_time=True)
    waited_for = [node.get_name() for node in (*followers[:4], recorder)]
    simulation = graph.add(SimNode, gear=gear, time_scale=0.0, wait_for=waited_for)
    nodes = [*followers, speaker, recorder, simulation]
    graph.until(lambda: simulation._tow.time_s > TOWED_S, 60.0)
    assert graph.call('pause').success
    graph.settle()
    published = simulation.traffic.counts('published')
    for topic in ('/trawl/truth/winch', '/trawl/truth/door/port/odom', '/trawl/truth/gear'):
        graph.until(lambda topic=topic: recorder._bag.counts[topic] == published[topic])
    assert recorder._bag.counts['/trawl/winch/joint_states'] > TOWED_S
    for node in nodes:
        assert node.exit_code is None, node.get_name()
        assert not node._troubles, node.get_name()
        assert node.traffic.dropped == 0, node.get_name()
        assert node.traffic.counts('published')['/diagnostics'] > 0, node.get_name()


class Greeted(TrawlNode):
    """Reports in the middle of a callback that the other timer is queued behind."""

    def __init__(self, number, **kwargs):
        super().__init__(f'greeted_{number}', **kwargs)
        self.ticks = 0
        self.every(0.1, self._tick)

    def _tick(self):
        self.ticks += 1
        time.sleep(0.02)


def test_nodes_that_are_greeted_while_timers_are_queued_go_on(graph):
    nodes = [graph.add(partial(Greeted, number)) for number in range(6)]
    graph.until(lambda: all(node.ticks > 8 for node in nodes), 30.0)
    graph.until(
        lambda: all(node.traffic.counts('published')['/diagnostics'] >= 2 for node in nodes), 10.0
    )


class Talker(TrawlNode):
    def __init__(self, **kwargs):
        super().__init__('talker', **kwargs)
        self.stamp = 0
        self.advertise(HEADING)
        self.every(0.002, self._talk)

    def _talk(self):
        self.stamp += SECOND
        self.send(*sample_message(HeadingSample(self.stamp, 0.5, 0.01)))


class Fickle(TrawlNode):
    """Subscribes again and again, while messages are queued for the subscription before."""

    def __init__(self, **kwargs):
        super().__init__('fickle', **kwargs)
        self.heard = self.turns_taken = 0
        self._hear()
        self.every(0.01, self._again)

    def _hear(self):
        self.listen(HEADING, self._take, CONSUMER)

    def _take(self, message):
        self.heard += 1

    def _again(self):
        self.turns_taken += 1
        self.stop_listening(HEADING)
        # Parameters of the first subscription would be forced upon the next.
        self.listen_raw(
            HEADING, 'sensor_msgs/msg/Imu', self._take, CONSUMER, overridable=False
        )  # fmt: skip


def test_a_subscription_is_replaced_while_its_messages_are_queued(graph):
    graph.add(Talker)
    fickle = graph.add(Fickle)
    graph.until(lambda: fickle.turns_taken > 100 and fickle.heard, 60.0)
    assert not fickle._troubles


class Busy(TrawlNode):
    """Counts callbacks that run at once, and those after its work was finished."""

    SPECS = (Number('gain', 1.0, 'none', 0.0, 1e6, 'Set from another thread.', live=True),)

    def __init__(self, **kwargs):
        super().__init__('busy', **kwargs)
        self.inside = self.most = self.late = self.calls = 0
        self.finished = False
        # An application may ask for callbacks that run at once.
        self._default_callback_group = ReentrantCallbackGroup()
        self.listen(HEADING, self._work, CONSUMER)
        self.every(0.003, self._work)
        self.every(0.003, self._work)
        self.offer('work', self._answer)

    def parameter_changed(self, name):
        self._work()

    def _answer(self):
        self._work()
        return 'done'

    def _work(self, message=None):
        self.calls += 1
        self.late += self.finished
        self.inside += 1
        self.most = max(self.most, self.inside)
        time.sleep(0.001)
        self.inside -= 1

    def finish_work(self):
        self.finished = True
        self._work()
        self.late -= 1


def test_callbacks_take_turns_and_none_runs_after_the_end(graph):
    graph.add(Talker)
    busy = graph.add(Busy)
    client = busy.create_client(Trigger, 'work')

    def change():
        for number in range(100):
            busy.set_parameters([Parameter('gain', value=float(number))])
            client.call_async(Trigger.Request())
        until = time.monotonic() + 10.0
        while busy.calls < 300 and time.monotonic() < until:
            time.sleep(0.01)
        # Not taken out of its executor, which has callbacks of it in its queue.
        busy.close()
        time.sleep(0.1)

    assert not serve(graph, change)
    assert busy.calls >= 300
    assert (busy.most, busy.late) == (1, 0)
    assert not busy._troubles


def test_ros_is_shut_down_in_the_middle_of_callbacks(graph, tmp_path, gear_path, capfd):
    recorder = graph.add(BagRecorder, output=str(tmp_path / 'bag'))
    graph.add(DiscrepancyNode, gear=str(gear_path), output=str(tmp_path / 'report'))
    talker = graph.add(Talker)
    graph.until(lambda: talker.stamp > 50 * SECOND and sum(recorder._bag.counts.values()) > 20)
    nodes = list(graph.executor.get_nodes())
    errors = serve(graph, lambda: (graph.context.try_shutdown(), time.sleep(0.2)))
    # ROS names the end by its class, or in words where it comes before the wait.
    ends = 'Shutdown', 'rcl_shutdown() was called'
    assert [error for error in errors if not any(end in repr(error) for end in ends)] == []
    for node in nodes:
        node.destroy_node()
        assert not node._troubles
    said = capfd.readouterr().err
    assert 'Traceback' not in said
    assert 'an error of the program' not in said
    assert (tmp_path / 'bag' / 'metadata.yaml').exists()
