"""`autotrawl_node` answers what the winches say, is changed while it works, and says what fails."""

import math
import re
from itertools import pairwise

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.parameter import Parameter  # noqa: E402

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import read_winch_command  # noqa: E402
from trawl_ros.messages.diagnostics import OK, WARN, read_statuses  # noqa: E402
from trawl_ros.messages.stamps import stamp_of  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes import autotrawl_node  # noqa: E402
from trawl_ros.nodes.autotrawl_node import AutotrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.records.samples import WinchSample  # noqa: E402

pytestmark = pytest.mark.ros

STATUS = '/trawl/autotrawl_node: autotrawl'


class Winches(TrawlNode):
    """Winches that obey at once, with counters and load cells."""

    def __init__(self, **kwargs):
        super().__init__('winches', **kwargs)
        self.commands, self.reports = [], {}
        self.second = 0
        self.advertise('winch/joint_states')
        self.listen('command/winch', self.commands.append, CONSUMER)
        self.listen('/diagnostics', self._hear, CONSUMER)

    def _hear(self, message):
        for status in read_statuses(message):
            self.reports[status.name] = status

    def report(self, *, port=170e3, starboard=170e3, lengths=(500.0, 500.0)):
        # Readings are never the very same twice.
        wobble = 100.0 * math.sin(self.second)
        tensions = (port + wobble, starboard - wobble)
        sample = WinchSample(self.second * SECOND, lengths, (0.0, 0.0), tensions)
        self.send(*sample_message(sample))
        self.second += 1


@pytest.fixture
def winches(graph):
    return graph.add(Winches)


@pytest.fixture
def work(graph, winches):
    """Start the node, and let it answer samples."""

    def start(**parameters):
        node = graph.add(AutotrawlNode, **parameters)
        graph.until(lambda: winches.count_subscribers('/trawl/winch/joint_states') == 1)
        graph.until(lambda: winches.count_publishers('/trawl/command/winch') == 1)
        graph.rest(0.3)

        def answers(number, **what):
            heard = len(winches.commands)
            for _ in range(number):
                winches.report(**what)
            graph.until(lambda: len(winches.commands) >= heard + number)
            return [read_winch_command(message) for message in winches.commands[heard:]]

        return node, answers

    return start


def set_parameters(node, **values):
    return node.set_parameters([Parameter(name, value=value) for name, value in values.items()])


def test_each_sample_is_answered_with_its_stamp_and_the_taut_warp_is_paid_out(winches, work):
    _, answers = work(mode='tension')
    commands = answers(120, port=180e3, starboard=160e3)
    assert [stamp_of(message) for message in winches.commands] == [
        second * SECOND for second in range(120)
    ]
    assert commands[0] == pytest.approx((500.0, 500.0), abs=0.05)
    port, starboard = commands[-1]
    assert port - 500.0 > 1.0
    assert 500.0 - starboard > 1.0


def test_lengths_are_held_by_the_counters_and_changed_at_the_speed_of_the_winch(winches, work):
    node, answers = work(mode='lengths', max_speed_m_s=0.2)
    assert answers(5)[-1] == (500.0, 500.0)
    assert set_parameters(node, port_length_m=510.0, starboard_length_m=510)[0].successful
    lengths = [port for port, _ in answers(20)]
    assert max(b - a for a, b in pairwise(lengths)) == pytest.approx(0.2)
    assert answers(40)[-1] == (510.0, 510.0)


def test_off_sends_nothing_until_it_is_switched_on(graph, winches, work):
    node, answers = work()
    winches.report()
    graph.rest(0.3)
    assert not winches.commands
    assert set_parameters(node, mode='lengths')[0].successful
    assert answers(1) == [(500.0, 500.0)]


@pytest.mark.parametrize(
    ('name', 'value'), [('mode', 'magic'), ('tension_kn', 'high'), ('max_give_m', True)]
)
def test_what_cannot_be_set_is_refused_with_the_reason(work, name, value):
    node, _ = work()
    (answer,) = set_parameters(node, **{name: value})
    assert not answer.successful
    assert 'expected' in answer.reason


def test_a_lost_load_cell_is_held_and_said(graph, winches, work):
    _, answers = work(mode='tension')
    answers(10)
    before = answers(5, port=math.nan)[-1]
    after = answers(20, port=math.nan, starboard=140e3)[-1]
    assert after[0] == pytest.approx(before[0], abs=0.3)
    graph.until(lambda: 'port load cell' in getattr(winches.reports.get(STATUS), 'message', ''))
    status = winches.reports[STATUS]
    assert status.level == WARN
    assert re.match('port .* lost', status.values['sensors'])
    answers(20)
    graph.until(lambda: winches.reports[STATUS].level == OK)


def test_silence_of_the_winches_is_said(graph, winches, work, monkeypatch):
    monkeypatch.setattr(autotrawl_node, 'SILENT_S', 0.5)
    _, answers = work(mode='lengths')
    answers(2)
    graph.until(lambda: 'silent for' in getattr(winches.reports.get(STATUS), 'message', ''))


def test_when_time_is_set_back_it_takes_over_anew(winches, work):
    _, answers = work(mode='tension')
    answers(60, port=190e3, starboard=150e3)
    winches.second = 0
    assert answers(1, lengths=(400.0, 402.0)) == [(400.0, 402.0)]
