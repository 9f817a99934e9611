"""The launch file starts nodes that there are, with parameters they have.

`launch` and `launch_ros` come with a full ROS 2 only, so what they would be told is noted by
stand-ins with the signatures that the file uses.
"""

import runpy
import sys
from types import ModuleType, SimpleNamespace

import pytest

from trawl_ros.core.resources import share_path

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.nodes.bag_recorder import BagRecorder
from trawl_ros.nodes.door_sensor_node import DoorSensorNode
from trawl_ros.nodes.sim_node import SimNode
from trawl_ros.nodes.trawl_sonar_node import TrawlSonarNode
from trawl_ros.nodes.vessel_node import VesselNode
from trawl_ros.nodes.winch_node import WinchNode

CLASSES = {
    'sim_node': SimNode,
    'winch_node': WinchNode,
    'door_sensor_node': DoorSensorNode,
    'trawl_sonar_node': TrawlSonarNode,
    'vessel_node': VesselNode,
    'bag_recorder': BagRecorder,
}
INSTRUMENTS = set(CLASSES) - {'sim_node', 'bag_recorder'}


class _Configuration:
    def __init__(self, name):
        self.name = name

    def perform(self, context):
        return context[self.name]


@pytest.fixture
def launch_file(monkeypatch):
    """The file's own names, its imports replaced."""

    def note(*args, **kwargs):
        return SimpleNamespace(args=args, **kwargs)

    stand_ins = {
        'launch': {'LaunchContext': dict, 'LaunchDescription': list},
        'launch.actions': {'DeclareLaunchArgument': note, 'OpaqueFunction': note},
        'launch.conditions': {'IfCondition': note},
        'launch.substitutions': {
            'LaunchConfiguration': _Configuration, 'PathJoinSubstitution': note,
        },
        'launch_ros': {},
        'launch_ros.actions': {'Node': note},
        'launch_ros.substitutions': {'FindPackageShare': note},
    }  # fmt: skip
    for name, content in stand_ins.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    return runpy.run_path(str(share_path('launch', 'trawl.launch.py')))


def started(launch_file, **given):
    defaults = {name: default for name, default, _ in launch_file['ARGUMENTS']}
    nodes = launch_file['start_nodes']({**defaults, **given})
    for node in nodes:
        assert (node.package, node.namespace) == ('trawl_ros', 'trawl')
    return {node.executable: node.parameters[0] for node in nodes}


@pytest.mark.parametrize(
    'given',
    [{}, {'scenario': 'demo', 'record': 'trial', 'time_scale': '0'}, {'gear': 'kaifuha'}],
)
def test_nodes_and_parameters_are_there_and_their_values_are_taken(launch_file, given):
    for executable, parameters in started(launch_file, **given).items():
        specs = {spec.name: spec for spec in CLASSES[executable].SPECS}
        for name, value in parameters.items():
            if name == 'use_sim_time':
                assert isinstance(value, bool)
            else:
                specs[name].checked(value)


def test_without_a_bag_nothing_records_and_nobody_waits_for_a_recorder(launch_file):
    nodes = started(launch_file)
    assert set(nodes) == INSTRUMENTS | {'sim_node'}
    assert set(nodes['sim_node']['wait_for']) == INSTRUMENTS
    assert all('wait_for' not in nodes[name] for name in INSTRUMENTS)


def test_the_tow_waits_for_all_who_listen(launch_file):
    nodes = started(launch_file, record='trial')
    assert set(nodes['sim_node']['wait_for']) == INSTRUMENTS | {'bag_recorder'}
    assert all(nodes[name]['wait_for'] == ['bag_recorder'] for name in INSTRUMENTS)
    assert nodes['bag_recorder']['output'] == 'trial'


@pytest.mark.parametrize(('scale', 'simulated'), [('1.0', False), ('1', False), ('0', True)])
def test_at_another_pace_all_but_the_simulation_take_its_time(launch_file, scale, simulated):
    nodes = started(launch_file, record='trial', time_scale=scale)
    assert 'use_sim_time' not in nodes['sim_node']
    for name in (*INSTRUMENTS, 'bag_recorder'):
        assert nodes[name]['use_sim_time'] is simulated


def test_rviz_opens_the_file_that_comes_along(launch_file):
    *declared, start, rviz = launch_file['generate_launch_description']()
    assert [argument.args[0] for argument in declared] == [
        name for name, _, _ in launch_file['ARGUMENTS']
    ]
    assert start.function is launch_file['start_nodes']
    assert (rviz.package, rviz.executable) == ('rviz2', 'rviz2')
    share, *path = rviz.arguments[1].args[0]
    assert share.args == ('trawl_ros',)
    assert share_path(*path).is_file()
    assert rviz.condition.args[0].name == 'rviz'
