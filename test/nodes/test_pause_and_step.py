"""A tow is paused, towed on step by step, and resumed; set back, all begin anew."""

import re
from itertools import pairwise
from pathlib import Path

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.diagnostics import read_statuses  # noqa: E402
from trawl_ros.messages.stamps import stamp_of  # noqa: E402
from trawl_ros.nodes.door_sensor_node import DoorSensorNode  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.trawl_sonar_node import TrawlSonarNode  # noqa: E402
from trawl_ros.nodes.vessel_node import VesselNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.records.truth import SIDES  # noqa: E402

pytestmark = pytest.mark.ros

TIME_SCALE = 5.0
DOCUMENT = Path(__file__).parents[2] / 'docs/diagnostics.md'
INSTRUMENTS = (WinchNode, DoorSensorNode, TrawlSonarNode, VesselNode)


class Crew(TrawlNode):
    """Hears truth and every sample."""

    def __init__(self, **kwargs):
        super().__init__('crew', **kwargs)
        self.truth = []
        self.statuses_heard = {}
        self.samples = {}
        self.listen('truth/winch', self.truth.append, CONSUMER)
        self.listen('/diagnostics', self._hear, CONSUMER)
        for kind in INSTRUMENTS:
            for topic in kind.SAMPLES:
                self.samples[topic] = []
                self.listen(topic, self.samples[topic].append, CONSUMER)

    def _hear(self, message):
        for status in read_statuses(message):
            self.statuses_heard[status.name] = status

    def said_by(self, status):
        heard = self.statuses_heard.get(f'/trawl/{status}')
        return heard.message if heard else ''

    @property
    def latest(self):
        return stamp_of(self.truth[-1]) / SECOND if self.truth else -1.0


@pytest.fixture(scope='module')
def graph(open_graph):
    with open_graph() as graph:
        yield graph


@pytest.fixture(scope='module')
def crew(graph):
    return graph.add(Crew, use_sim_time=True)


@pytest.fixture(scope='module')
def simulation(graph, crew, gear_path):
    for kind in INSTRUMENTS:
        graph.add(kind, gear=str(gear_path), use_sim_time=True)
    node = graph.add(
        SimNode,
        gear=str(gear_path),
        warp_length_m=300,
        speed_m_s=2.1,
        time_scale=TIME_SCALE,
    )
    graph.until(lambda: crew.latest > 1.0)
    return node


def all_heard(graph, crew, simulation):
    """Wait until all truth has arrived that is under way; give its time (s)."""
    graph.until(lambda: crew.latest * SECOND == simulation._latest)
    return crew.latest


# In the order of one watch at sea: the tests share the simulation, which is slow to begin.


def test_paused_nothing_moves_and_resumed_it_goes_on_without_a_gap(graph, crew, simulation):
    answer = graph.call('pause')
    assert answer.success
    assert 'paused' in answer.message
    at = all_heard(graph, crew, simulation)
    graph.rest(0.5)
    assert crew.latest == at
    graph.until(lambda: crew.said_by('sim_node: tow') == 'paused')
    assert graph.call('resume').success
    graph.until(lambda: crew.latest > at + 1.0)
    stamps = [stamp_of(message) for message in crew.truth]
    assert {after - before for before, after in pairwise(stamps)} == {SECOND // 10}


def test_a_step_is_one_truth(graph, crew, simulation):
    refusal = graph.call('step')
    assert not refusal.success
    assert 'not paused' in refusal.message
    graph.call('pause')
    at = all_heard(graph, crew, simulation)
    number = len(crew.truth)
    for _ in range(3):
        assert graph.call('step').success
    graph.until(lambda: len(crew.truth) == number + 3)
    graph.rest(0.2)
    assert len(crew.truth) == number + 3
    assert crew.latest == pytest.approx(at + 0.3)
    graph.call('resume')


def test_real_time_factors_are_reported_by_all_who_go_by_stamps(graph, crew, simulation):
    names = ('sim_node', *(node_name(kind) for kind in INSTRUMENTS))

    def factor_of(name):
        heard = crew.statuses_heard.get(f'/trawl/{name}: clock')
        return float(heard.values.get('real-time factor', 0.0)) if heard else 0.0

    for name in names:
        # How fast it goes is the machine's affair; more than the time scale cannot last.
        graph.until(lambda: 0.0 < factor_of(name) < 1.5 * TIME_SCALE)  # noqa: B023
    assert 'real-time factor' not in crew.statuses_heard['/trawl/crew: clock'].values


def test_what_the_document_promises_is_reported(graph, crew, simulation):
    for status, node in (('messages', 'winch_node'), ('clock', 'winch_node'),
                         ('tow', 'sim_node'), ('instruments', 'winch_node')):  # fmt: skip
        reported = crew.statuses_heard[f'/trawl/{node}: {status}'].values
        promised = documented(status)
        assert promised, status
        assert promised - {'step'} <= set(reported), status


def documented(subsystem):
    """Keys that stand for themselves in the rows of a subsystem, and those that follow it."""
    keys, within = set(), False
    for line in DOCUMENT.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip('|').split(' | ')]
        if line.startswith('|') and cells[0].strip('| '):
            within = f'`{subsystem}`' in cells[:2]
        if within and line.startswith('|'):
            keys |= {key for key in re.findall('`([^`]+)`', '|'.join(cells[1:]))
                     if not re.search('[<…_/]', key)}  # fmt: skip
    return keys - {subsystem}


def test_after_a_reset_instruments_begin_anew_and_read_the_same_again(graph, crew, simulation):
    graph.until(lambda: crew.latest > 22.0)
    answer = graph.call('reset')
    assert answer.success, answer.message
    graph.until(lambda: crew.truth[-1].header.stamp.sec < 5)
    graph.until(lambda: crew.latest > 22.0)
    assert not any(crew.samples[f'door/{side}/slant_range'] for side in SIDES)  # not fitted
    for topic, messages in crew.samples.items():
        if topic.endswith('slant_range'):
            continue
        stamps = [stamp_of(message) for message in messages]
        (again,) = (i for i in range(1, len(stamps)) if stamps[i] <= stamps[i - 1])
        first, second = messages[:again], messages[again:]
        number = min(len(first), len(second))
        assert number >= 1, topic
        assert [*map(serialize, first[:number])] == [*map(serialize, second[:number])], topic
    for kind in INSTRUMENTS:
        status = crew.statuses_heard[f'/trawl/{node_name(kind)}: instruments']
        assert status.values['incomplete instants'] == '0'


def node_name(kind):
    return kind.__module__.rpartition('.')[2]
