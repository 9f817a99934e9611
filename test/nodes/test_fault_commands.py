"""Faults are switched by topic, by parameter and by plan while nodes run, and are diagnosed."""

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.parameter import Parameter  # noqa: E402

from trawl_ros.core.errors import InstrumentError  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import fault_command  # noqa: E402
from trawl_ros.messages.diagnostics import OK, WARN, read_statuses  # noqa: E402
from trawl_ros.messages.pieces import joint_state  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402

pytestmark = pytest.mark.ros

COUNTER = 'winch/joint_states/port/length'
READINGS = 'winch/joint_states'


class Engineer(TrawlNode):
    """Gives the winches' truth, switches faults, and reads what comes of it."""

    def __init__(self, **kwargs):
        super().__init__('engineer', **kwargs)
        self.readings, self.reports, self.refused, self.stamp = [], {}, {}, 0
        self.advertise('truth/winch')
        self.advertise('command/fault')
        self.listen('winch/joint_states', self.readings.append, CONSUMER)
        self.listen('/diagnostics', self._hear, CONSUMER)

    def _hear(self, message):
        for status in read_statuses(message):
            self.reports[status.name] = status

    def report(self, subsystem):
        return next(
            (s for name, s in self.reports.items() if name.endswith(f'winch_node: {subsystem}')),
            None,
        )


@pytest.fixture
def engineer(graph):
    return graph.add(Engineer)


def node(graph, engineer, **parameters):
    made = graph.add(WinchNode, **parameters)
    graph.until(
        lambda: made.subscribers()[READINGS][0] and engineer.subscribers()['truth/winch'][0]
    )
    return made


def read(graph, engineer, count=4):
    """Give the counters of ``count`` samples from here on."""
    before = len(engineer.readings)
    for _ in range(count):
        engineer.stamp += SECOND // 2
        engineer.send(
            'truth/winch',
            joint_state(engineer.stamp, 'truth/winch', (400.0, 400.0), (0.0, 0.0), (1e5, 1e5)),
        )
    graph.until(lambda: len(engineer.readings) >= before + count)
    return np.array([message.position for message in engineer.readings[before:]])


def switch(graph, engineer, where, what, done):
    engineer.send(*fault_command(where, what))
    graph.until(done)


def faults(engineer):
    status = engineer.report('faults')
    return dict(status.values) if status else None


def test_a_fault_by_topic_shows_and_ends(graph, engineer):
    node(graph, engineer)
    sound = read(graph, engineer)
    assert np.abs(sound - 400.0).max() < 1.0
    switch(
        graph, engineer, COUNTER, 'offset 25', lambda: faults(engineer) == {COUNTER: 'offset 25'}
    )
    assert engineer.report('faults').level == WARN
    wrong = read(graph, engineer)
    assert np.abs(wrong - [425.0, 400.0]).max() < 1.0
    switch(graph, engineer, COUNTER, 'none', lambda: faults(engineer) == {})
    assert engineer.report('faults').level == OK
    assert np.abs(read(graph, engineer) - 400.0).max() < 1.0


def test_a_fault_that_cannot_be_is_said_and_others_places_are_left_to_them(graph, engineer):
    node(graph, engineer)
    switch(
        graph, engineer, COUNTER, 'broken',
        lambda: 'no such fault' in getattr(engineer.report('messages'), 'message', ''),
    )  # fmt: skip
    engineer.send(*fault_command('door/spread', 'silent'))
    engineer.send(*fault_command('winch/joint_states', 'offset 5'))
    graph.until(lambda: faults(engineer))
    assert 'door/spread' not in engineer.report('messages').message


def test_a_parameter_switches_faults_at_the_start_and_while_running(graph, engineer):
    winch = node(graph, engineer, faults=[f'{COUNTER}: scale 1.1'])
    assert np.abs(read(graph, engineer) - [440.0, 400.0]).max() < 1.0
    (refused,) = winch.set_parameters([Parameter('faults', value=['winch/joint_states: sick'])])
    assert not refused.successful
    assert 'no such fault' in refused.reason
    (taken,) = winch.set_parameters([Parameter('faults', value=[f'{COUNTER}: offset -9'])])
    assert taken.successful
    assert np.abs(read(graph, engineer) - [391.0, 400.0]).max() < 1.0


def test_a_node_does_not_start_with_a_fault_that_cannot_be(graph):
    with pytest.raises(InstrumentError, match="expected 'PLACE: FAULT'"):
        graph.add(WinchNode, faults=['winch/joint_states silent'])
