# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The whole chain on a full ROS 2: simulation, instruments, and what else is asked for.

``ros2 launch trawl_ros trawl.launch.py scenario:=demo record:=my_trial rviz:=true``

``ros2 launch trawl_ros trawl.launch.py --show-args`` lists the arguments. Two ships are two of
these, each with its own ``namespace`` and ``frame_prefix``.
"""

from pathlib import Path
from typing import Any

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from launch import LaunchContext, LaunchDescription

PACKAGE = 'trawl_ros'
INSTRUMENTS = ('winch_node', 'door_sensor_node', 'trawl_sonar_node', 'vessel_node')
SIMULATION, RECORDER = 'sim_node', 'bag_recorder'

ENDING_S = '20'
"""A node may take so long to say its last words on a busy machine; launch would give it 5 s."""

RESPAWN_DELAY_S = 2.0

ARGUMENTS = (
    ('scenario', '', 'Scenario file or name; without one the ship tows straight on.'),
    ('gear', '', 'Gear file or name, where no scenario brings its own; kaifuha without one.'),
    ('time_scale', '', 'Simulated seconds per second; 0 is as fast as the listeners follow.'),
    ('record', '', 'Folder of a bag to record into; nothing is recorded without one.'),
    ('rviz', 'false', 'Whether to open RViz, with robot_state_publisher for the shapes.'),
    ('namespace', 'trawl', 'Namespace of the nodes; the files for viewers look in trawl.'),
    ('frame_prefix', '', 'Put before the names of all frames but map, as ship_a/.'),
    ('params_file', '', 'YAML file of parameters; other arguments go before it.'),
    ('instruments', '', 'File or name of instrument parameters, where no scenario has its own.'),
    ('seed', '', 'Seed of all noise, where it is not that of the scenario.'),
    ('nodes', ','.join((SIMULATION, *INSTRUMENTS)), 'Executables to start, between commas.'),
    ('respawn', 'false', 'Whether nodes that end with an error start again.'),
)


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments, and start what they ask for."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=sentence)
        for name, default, sentence in ARGUMENTS
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=start_nodes)])


def start_nodes(context: LaunchContext) -> list[Node]:
    """Start the nodes; who listens is waited for, so that the beginning is not lost."""
    given = {name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS}
    scale = float(given['time_scale'] or 1.0)
    # At another pace than that of the wall the simulation gives the time.
    clock = {'use_sim_time': scale != 1.0}
    recorders = [RECORDER] if given['record'] else []
    wanted = [name.strip() for name in given['nodes'].split(',') if name.strip()]
    wanted += [name for name in recorders if name not in wanted]
    instruments = [name for name in INSTRUMENTS if name in wanted]
    tow = _given(given, 'gear', 'scenario')
    measured = {**tow, **_given(given, 'instruments'), **_waiting(recorders)}
    if given['seed']:
        measured['seed'] = int(given['seed'])
    own: dict[str, dict[str, Any]] = dict.fromkeys(INSTRUMENTS, measured)
    own[RECORDER] = {'output': given['record']} if given['record'] else {}
    pace = {'time_scale': scale} if given['time_scale'] else {}
    own[SIMULATION] = {**tow, **pace, **_waiting([*instruments, *recorders])}
    prefix = _given(given, 'frame_prefix')
    files = [given['params_file']] if given['params_file'] else []
    nodes = [
        _node(
            name,
            given['namespace'],
            [*files, {**own.get(name, {}), **prefix, **({} if name == SIMULATION else clock)}],
            _is_true(given['respawn']),
        )
        for name in wanted
    ]
    return [*nodes, *_display(context, given, clock)] if _is_true(given['rviz']) else nodes


def _display(context: LaunchContext, given: dict[str, str], clock: dict[str, Any]) -> list[Node]:
    """RViz and the publisher of the shapes, by the time that the nodes go by."""
    config = Path(FindPackageShare(PACKAGE).perform(context)) / 'config'
    shapes = {'robot_description': (config / 'urdf' / 'trawl.urdf').read_text(encoding='utf-8')}
    return [
        Node(
            package='rviz2',
            executable='rviz2',
            arguments=['-d', str(config / 'rviz' / 'trawl.rviz')],
            parameters=[clock],
        ),
        Node(
            package='robot_state_publisher',
            executable='robot_state_publisher',
            namespace=given['namespace'],
            parameters=[{**shapes, **clock, **_given(given, 'frame_prefix')}],
        ),
    ]


def _given(given: dict[str, str], *names: str) -> dict[str, Any]:
    """Parameters by arguments that are set; others are left to the file of parameters."""
    return {name: given[name] for name in names if given[name]}


def _waiting(consumers: list[str]) -> dict[str, Any]:
    # ROS knows no type for an empty list.
    return {'wait_for': consumers} if consumers else {}


def _is_true(text: str) -> bool:
    return text.lower() in ('true', '1')


def _node(executable: str, namespace: str, parameters: list[Any], respawn: bool) -> Node:
    return Node(
        package=PACKAGE,
        executable=executable,
        namespace=namespace,
        parameters=parameters,
        output='screen',
        respawn=respawn,
        respawn_delay=RESPAWN_DELAY_S,
        sigterm_timeout=ENDING_S,
        sigkill_timeout=ENDING_S,
    )
