"""Who comes late, who speaks another quality of service, what gets lost, a clock set back."""

import os
import subprocess
import sys

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.qos import DurabilityPolicy, QoSProfile  # noqa: E402

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.diagnostics import OK, WARN, read_statuses  # noqa: E402
from trawl_ros.messages.stamps import header, stamp_of  # noqa: E402
from trawl_ros.messages.truth_to_messages import clock_message  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.nodes.runtime import credit  # noqa: E402
from trawl_ros.nodes.runtime.credit import HEADER, SYNC  # noqa: E402
from trawl_ros.nodes.runtime.incoming import message_class  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.vessel_node import VesselNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402

pytestmark = pytest.mark.ros

WINCH = 'truth/winch'
TRANSIENT = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Lookout(TrawlNode):
    """Hears what nodes say of themselves."""

    def __init__(self, name='lookout', **kwargs):
        super().__init__(name, **kwargs)
        self.heard = {}
        self.listen('/diagnostics', self._hear, CONSUMER)

    def _hear(self, message):
        for status in read_statuses(message):
            self.heard[status.name] = status

    def message_of(self, name):
        status = self.heard.get(f'/trawl/{name}')
        return status.message if status else ''


class Late(TrawlNode):
    """Listens to truth and to the log from whenever it comes."""

    def __init__(self, **kwargs):
        super().__init__('late', **kwargs)
        self.truth, self.speeds = [], []
        self.listen(WINCH, self.truth.append, CONSUMER)
        self.listen('vessel/velocity_water', self.speeds.append, CONSUMER)


def test_who_comes_late_hears_what_follows_and_stops_nobody(graph, gear_path):
    lookout = graph.add(Lookout)
    first = graph.add(WinchNode, gear=str(gear_path), use_sim_time=True)
    simulation = graph.add(
        SimNode, gear=str(gear_path), warp_length_m=300, speed_m_s=2.1, time_scale=0.0,
        wait_for=['winch_node'],
    )  # fmt: skip
    graph.until(lambda: simulation._tow.time_s > 10.0)
    second = graph.add(VesselNode, gear=str(gear_path), use_sim_time=True)
    late = graph.add(Late, use_sim_time=True)
    begun = simulation._tow.time_s
    graph.until(lambda: len(late.speeds) > 5 and len(late.truth) > 50)
    assert stamp_of(late.truth[0]) >= begun * SECOND - SECOND
    stamps = [stamp_of(message) for message in late.truth]
    assert stamps == list(range(stamps[0], stamps[-1] + 1, SECOND // 10))
    for node in (first, second):
        assert node.traffic.dropped == 0, 'what was published before is not lost'
        assert node.traffic.total('received') > 50
    graph.until(lambda: lookout.message_of('vessel_node: instruments').startswith('every instant'))


def test_a_node_says_how_it_is_once_somebody_listens_and_its_clock_is_heard(graph, monkeypatch):
    monkeypatch.setattr('trawl_ros.nodes.runtime.node.DIAGNOSTICS_PERIOD_S', 600.0)
    lookout = graph.add(Lookout)
    graph.add(Late, use_sim_time=True)
    graph.until(lambda: lookout.message_of('lookout: clock') == 'system time')
    graph.rest(0.5)
    assert not lookout.message_of('late: clock')
    lookout.create_publisher(message_class('rosgraph_msgs/msg/Clock'), '/clock', 10)
    graph.until(lambda: lookout.message_of('late: clock') == 'simulated time')


class Consumer(TrawlNode):
    """Reports that it keeps up, until it falls silent."""

    def __init__(self, **kwargs):
        super().__init__('consumer', **kwargs)
        self.silent = False
        self.advertise(SYNC, HEADER)
        self.listen(WINCH, lambda message: self.report(stamp_of(message)), CONSUMER)
        self.every(0.2, lambda: self.report(0))

    def report(self, stamp):
        if not self.silent:
            self.send(SYNC, header(stamp, 'consumer'))


def test_a_needed_consumer_that_dies_holds_the_tow_up_for_a_while_only(
    graph, scenario_path, monkeypatch
):
    monkeypatch.setattr(credit, 'SILENT_S', 1000.0)
    consumer = graph.add(Consumer, use_sim_time=True)
    simulation = graph.add(
        SimNode, scenario=str(scenario_path), time_scale=0.0, exit_at_end=True,
        wait_for=['consumer'],
    )  # fmt: skip
    graph.until(lambda: simulation._tow.time_s > 2.0)
    consumer.silent = True
    held_at = simulation._tow.time_s
    graph.rest(0.5)
    assert simulation._tow.time_s <= held_at + simulation.parameters['lead_s'] + 0.6
    monkeypatch.setattr(credit, 'SILENT_S', 0.1)
    graph.until(lambda: 'goes on without consumer' in simulation.statuses()[0].message)
    graph.until(lambda: simulation.exit_code is not None)
    assert simulation.exit_code == 1, 'a tow that was not followed to its end'


def test_a_subscriber_that_asks_for_what_is_not_offered_is_said(graph):
    lookout = graph.add(Lookout)
    talker = graph.add(lambda **kwargs: TrawlNode('talker', **kwargs))
    talker.advertise(WINCH)
    stranger = graph.add(lambda **kwargs: TrawlNode('stranger', **kwargs))
    kind = message_class('sensor_msgs/msg/JointState')
    asking = stranger.create_subscription(kind, WINCH, lambda message: None, TRANSIENT)
    reason = 'volatile publisher and transient local subscription'
    here = f'/trawl/truth/winch: nothing arrives at stranger: {reason}'
    graph.until(lambda: lookout.message_of('talker: messages') == here)
    stranger.destroy_subscription(asking)
    graph.until(lambda: lookout.heard['/trawl/talker: messages'].level == OK)


BURST = """\
import sys, time, rclpy
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
rclpy.init()
node = rclpy.create_node('talker', namespace='trawl')
sender = node.create_publisher(JointState, '{topic}', QoSProfile(depth=5))
while not sender.get_subscription_count():
    time.sleep(0.05)
time.sleep(0.5)
message = JointState(position=[0.0] * 2000)
sender.publish(message)
# A gap shows between two messages, so the first is to arrive.
time.sleep(0.5)
for number in range({number} - 1):
    sender.publish(message)
sys.stdin.read()
"""


def test_messages_that_get_lost_are_counted_and_said(graph):
    number = 2000
    lookout = graph.add(Lookout)
    ear = graph.add(lambda **kwargs: TrawlNode('ear', **kwargs))
    ear.listen(WINCH, lambda message: None, CONSUMER)
    code = BURST.format(topic=WINCH, number=number)
    talker = subprocess.Popen(
        [sys.executable, '-c', code], stdin=subprocess.PIPE, env={**os.environ, **graph.environment}
    )

    def counts():
        values = lookout.heard['/trawl/ear: messages'].values
        return tuple(int(values.get(f'{way} /trawl/truth/winch', 0))
                     for way in ('received', 'dropped'))  # fmt: skip

    try:
        graph.until(lambda: '/trawl/ear: messages' in lookout.heard)
        graph.until(lambda: sum(counts()) == number)
        _, dropped = counts()
        assert 0 < dropped < number
        status = lookout.heard['/trawl/ear: messages']
        assert status.level == WARN
        assert f'{dropped} messages were lost' in status.message
        assert status.values['dropped'] == str(dropped)
    finally:
        talker.communicate(b'')


def test_a_clock_that_is_set_back_costs_no_estimate(graph, gear_path):
    lookout = graph.add(Lookout)
    graph.add(IdentificationNode, gear=str(gear_path), use_sim_time=True)
    watch = graph.add(lambda **kwargs: TrawlNode('watch', **kwargs))
    watch.advertise('/clock')

    def resets():
        status = lookout.heard.get('/trawl/identification_node: estimate')
        return status.values['resets'] if status else None

    def shown():
        status = lookout.heard['/trawl/identification_node: clock']
        return float(status.values['time'])

    def show(second):
        watch.send(*clock_message(second * SECOND))
        graph.rest(0.2)

    graph.until(lambda: watch._senders['/clock'].get_subscription_count())
    for second in (100, 101, 102):
        show(second)
    graph.until(lambda: resets() == '0')
    show(5)
    graph.rest(1.2)
    assert shown() == 102.0, 'one clock may be false'
    for second in (6, 7):
        show(second)
    graph.until(lambda: shown() == 7.0)
    graph.rest(1.2)
    assert resets() == '0', 'what is estimated is stamped'
