"""`autopilot_node` steers the simulated ship through the graph, beside the autotrawl."""

import math

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.parameter import Parameter  # noqa: E402

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import read_vessel_command  # noqa: E402
from trawl_ros.messages.diagnostics import OK, WARN, read_statuses  # noqa: E402
from trawl_ros.messages.stamps import stamp_of  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes import autopilot_node  # noqa: E402
from trawl_ros.nodes.autopilot_node import AutopilotNode  # noqa: E402
from trawl_ros.nodes.autotrawl_node import AutotrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.parameters import ParameterError  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.vessel_node import VesselNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.records.samples import HeadingSample, VelocitySample  # noqa: E402

pytestmark = pytest.mark.ros

STATUS = '/trawl/autopilot_node: autopilot'


class Lookout(TrawlNode):
    """Hears the commands and where ship and winches come to; has a compass and a log of its own."""

    def __init__(self, **kwargs):
        super().__init__('lookout', **kwargs)
        self.commands, self.odometry, self.winches, self.reports = [], [], [], {}
        for topic in ('vessel/heading', 'vessel/velocity_water'):
            self.advertise(topic)
        self.listen('command/vessel', self.commands.append, CONSUMER)
        self.listen('truth/vessel/odom', self.odometry.append, CONSUMER)
        self.listen('truth/winch', self.winches.append, CONSUMER)
        self.listen('/diagnostics', self._hear, CONSUMER)

    def _hear(self, message):
        for status in read_statuses(message):
            self.reports[status.name] = status

    def measure(self, second, heading, speed=2.2):
        """Send what log and compass show."""
        velocity = VelocitySample(second * SECOND, 'water', [speed, 0.0, 0.0], 0.0)
        self.send(*sample_message(velocity))
        self.send(*sample_message(HeadingSample(second * SECOND, heading, 0.001)))

    @property
    def time_s(self):
        return stamp_of(self.odometry[-1]) / SECOND if self.odometry else -1.0

    def message(self):
        return getattr(self.reports.get(STATUS), 'message', '')


def heading_deg(odometry):
    turn = odometry.pose.pose.orientation
    return math.degrees(2 * math.atan2(turn.z, turn.w))


@pytest.fixture
def lookout(graph):
    return graph.add(Lookout)


@pytest.fixture
def pilot(graph, lookout):
    """Start the node and wait until it hears and is heard."""

    def start(**parameters):
        node = graph.add(AutopilotNode, **parameters)
        graph.until(lambda: lookout.count_subscribers('/trawl/vessel/heading') == 1)
        graph.until(lambda: lookout.count_publishers('/trawl/command/vessel') == 1)
        graph.rest(0.3)
        return node

    return start


def change(node, **values):
    """Set parameters one after the other; give the answer to the last."""
    answers = node.set_parameters([Parameter(name, value=v) for name, v in values.items()])
    return answers[-1]


def answered(graph, lookout, second, heading):
    """The rate of turn (rad/s) that follows a reading of the compass."""
    heard = len(lookout.commands)
    lookout.measure(second, heading)
    graph.until(lambda: len(lookout.commands) > heard)
    return read_vessel_command(lookout.commands[-1])


def test_ship_and_winches_are_driven_through_the_graph(graph, lookout, gear_path):
    names = ['winch_node', 'vessel_node', 'autotrawl_node', 'autopilot_node']
    common = {'gear': str(gear_path), 'use_sim_time': True}
    graph.add(WinchNode, wait_for=['autotrawl_node'], **common)
    graph.add(VesselNode, wait_for=['autopilot_node'], **common)
    graph.add(AutotrawlNode, mode='lengths', port_length_m=302, starboard_length_m=302)
    graph.add(AutopilotNode, mode='heading', heading_deg=8.0, max_turn_deg_s=0.5)
    graph.add(
        SimNode,
        gear=str(gear_path),
        warp_length_m=300,
        speed_m_s=2.2,
        time_scale=0.0,
        truth_rate_hz=1.0,
        lead_s=2.0,
        wait_for=names,
    )
    graph.until(lambda: lookout.time_s >= 60.0)
    assert heading_deg(lookout.odometry[-1]) == pytest.approx(8.0, abs=0.5)
    assert max(map(heading_deg, lookout.odometry)) < 10.0
    assert list(lookout.winches[-1].position) == pytest.approx([302.0, 302.0], abs=0.5)
    speed, _ = read_vessel_command(lookout.commands[-1])
    assert speed == pytest.approx(2.2, abs=0.15)


def test_parameters_change_what_is_steered(graph, lookout, pilot):
    node = pilot(mode='heading', heading_deg=90.0, speed_m_s=2.0, max_turn_deg_s=0.3)
    speed, turn = answered(graph, lookout, 1, 0.0)
    assert (speed, turn) == (2.0, pytest.approx(math.radians(0.3)))
    assert change(node, heading_deg=-90.0, max_turn_deg_s=0.1, speed_m_s=2.3).successful
    speed, turn = answered(graph, lookout, 2, 0.0)
    assert (speed, turn) == (2.3, pytest.approx(-math.radians(0.1)))
    assert change(node, mode='off').successful
    graph.until(lambda: read_vessel_command(lookout.commands[-1])[1] == 0.0)
    heard = len(lookout.commands)
    lookout.measure(3, 0.0)
    graph.rest(0.3)
    assert len(lookout.commands) == heard


def test_a_track_is_read_checked_and_its_end_reported(graph, lookout, pilot, tmp_path):
    node = pilot()
    answer = change(node, mode='track')
    assert not answer.successful
    assert 'parameter track' in answer.reason
    bad = tmp_path / 'bad.yaml'
    bad.write_text('course_deg: 3\n')
    answer = change(node, track=str(bad))
    assert not answer.successful
    assert 'track_m or track_deg' in answer.reason
    good = tmp_path / 'track.yaml'
    good.write_text('track_deg: [[60.0, 2.1]]\n')
    assert change(node, track=str(good)).successful
    assert change(node, mode='track').successful
    lookout.measure(1, 0.0)
    graph.until(lambda: 'fix lost' in lookout.message())
    assert lookout.reports[STATUS].values['mode'] == 'track'


def test_a_track_that_is_missing_at_the_start_is_said(graph):
    with pytest.raises(ParameterError, match='parameter track'):
        graph.add(AutopilotNode, mode='track')


def test_a_ship_whose_sensors_fall_silent_stops_turning(graph, lookout, pilot, monkeypatch):
    monkeypatch.setattr(autopilot_node, 'SILENT_S', 0.5)
    pilot(mode='heading', heading_deg=90.0)
    _, turn = answered(graph, lookout, 1, 0.0)
    assert turn > 0.0
    graph.until(lambda: read_vessel_command(lookout.commands[-1])[1] == 0.0)
    graph.until(lambda: 'sensors silent' in lookout.message())
    assert lookout.reports[STATUS].level == WARN


def test_it_waits_for_a_speed_and_takes_what_the_log_shows(graph, lookout, pilot):
    pilot(mode='heading', heading_deg=0.0)
    lookout.send(*sample_message(HeadingSample(0, 0.0, 0.001)))
    graph.until(lambda: 'waits for a speed' in lookout.message())
    assert not lookout.commands
    speed, _ = answered(graph, lookout, 1, 0.0)
    assert speed == 2.2
    graph.until(lambda: lookout.reports[STATUS].level == OK)


def test_when_time_is_set_back_it_begins_anew(graph, lookout, pilot):
    pilot(mode='heading', heading_deg=0.0)
    answered(graph, lookout, 1000, 0.5)
    lookout.measure(0, -0.5, speed=2.4)
    graph.settle()
    assert stamp_of(lookout.commands[-1]) == 1000 * SECOND, 'one stamp may be false, three are not'
    for second in (1, 2):
        lookout.measure(second, -0.5, speed=2.4)
    graph.until(lambda: stamp_of(lookout.commands[-1]) == 2 * SECOND)
    speed, turn = read_vessel_command(lookout.commands[-1])
    assert speed == 2.4
    assert turn > 0.0
