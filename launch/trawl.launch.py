"""The whole chain on a full ROS 2: simulation, instruments, and what else is asked for.

``ros2 launch trawl_ros trawl.launch.py scenario:=demo record:=my_trial rviz:=true``

``ros2 launch trawl_ros trawl.launch.py --show-args`` lists the arguments. Two ships are two of
these, each with its own ``namespace`` and ``frame_prefix``.
"""

from typing import Any

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from launch import LaunchContext, LaunchDescription
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution

PACKAGE = 'trawl_ros'
INSTRUMENTS = ('winch_node', 'door_sensor_node', 'trawl_sonar_node', 'vessel_node')
SIMULATION, RECORDER = 'sim_node', 'bag_recorder'

ENDING_S = '20'
"""A node may take so long to say its last words on a busy machine; launch would give it 5 s."""

RESPAWN_DELAY_S = 2.0

ARGUMENTS = (
    ('scenario', '', 'Scenario file or name; without one the ship tows straight on.'),
    ('gear', 'kaifuha', 'Gear file or name, where no scenario brings its own.'),
    ('time_scale', '1.0', 'Simulated seconds per second; 0 is as fast as the listeners follow.'),
    ('record', '', 'Folder of a bag to record into; nothing is recorded without one.'),
    ('rviz', 'false', 'Whether to open RViz, and robot_state_publisher for the shapes.'),
    ('namespace', 'trawl', 'Namespace of the nodes; the files for viewers look in trawl.'),
    ('frame_prefix', '', 'Put before the names of all frames but map, as ship_a/.'),
    ('params_file', '', 'YAML file of parameters; those given here go before it.'),
    ('instruments', '', 'File or name of instrument parameters, where no scenario brings its own.'),
    ('seed', '-1', 'Seed of all noise; -1 is that of the scenario, or 0.'),
    ('nodes', ','.join((SIMULATION, *INSTRUMENTS)), 'Nodes to start, separated by commas: any '
     'executable of the package. The simulation waits for the instruments among them.'),
    ('respawn', 'false', 'Whether nodes that end with an error start again.'),
)  # fmt: skip


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
    scale = float(given['time_scale'])
    # At another pace than that of the wall the simulation gives the time.
    clock = {'use_sim_time': scale != 1.0}
    wanted = [name.strip() for name in given['nodes'].split(',') if name.strip()]
    recorders = [RECORDER] if given['record'] else []
    wanted += [name for name in recorders if name not in wanted]
    tow = {name: given[name] for name in ('gear', 'scenario') if given[name]}
    instruments = [name for name in INSTRUMENTS if name in wanted]
    own: dict[str, dict[str, Any]] = {
        name: {
            **tow,
            **({'instruments': given['instruments']} if given['instruments'] else {}),
            'seed': int(given['seed']),
            **({'wait_for': recorders} if recorders else {}),
        }
        for name in instruments
    }
    own[RECORDER] = {'output': given['record']} if given['record'] else {}
    own[SIMULATION] = {**tow, 'time_scale': scale, 'wait_for': [*instruments, *recorders]}
    if not own[SIMULATION]['wait_for']:
        del own[SIMULATION]['wait_for']
    prefix = {'frame_prefix': given['frame_prefix']} if given['frame_prefix'] else {}
    files = [given['params_file']] if given['params_file'] else []
    respawn = given['respawn'].lower() == 'true'
    nodes = []
    for name in wanted:
        timed = {} if name == SIMULATION else clock
        parameters = [*files, {**own.get(name, {}), **prefix, **timed}]
        nodes.append(_node(name, given['namespace'], parameters, respawn))
    if given['rviz'].lower() == 'true':
        nodes += _display(given, clock)
    return nodes


def _display(given: dict[str, str], clock: dict[str, Any]) -> list[Node]:
    """RViz and the publisher of the shapes, by the time that the nodes go by."""
    share = FindPackageShare(PACKAGE)
    view = PathJoinSubstitution([share, 'config', 'rviz', 'trawl.rviz'])
    shapes = PathJoinSubstitution([share, 'config', 'urdf', 'trawl.urdf'])
    prefix = {'frame_prefix': given['frame_prefix']}
    return [
        Node(package='rviz2', executable='rviz2', arguments=['-d', view], parameters=[clock]),
        Node(
            package='robot_state_publisher',
            executable='robot_state_publisher',
            namespace=given['namespace'],
            arguments=[shapes],
            parameters=[{**clock, **prefix}],
        ),
    ]


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
