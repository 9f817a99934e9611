"""The launch file starts nodes that there are, with parameters they have.

`launch` and `launch_ros` come with a full ROS 2 only, so what they would be told is noted by
stand-ins with the signatures that the file uses.
"""

import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from trawl_ros.core.resources import share_path

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.nodes.bag_recorder import BagRecorder
from trawl_ros.nodes.door_sensor_node import DoorSensorNode
from trawl_ros.nodes.runtime.frames import frame_specs
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


class _Share(_Configuration):
    def perform(self, context):
        assert self.name == 'trawl_ros'
        return str(share_path('config').parent)


@pytest.fixture
def launch_file(monkeypatch):
    """The file's own names, its imports replaced."""

    def note(*args, **kwargs):
        return SimpleNamespace(args=args, **kwargs)

    stand_ins = {
        'launch': {'LaunchContext': dict, 'LaunchDescription': list},
        'launch.actions': {'DeclareLaunchArgument': note, 'OpaqueFunction': note},
        'launch.substitutions': {'LaunchConfiguration': _Configuration},
        'launch_ros': {},
        'launch_ros.actions': {'Node': note},
        'launch_ros.substitutions': {'FindPackageShare': _Share},
    }  # fmt: skip
    for name, content in stand_ins.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    return runpy.run_path(str(share_path('launch', 'trawl.launch.py')))


def launched(launch_file, **given):
    defaults = {name: default for name, default, _ in launch_file['ARGUMENTS']}
    return launch_file['start_nodes']({**defaults, **given})


def started(launch_file, **given):
    nodes = launched(launch_file, **given)
    for node in nodes:
        assert (node.package, node.namespace) == ('trawl_ros', given.get('namespace', 'trawl'))
    return {node.executable: node.parameters[-1] for node in nodes}


@pytest.mark.parametrize(
    'given',
    [
        {},
        {'scenario': 'demo', 'record': 'trial', 'time_scale': '0'},
        {'gear': 'kaifuha', 'instruments': 'worn', 'seed': '4', 'frame_prefix': 'a/'},
    ],
)
def test_nodes_and_parameters_are_there_and_their_values_are_taken(launch_file, given):
    for executable, parameters in started(launch_file, **given).items():
        known = (*CLASSES[executable].SPECS, *frame_specs(executable))
        specs = {spec.name: spec for spec in known}
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


@pytest.mark.parametrize(('scale', 'simulated'), [('', False), ('1', False), ('0', True)])
def test_at_another_pace_all_but_the_simulation_take_its_time(launch_file, scale, simulated):
    nodes = started(launch_file, record='trial', time_scale=scale)
    assert 'use_sim_time' not in nodes['sim_node']
    for name in (*INSTRUMENTS, 'bag_recorder'):
        assert nodes[name]['use_sim_time'] is simulated


def test_arguments_are_declared_with_a_sentence(launch_file):
    *declared, start = launch_file['generate_launch_description']()
    assert [argument.args[0] for argument in declared] == [
        name for name, _, _ in launch_file['ARGUMENTS']
    ]
    assert all(argument.description.endswith('.') for argument in declared)
    assert start.function is launch_file['start_nodes']


@pytest.mark.parametrize('scale', ['', '0'])
def test_rviz_and_the_shapes_go_by_the_time_of_the_nodes(launch_file, scale):
    nodes = launched(launch_file, rviz='true', time_scale=scale, frame_prefix='a/')
    rviz, shapes = nodes[-2:]
    assert (rviz.package, shapes.package) == ('rviz2', 'robot_state_publisher')
    assert Path(rviz.arguments[1]).is_file()
    (of_shapes,) = shapes.parameters
    assert of_shapes['robot_description'].startswith('<?xml')
    assert of_shapes['frame_prefix'] == 'a/'
    simulated = {node.parameters[-1].get('use_sim_time') for node in nodes[1:]}
    assert simulated == {scale == '0'}
    assert all(node.executable != 'rviz2' for node in launched(launch_file))


def test_what_is_not_given_is_left_to_the_file_of_parameters(launch_file):
    for node in launched(launch_file, params_file='mine.yaml'):
        file, own = node.parameters
        assert file == 'mine.yaml'
        assert set(own) <= {'wait_for', 'use_sim_time'}


def test_two_ships_have_a_namespace_and_a_prefix_each(launch_file):
    for ship in ('a', 'b'):
        nodes = started(launch_file, namespace=ship, frame_prefix=f'{ship}/')
        assert {given['frame_prefix'] for given in nodes.values()} == {f'{ship}/'}


def test_any_nodes_are_started_and_again_where_asked(launch_file):
    nodes = launched(launch_file, nodes='sim_node, winch_node,autotrawl_node', respawn='true')
    assert [node.executable for node in nodes] == ['sim_node', 'winch_node', 'autotrawl_node']
    assert nodes[0].parameters[-1]['wait_for'] == ['winch_node']
    assert all(node.respawn for node in nodes)
    assert not any(node.respawn for node in launched(launch_file))
