"""A node that is killed in the middle of a tow stops no other, and comes back to work."""

from contextlib import contextmanager

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.lab.running.processes import Processes  # noqa: E402
from trawl_ros.messages.diagnostics import ERROR, read_statuses  # noqa: E402
from trawl_ros.messages.stamps import stamp_of  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402

pytestmark = pytest.mark.ros

TIME_SCALE = 5.0
WATCHED = {
    'sim_node': 'truth/winch',
    'winch_node': 'winch/joint_states',
    'door_sensor_node': 'door/port/pressure',
    'trawl_sonar_node': 'sonar/pressure',
    'vessel_node': 'vessel/heading',
    'autotrawl_node': 'command/winch',
    'autopilot_node': 'command/vessel',
}
"""A topic of each source."""

MODES = {'autotrawl_node': 'lengths', 'autopilot_node': 'heading'}
"""What each controller is to hold."""

INSTRUMENTS = tuple(node for node in WATCHED if node not in {'sim_node', *MODES})
LISTENERS = {'bag_recorder': ('bag', 'recorded until'),
             'identification_node': ('estimate', 'samples used until')}  # fmt: skip
"""Status and key in which each listener says how far it has come."""

NEEDED = ['bag_recorder', *INSTRUMENTS]

FEW = ('sim_node', 'winch_node', 'vessel_node', 'bag_recorder')
"""A graph as small as may be: two sources, of which one is killed, and a listener beside them."""

QUICK = ('winch_node',)
"""A source that listens too; all others come back in the same way. Now and then nobody is heard by
what is started in the place of one that was killed, `docs/diagnostics.md`, so that kills are few.
"""


class Lookout(TrawlNode):
    """Keeps the stamps of each source, and what every node says of itself."""

    def __init__(self, **kwargs):
        super().__init__('lookout', **kwargs)
        self.stamps = {node: [] for node in WATCHED}
        self.heard = {}
        for node, topic in WATCHED.items():
            self.listen(topic, self.noting(node), CONSUMER)
        self.listen('/diagnostics', self._hear, CONSUMER)

    def noting(self, node):
        return lambda message: self.stamps[node].append(stamp_of(message))

    def _hear(self, message):
        for status in read_statuses(message):
            self.heard[status.name] = status

    def come_to(self, listener):
        subsystem, key = LISTENERS[listener]
        status = self.heard.get(f'/trawl/{listener}: {subsystem}')
        return float(status.values[key]) if status else 0.0


class Tow:
    """All nodes as processes, and somebody who looks at them."""

    def __init__(self, graph, processes, folder, gear, nodes):
        self.graph, self.processes, self.folder = graph, processes, folder
        self.nodes = nodes
        self.gear = str(gear)
        self.bags = 0
        self.lookout = graph.add(Lookout, use_sim_time=True)
        for node in (*(node for node in nodes if node != 'sim_node'), 'sim_node'):
            self.start(node)

    def start(self, node):
        parameters = {'mode': MODES[node]} if node in MODES else {'gear': self.gear}
        if node == 'bag_recorder':
            self.bags += 1
            parameters = {'output': str(self.folder / f'bag{self.bags}')}
        if node == 'sim_node':
            parameters |= {'warp_length_m': 300, 'speed_m_s': 2.1, 'time_scale': TIME_SCALE}
            parameters |= {'wait_for': [node for node in NEEDED if node in self.nodes]}
        else:
            parameters |= {'use_sim_time': True}
        self.processes.start(node, **parameters)

    def all_go_on(self):
        """Wait until each source has spoken and each listener has come further."""
        heard = self.lookout.stamps.items()
        sources = {node: len(stamps) for node, stamps in heard if node in self.nodes}
        latest = self.lookout.stamps['sim_node']
        mark = latest[-1] / SECOND if latest else 0.0
        for node, before in sources.items():
            self.until(lambda: len(self.lookout.stamps[node]) > before + 1)  # noqa: B023
        for listener in (node for node in LISTENERS if node in self.nodes):
            self.until(lambda: self.lookout.come_to(listener) > mark)  # noqa: B023

    def until(self, condition):
        """Wait for something while all processes run."""

        def is_so():
            self.processes.check()
            return condition()

        self.graph.until(is_so)


@contextmanager
def towing(open_graph, gear_path, folder, nodes):
    """Nodes that tow, as processes."""
    with open_graph() as graph, Processes(folder / 'log', graph.environment) as processes:
        tow = Tow(graph, processes, folder, gear_path, nodes)
        tow.all_go_on()
        yield tow


@pytest.fixture(scope='module')
def few(open_graph, gear_path, tmp_path_factory):
    with towing(open_graph, gear_path, tmp_path_factory.mktemp('few'), FEW) as tow:
        yield tow


@pytest.fixture(scope='module')
def tow(open_graph, gear_path, tmp_path_factory):
    nodes = (*WATCHED, *LISTENERS)
    with towing(open_graph, gear_path, tmp_path_factory.mktemp('tow'), nodes) as tow:
        yield tow


def hold(tow, node):
    """Kill a node, start it again, and all go on."""
    tow.processes.kill(node)
    tow.start(node)
    tow.all_go_on()
    tow.processes.check()
    errors = [s.name for s in tow.lookout.heard.values() if s.level == ERROR]
    assert not errors


@pytest.mark.parametrize('node', QUICK)
def test_a_node_of_few_that_is_killed_comes_back_to_work_and_stops_nobody(few, node):
    hold(few, node)


@pytest.mark.slow
@pytest.mark.parametrize('node', [*INSTRUMENTS, *MODES, *LISTENERS])
def test_a_node_that_is_killed_comes_back_to_work_and_stops_nobody(tow, node):
    hold(tow, node)


@pytest.mark.slow
def test_a_simulation_that_is_killed_begins_anew_and_its_listeners_with_it(tow):
    tow.processes.kill('sim_node')
    tow.graph.settle()
    reached = {node: stamps[-1] for node, stamps in tow.lookout.stamps.items()}
    for stamps in tow.lookout.stamps.values():
        stamps.clear()
    tow.start('sim_node')

    def all_began_anew():
        return all(any(stamp < reached[node] for stamp in stamps)
                   for node, stamps in tow.lookout.stamps.items())  # fmt: skip

    tow.until(all_began_anew)
    # The simulation waits for those that it needs, so they miss nothing of the new tow. It does not
    # wait for the lookout, which hears it when discovery allows.
    assert all(min(tow.lookout.stamps[node]) <= SECOND for node in INSTRUMENTS)
    tow.processes.check()
