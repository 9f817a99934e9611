"""`sim_node` obeys, refuses with reasons, starts again, and waits for those who cannot keep up."""

import math

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.parameter import Parameter  # noqa: E402
from rclpy.parameter_client import AsyncParameterClient  # noqa: E402

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import vessel_command, winch_command  # noqa: E402
from trawl_ros.messages.diagnostics import ERROR, WARN, read_statuses  # noqa: E402
from trawl_ros.messages.stamps import header, stamp_of  # noqa: E402
from trawl_ros.nodes.runtime.credit import HEADER, SYNC  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.parameters import ParameterError  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402

pytestmark = pytest.mark.ros

LEAD_S = 2.0


class Crew(TrawlNode):
    """Commands the tow, looks at it, and says how far it is: no further than it is told."""

    def __init__(self, **kwargs):
        super().__init__('crew', **kwargs)
        self.winches = []
        self.speeds = []
        self.reports = {}
        self.reported_at = {}
        for topic in ('command/winch', 'command/vessel'):
            self.advertise(topic)
        self.advertise(SYNC, HEADER)
        self.listen('truth/winch', self.winches.append, CONSUMER)
        self.listen('truth/vessel/velocity_water', self.speeds.append, CONSUMER)
        self.listen('/diagnostics', self._hear, CONSUMER)

    def _hear(self, message):
        for status in read_statuses(message):
            self.reports[status.name] = status
            self.reported_at[status.name] = stamp_of(message)

    def has_come_to(self, stamp):
        self.send(SYNC, header(stamp, 'crew'))

    @property
    def latest(self):
        return stamp_of(self.winches[-1]) / SECOND if self.winches else -1.0


@pytest.fixture(scope='module')
def graph(open_graph):
    with open_graph() as graph:
        yield graph


@pytest.fixture(scope='module')
def simulation(graph, gear_path):
    return graph.add(
        SimNode,
        gear=str(gear_path),
        warp_length_m=300,
        speed_m_s=2.1,
        time_scale=0.0,
        lead_s=LEAD_S,
        wait_for=['crew'],
    )


@pytest.fixture(scope='module')
def crew(graph, simulation):
    return graph.add(Crew)


def follow(graph, crew, until_s):
    """Process all truth up to a time (s)."""

    def there():
        crew.has_come_to(max(0, round(crew.latest * SECOND)))
        return crew.latest >= until_s

    graph.until(there)


def set_parameter(graph, node, name, value):
    client = AsyncParameterClient(node, 'sim_node')
    graph.until(client.services_are_ready)
    future = client.set_parameters([Parameter(name, value=value)])
    graph.until(future.done)
    return future.result().results[0]


# In the order of one watch at sea: the tests share the simulation, which is slow to begin.


def test_it_waits_for_those_it_is_told_to_wait_for(graph, simulation, crew):
    graph.until(lambda: '/trawl/sim_node: tow' in crew.reports)
    status = crew.reports['/trawl/sim_node: tow']
    assert status.level == WARN
    assert 'waits for crew' in status.message
    assert not crew.winches


def test_it_never_runs_further_ahead_than_its_lead(graph, simulation, crew):
    def started():
        crew.has_come_to(0)
        return crew.latest >= LEAD_S

    graph.until(started)
    graph.rest(0.5)
    assert crew.latest == pytest.approx(LEAD_S)
    crew.has_come_to(SECOND)
    graph.until(lambda: crew.latest >= LEAD_S + 1.0)
    graph.rest(0.3)
    assert crew.latest == pytest.approx(LEAD_S + 1.0)


def test_it_starts_in_equilibrium_at_its_parameters(simulation, crew):
    first, last = crew.winches[0], crew.winches[-1]
    assert list(first.position) == [300.0, 300.0]
    assert list(last.effort) == pytest.approx(list(first.effort), rel=1e-4)
    assert crew.speeds[0].twist.linear.x == pytest.approx(2.1)


def test_every_truth_comes_once_and_in_order(crew):
    stamps = [stamp_of(message) for message in crew.winches]
    assert stamps == [round(0.1 * SECOND) * number for number in range(len(stamps))]


def test_commands_move_winches_and_ship(graph, simulation, crew):
    crew.send(*winch_command(0, 303.0, math.nan))
    crew.send(*vessel_command(0, 2.2, math.radians(0.5)))
    follow(graph, crew, crew.latest + 11.0)
    port, starboard = crew.winches[-1].position
    assert port == pytest.approx(303.0, abs=0.5)
    assert starboard == 300.0
    assert crew.speeds[-1].twist.linear.x > 2.15
    assert crew.speeds[-1].twist.angular.z > 0.0


@pytest.mark.parametrize(
    ('command', 'reason'),
    [
        (winch_command(0, 9000.0, 300.0), '9000 m; expected 1 to 3000'),
        (winch_command(0, -5.0, 300.0), 'above 0 m'),
        (vessel_command(0, 12.0, 0.0), '12 m/s; expected 0.5 to 4'),
        (vessel_command(0, math.nan, 0.0), 'expected finite numbers'),
        (vessel_command(0, 2.0, 1.0), '1 rad/s'),
    ],
)
def test_impossible_commands_are_left_out_and_said(graph, simulation, crew, command, reason):
    wanted = simulation._tow.simulation.command
    crew.send(*command)
    graph.until(lambda: reason in crew.reports['/trawl/sim_node: messages'].message)
    assert crew.reports['/trawl/sim_node: messages'].level == WARN
    assert simulation._tow.simulation.command == wanted


def test_reset_starts_the_same_tow_again(graph, simulation, crew):
    before = crew.winches[0]
    del crew.winches[:]
    answer = graph.call('reset')
    assert answer.success, answer.message
    graph.until(lambda: crew.winches and crew.winches[-1].header.stamp.sec < 3)
    again = next(m for m in crew.winches if stamp_of(m) == 0)
    assert list(again.effort) == list(before.effort)
    graph.until(lambda: crew.latest >= LEAD_S - 1e-9)
    graph.rest(0.3)
    assert crew.latest == pytest.approx(LEAD_S), 'progress from before the reset gave credit'


def test_diagnostics_carry_the_time_that_the_simulation_publishes(graph, simulation, crew):
    crew.reported_at.clear()
    graph.until(lambda: any('sim_node' in name for name in crew.reported_at))
    (at,) = {stamp for name, stamp in crew.reported_at.items() if 'sim_node' in name}
    assert at <= crew.latest * SECOND + SECOND


def test_a_change_at_run_time_has_effect(graph, simulation, crew):
    assert set_parameter(graph, crew, 'lead_s', 4).successful
    graph.until(lambda: crew.latest >= 4.0)
    graph.rest(0.2)
    assert crew.latest == pytest.approx(4.0)


@pytest.mark.parametrize(
    ('name', 'value', 'reason'),
    [
        ('lead_s', 100.0, 'out of range'),
        ('lead_s', 100, '1 to 8 (s)'),
        ('lead_s', 'long', '1 to 8 (s)'),
        ('warp_length_m', 400.0, 'restart the node'),
    ],
)
def test_a_change_that_cannot_be_is_refused_with_the_reason(
    graph, simulation, crew, name, value, reason
):
    before = simulation.get_parameter(name).value
    answer = set_parameter(graph, crew, name, value)
    assert not answer.successful
    assert reason in answer.reason
    assert simulation.get_parameter(name).value == before


def test_parameters_say_what_they_are(simulation):
    described = simulation.describe_parameter('time_scale')
    assert 'factor' in described.description
    assert described.floating_point_range[0].to_value == 1000.0


def test_two_clocks_are_an_error_that_names_both(graph, simulation, crew):
    crew.advertise('/clock')
    graph.until(lambda: crew.reports['/trawl/sim_node: clock'].level == ERROR)
    message = crew.reports['/trawl/sim_node: clock'].message
    assert '2 publishers on /clock (crew, sim_node)' in message


@pytest.mark.parametrize(
    ('name', 'value', 'reason'),
    [
        ('time_scale', -1.0, 'time_scale'),
        ('speed_m_s', 30, 'parameter speed_m_s: found 30, '),
        ('truth_rate_hz', 3.0, '10 divided by'),
        ('publish_clock', 'yes', "found 'yes'"),
        ('scenario', 'nowhere.yaml', 'nowhere.yaml: no such file'),
    ],
)
def test_what_cannot_be_at_the_start_is_an_error(open_graph, name, value, reason):
    from trawl_ros.core.errors import TrawlError

    with open_graph() as graph, pytest.raises(TrawlError) as raised:
        graph.add(SimNode, **{name: value})
    assert reason in str(raised.value)
    assert issubclass(ParameterError, TrawlError)
