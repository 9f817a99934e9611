"""The whole chain on a full ROS 2: simulation, instruments and, where wanted, recorder and RViz.

``ros2 launch trawl_ros trawl.launch.py scenario:=demo record:=my_trial rviz:=true``

Everything runs in namespace ``trawl``, where the files for RViz, Foxglove and PlotJuggler look.
"""

from typing import Any

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from launch import LaunchContext, LaunchDescription

PACKAGE = 'trawl_ros'
NAMESPACE = 'trawl'
INSTRUMENTS = ('winch_node', 'door_sensor_node', 'trawl_sonar_node', 'vessel_node')
RECORDER = 'bag_recorder'

ENDING_S = '20'
"""A node may take so long to say its last words on a busy machine; launch would give it 5 s."""

ARGUMENTS = (
    ('scenario', '', 'Scenario file or name; without one the ship tows straight on.'),
    ('gear', 'kaifuha', 'Gear file or name, where no scenario brings its own.'),
    ('time_scale', '1.0', 'Simulated seconds per second; 0 is as fast as the listeners follow.'),
    ('record', '', 'Folder of a bag to record into; nothing is recorded without one.'),
    ('rviz', 'false', 'Whether to open RViz.'),
)


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments, and start what they ask for."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=sentence)
        for name, default, sentence in ARGUMENTS
    ]
    view = PathJoinSubstitution([FindPackageShare(PACKAGE), 'config', 'rviz', 'trawl.rviz'])
    rviz = Node(
        package='rviz2',
        executable='rviz2',
        arguments=['-d', view],
        condition=IfCondition(LaunchConfiguration('rviz')),
    )
    return LaunchDescription([*declared, OpaqueFunction(function=start_nodes), rviz])


def start_nodes(context: LaunchContext) -> list[Node]:
    """Start the nodes; who listens is waited for, so that the beginning is not lost."""
    given = {name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS}
    scale = float(given['time_scale'])
    what: dict[str, Any] = {'gear': given['gear']}
    if given['scenario']:
        what['scenario'] = given['scenario']
    # At another pace than that of the wall the simulation gives the time.
    clock = {'use_sim_time': scale != 1.0}
    recorders = [RECORDER] if given['record'] else []
    waiting = {'wait_for': recorders} if recorders else {}
    nodes = [_node(name, {**what, **clock, **waiting}) for name in INSTRUMENTS]
    if recorders:
        nodes.append(_node(RECORDER, {'output': given['record'], **clock}))
    listeners = [*INSTRUMENTS, *recorders]
    nodes.append(_node('sim_node', {**what, 'time_scale': scale, 'wait_for': listeners}))
    return nodes


def _node(executable: str, parameters: dict[str, Any]) -> Node:
    return Node(
        package=PACKAGE,
        executable=executable,
        namespace=NAMESPACE,
        parameters=[parameters],
        output='screen',
        sigterm_timeout=ENDING_S,
        sigkill_timeout=ENDING_S,
    )
