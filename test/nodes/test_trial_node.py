"""`trial_node` commands winches and ship, holds when something ceases, and obeys its operator."""

import math

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.control.trial.records import Knowledge, Proposal, TrialTarget  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import (  # noqa: E402
    read_vessel_command,
    read_winch_command,
    winch_command,
)
from trawl_ros.messages.diagnostics import OK, WARN, diagnostic_array, read_statuses  # noqa: E402
from trawl_ros.messages.stamps import header, stamp_of  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.messages.truth_to_messages import clock_message  # noqa: E402
from trawl_ros.nodes import trial_node  # noqa: E402
from trawl_ros.nodes.graph.graph_checks import SYNC  # noqa: E402
from trawl_ros.nodes.runtime.credit import HEADER  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER, LATCHED  # noqa: E402
from trawl_ros.nodes.trial_node import TrialNode  # noqa: E402
from trawl_ros.nodes.workers.proposals import knowledge_status  # noqa: E402
from trawl_ros.records.samples import (  # noqa: E402
    HeadingSample,
    PressureSample,
    RangeSample,
    VelocitySample,
    WinchSample,
)

pytestmark = pytest.mark.ros

STEP_NS = SECOND // 2
LOG = '/trawl/vessel/velocity_water'
TARGETS = tuple(TrialTarget(port=length, starboard=length, speed=2.1) for length in (400.0, 350.0))


class Ship(TrawlNode):
    """Ship, winches, instruments and estimator in one, with a clock that is moved by hand."""

    def __init__(self, **kwargs):
        super().__init__('ship', **kwargs)
        self.now_ns, self.lengths, self.speed = 1000 * SECOND, (300.0, 300.0), 2.1
        self.silent, self.answers = set(), []
        self.status = None
        for topic in ('/clock', 'winch/joint_states', 'door/port/pressure', 'vessel/heading',
                      'vessel/velocity_water', 'vessel/echo_sounder/depth',
                      'identification/status'):  # fmt: skip
            self.advertise(topic)
        self.advertise(SYNC, HEADER)
        self.listen('command/winch', self._hear_winch, CONSUMER)
        self.listen('command/vessel', self._hear_ship, CONSUMER)
        self.listen('trial/status', self._hear_status, LATCHED)

    def _hear_winch(self, message):
        self.lengths = read_winch_command(message)
        self.answers.append((stamp_of(message), self.lengths))

    def _hear_ship(self, message):
        self.speed = read_vessel_command(message)[0]

    def _hear_status(self, message):
        (self.status,) = read_statuses(message)

    def beat(self):
        self.send(SYNC, header(self.now_ns, 'identification_node'))

    def learned(self, windows):
        proposals = tuple(Proposal(target, 15.0, 1.0, 1.0, 2e5, 150.0) for target in TARGETS)
        knowledge = Knowledge(windows, {}, windows, 1.0, proposals)
        statuses = [knowledge_status(knowledge)]
        self.send('identification/status', diagnostic_array(self.now_ns, statuses))

    def report(self):
        """Half a second later everything says what it reads."""
        self.now_ns += STEP_NS
        stamp, wobble = self.now_ns, math.sin(self.now_ns / SECOND)
        self.send(*clock_message(stamp))
        samples = [
            WinchSample(stamp, self.lengths, (0.0, 0.0), (15e4 + wobble, 15e4 - wobble)),
            VelocitySample(stamp, 'water', np.array([self.speed + 1e-3 * wobble, 0, 0]), 0.0),
            HeadingSample(stamp, 0.0, 0.002),
            PressureSample(stamp, 'port', 1.1e6, 2e3),
            RangeSample(stamp, 'depth', math.inf, 0.1, 1.0, 3000.0),
        ]
        for sample in samples:
            topic, message = sample_message(sample)
            if topic not in self.silent:
                self.send(topic, message)
        self.beat()


@pytest.fixture
def ship(graph, monkeypatch):
    # On a busy machine any node is late now and then.
    monkeypatch.setattr(trial_node, 'LOST_S', 3600.0)
    return graph.add(Ship)


@pytest.fixture
def trial(graph, ship, coarse_gear):
    """Start a trial node on the ship's clock, and let time go by."""

    def start(**parameters):
        node = graph.add(TrialNode, gear=str(coarse_gear), use_sim_time=True, **parameters)
        for topic in ('winch/joint_states', 'identification/status', SYNC):
            graph.until(lambda topic=topic: ship.count_subscribers(f'/trawl/{topic}') >= 1)
        graph.until(lambda: ship.count_publishers('/trawl/command/winch') >= 1)
        graph.rest(0.3)
        return node

    return start


@pytest.fixture
def sail(graph, ship):
    """Let seconds of simulated time go by, each step when the one before has come in."""

    def go(seconds):
        (node,) = (node for node in graph.executor.get_nodes() if node.get_name() == 'trial_node')
        missed = ship.traffic.counts('published')[LOG] - node.traffic.counts('received')[LOG]
        for _ in range(round(seconds * SECOND / STEP_NS)):
            ship.report()
            sent = ship.traffic.counts('published')[LOG]
            graph.until(lambda sent=sent: node.traffic.counts('received')[LOG] >= sent - missed)
            graph.rest(0.005)
        graph.settle(0.1)

    return go


@pytest.fixture
def under_way(graph, ship, trial, sail):
    """Start a trial, and let it be on its way to 400 m."""

    def start(**parameters):
        node = trial(**parameters)
        sail(5.0)
        graph.until(lambda: ship.status.values['phase'] == 'tow')
        ship.learned(2)
        sail(15.0)
        assert ship.status.message == 'on the way to 400 m at 2.10 m/s'
        assert ship.lengths[0] > 300.5
        return node

    return start


def stands(ship, sail):
    before = ship.lengths
    sail(4.0)
    return ship.lengths == before


def test_it_goes_where_it_is_advised_and_holds_two_seconds_after_a_reading_ceases(
    ship, under_way, sail
):
    under_way()
    assert ship.status.level == OK
    ship.silent.add('winch/joint_states')
    sail(2.0)
    assert ship.status.level == WARN
    assert 'port_length is stale' in ship.status.values['held']
    assert stands(ship, sail)
    ship.silent.clear()
    sail(5.0)
    assert ship.status.level == OK
    assert not stands(ship, sail)


def test_without_the_node_that_estimates_it_holds(graph, ship, under_way, sail, monkeypatch):
    under_way()
    monkeypatch.setattr(trial_node, 'LOST_S', 1.5)
    monkeypatch.setattr(ship, 'beat', lambda: None)
    graph.rest(2.0)
    sail(0.5)
    assert ship.status.message.startswith('holds: identification_node')
    assert stands(ship, sail)


def test_the_operator_pauses_vetoes_and_takes_over(graph, ship, under_way, sail):
    node = under_way()
    assert graph.call('trial/pause').success
    sail(1.0)
    assert stands(ship, sail)
    assert ship.status.values['mode'] == 'paused'
    assert graph.call('trial/resume').success
    answer = graph.call('trial/veto')
    assert answer.message.startswith('400 m at 2.10 m/s')
    sail(1.0)
    assert ship.status.values['port_warp'] == '350'
    assert graph.call('trial/take_over').success
    graph.settle()
    heard = len(ship.answers)
    sail(3.0)
    assert len(ship.answers) == heard
    refused = graph.call('trial/take_over')
    assert refused.success
    assert node.statuses()[0].level == WARN


def test_a_command_of_somebody_else_takes_over(ship, under_way, sail):
    under_way()
    ship.advertise('command/winch')
    ship.send(*winch_command(ship.now_ns + 1, 310.0, 310.0))
    sail(1.0)
    assert ship.status.values['mode'] == 'taken over'
    assert ship.status.message.startswith('taken over: ')
    assert 'command/winch' in ship.status.message
    heard = len(ship.answers)
    sail(2.0)
    assert len(ship.answers) == heard


def test_a_command_of_another_time_does_not_take_over(ship, under_way, sail):
    node = under_way(max_command_age_s=5.0)
    ship.advertise('command/winch')
    ship.send(*winch_command(ship.now_ns + 60 * SECOND, 310.0, 310.0))
    sail(1.0)
    assert ship.status.values['mode'] != 'taken over'
    assert node.traffic.total('refused') == 1


def test_killed_and_restarted_it_goes_on(graph, ship, trial, under_way, sail, tmp_path):
    state = str(tmp_path / 'trial.json')
    node = under_way(state=state)
    graph.call('trial/veto')
    sail(5.0)
    before = ship.lengths
    graph.executor.remove_node(node)
    # As killed: nothing of its end is run.
    node.finish_work = lambda: None
    node.destroy_node()
    trial(state=state)
    ship.learned(2)
    sail(20.0)
    assert ship.status.values['port_warp'] == '350'
    assert ship.status.values['struck off'] == '1'
    assert 350.0 > ship.lengths[0] > before[0]


def test_limits_are_changed_while_it_sails_and_nonsense_is_refused(ship, under_way, sail):
    from rclpy.parameter import Parameter

    node = under_way()
    (answer,) = node.set_parameters([Parameter('max_tension_kn', value=140.0)])
    assert answer.successful
    sail(2.0)
    assert 'above 140 kN' in ship.status.values['held']
    assert stands(ship, sail)
    (answer,) = node.set_parameters([Parameter('hours', value=-1.0)])
    assert not answer.successful


def test_a_pair_trawl_has_no_boards_to_learn_of(graph, pair_file):
    from trawl_ros.core.errors import TrawlError

    with pytest.raises(TrawlError, match=r"^'pair' .*no boards"):
        graph.add(TrialNode, gear=str(pair_file))
