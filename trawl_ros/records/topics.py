# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Registry of the topics of truth, estimates and commands, and of all topics by name.

Names are relative; a node in namespace ``trawl`` turns ``truth/winch`` into ``/trawl/truth/winch``.
``/clock`` and ``/diagnostics`` are absolute by ROS convention. Rows of instruments are in
`trawl_ros.records.sensors`.
"""

from trawl_ros.records.registry import DOOR_FRAMES as DOOR_FRAMES
from trawl_ros.records.registry import MAP as MAP
from trawl_ros.records.registry import NAMESPACE as NAMESPACE
from trawl_ros.records.registry import ODOM as ODOM
from trawl_ros.records.registry import SONAR as SONAR
from trawl_ros.records.registry import VESSEL as VESSEL
from trawl_ros.records.registry import WINCH_NAMES as WINCH_NAMES
from trawl_ros.records.registry import Topic as Topic
from trawl_ros.records.samples import PICTURES as PICTURES
from trawl_ros.records.samples import RANGES as RANGES
from trawl_ros.records.sensors import INSTRUMENTS as INSTRUMENTS
from trawl_ros.records.truth import SIDES

_SIM = ('sim_node',)
_SHOWN = ('view_node',)
_OBSERVERS = tuple(dict.fromkeys(row.published_by[0] for row in INSTRUMENTS if row.errors))
"""Nodes whose sensors only measure observables."""
_IDENTIFIED = ('identification_node',)


def _door(side: str) -> tuple[Topic, ...]:
    return (
        Topic(
            f'truth/door/{side}/odom', 'nav_msgs/msg/Odometry', MAP, 10.0,
            f'Pose of the {side} door in map, twist in the door frame.', _SIM,
            ('door_sensor_node', 'view_node'),
        ),
        Topic(
            f'truth/door/{side}/angles', 'geometry_msgs/msg/Vector3Stamped', MAP, 10.0,
            'x = attack α, y = slip β, z = inclination δ (unsigned), rad.', _SIM,
        ),
        Topic(
            f'truth/door/{side}/wrench', 'geometry_msgs/msg/WrenchStamped', DOOR_FRAMES[side], 10.0,
            'Hydrodynamic force (N) and moment (N m) in the door frame.', _SIM,
        ),
    )  # fmt: skip


TRUTH = (
    *_door('port'),
    *_door('starboard'),
    Topic(
        'truth/net/mouth', 'geometry_msgs/msg/PolygonStamped', MAP, 10.0,
        'N points of the headrope from port to starboard, then N of the footrope back.', _SIM,
        _SHOWN,
    ),
    Topic(
        'truth/net/opening', 'geometry_msgs/msg/Vector3Stamped', MAP, 10.0,
        "x = horizontal opening, y = vertical opening, z = depth of the headrope's centre, m.",
        _SIM, ('trawl_sonar_node', 'view_node'),
    ),
    Topic(
        'truth/winch', 'sensor_msgs/msg/JointState', MAP, 10.0,
        'True warp length (m), pay-out speed (m/s) and tension at the block (N).', _SIM,
        ('winch_node', 'view_node'),
    ),
    Topic(
        'truth/vessel/odom', 'nav_msgs/msg/Odometry', MAP, 10.0,
        'Ship over ground: pose in map, twist in vessel.', _SIM, ('vessel_node', 'view_node'),
    ),
    Topic(
        'truth/vessel/velocity_water', 'geometry_msgs/msg/TwistStamped', VESSEL, 10.0,
        'Ship relative to the water at the surface, m/s.', _SIM, ('vessel_node', 'view_node'),
    ),
    Topic(
        'truth/sonar/pose', 'geometry_msgs/msg/PoseStamped', MAP, 10.0,
        'Pose of frame sonar (x down, y port, z forward) in map.', _SIM, ('trawl_sonar_node',),
    ),
    Topic(
        'truth/sonar/section', 'sensor_msgs/msg/PointCloud2', SONAR, 10.0,
        "Where ropes and twine pass through the sonar's plane: x, y, z and diameter, m.", _SIM,
        ('trawl_sonar_node', 'view_node'),
    ),
    Topic(
        'truth/sonar/opening', 'geometry_msgs/msg/Vector3Stamped', SONAR, 10.0,
        "x = height, y = width of the mouth in the sonar's plane, m.", _SIM, _SHOWN,
    ),
    Topic(
        'truth/schools', 'sensor_msgs/msg/PointCloud2', MAP, 10.0,
        'Schools of fish: x, y, z, length, width, height (m), density (per m³).', _SIM,
        ('trawl_sonar_node', 'vessel_node', 'view_node'),
    ),
    Topic(
        'truth/seabed', 'geometry_msgs/msg/Vector3Stamped', MAP, 10.0,
        'Depth of the seabed: x = under the ship, y = under the headrope, m.', _SIM,
        ('trawl_sonar_node', 'vessel_node', 'view_node'),
    ),
    Topic(
        'truth/observables', 'sensor_msgs/msg/JointState', MAP, 10.0,
        'Observables of the model: name, and position = value (m, N, rad).', _SIM, _OBSERVERS,
    ),
    Topic(
        'truth/gear', 'visualization_msgs/msg/MarkerArray', '', 1.0,
        'Warps, doors, bridles and net to look at, in map.', _SIM, _SHOWN,
    ),
)  # fmt: skip

ESTIMATES = (
    Topic(
        'identification/estimate', 'std_msgs/msg/Float64MultiArray', '', None,
        'The board coefficients; the label names them.', _IDENTIFIED, latched=True,
    ),
    Topic(
        'identification/covariance', 'std_msgs/msg/Float64MultiArray', '', None,
        'Their covariance, row-major.', _IDENTIFIED, latched=True,
    ),
    Topic(
        'identification/status', 'diagnostic_msgs/msg/DiagnosticArray', '', None,
        'The estimate by name: intervals, counts by reason, converged or not and why.',
        _IDENTIFIED, ('trial_node', 'view_node'), latched=True,
    ),
    Topic(
        'identification/innovation', 'sensor_msgs/msg/JointState', '', None,
        'name = channel, position = innovation, velocity = its deviation, effort = test ratio.',
        _IDENTIFIED, _SHOWN,
    ),
    Topic(
        'discrepancy/findings', 'diagnostic_msgs/msg/DiagnosticArray', '', None,
        'One status per finding: verdict, effect, size, interval, evidence.',
        ('discrepancy_node',), _SHOWN, latched=True,
    ),
    Topic(
        'trial/status', 'diagnostic_msgs/msg/DiagnosticArray', '', None,
        'Phase and target of a trial that runs itself, and why it holds or waits.',
        ('trial_node',), _SHOWN, latched=True,
    ),
    Topic(
        '/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray', '', 1.0,
        'One status per node and subsystem.',
    ),
)  # fmt: skip

WITH_COVARIANCE = '_with_covariance'
"""End of the name of a topic that carries the covariance too."""

_STATED = 'with the stated noise, as robot_localization takes it.'


def _velocity_twin(over: str, frame: str) -> Topic:
    return Topic(
        f'vessel/velocity_{over}{WITH_COVARIANCE}', 'geometry_msgs/msg/TwistWithCovarianceStamped',
        frame, 1.0, f'vessel/velocity_{over} {_STATED}', ('vessel_node',),
    )  # fmt: skip


def _depth_twin(place: str, node: str) -> Topic:
    return Topic(
        f'{place}/depth{WITH_COVARIANCE}', 'geometry_msgs/msg/PoseWithCovarianceStamped', MAP, 1.0,
        f'{place}/pressure as z of a position, {_STATED}', (node,),
    )  # fmt: skip


TWINS = (
    _velocity_twin('water', VESSEL),
    _velocity_twin('ground', MAP),
    *(_depth_twin(f'door/{side}', 'door_sensor_node') for side in SIDES),
    _depth_twin('sonar', 'trawl_sonar_node'),
    Topic(
        'identification/coefficients', 'diagnostic_msgs/msg/DiagnosticArray', '', None,
        'The estimate with its stamp: a status per coefficient with value, std, determined or not.',
        _IDENTIFIED, latched=True,
    ),
    Topic(
        'identification/innovations', 'diagnostic_msgs/msg/DiagnosticArray', '', None,
        'A status per channel with innovation, its deviation, test ratio and unit.', _IDENTIFIED,
    ),
)  # fmt: skip
"""Topics that say in another type what others say; a recorder has them where asked to."""

_TETHERED = ('tether_node',)

TETHER = (
    Topic(
        'tether/odom', 'nav_msgs/msg/Odometry', MAP, None,
        'Vehicle of another simulator: pose with z up from the surface, twist in its own axes.',
        heard_by=_TETHERED,
    ),
    Topic(
        'tether/wrench', 'geometry_msgs/msg/WrenchStamped', VESSEL, 10.0,
        'Force and moment of the gear on the origin of the vehicle, in its axes.', _TETHERED,
    ),
    *(
        Topic(
            f'tether/{side}/force', 'geometry_msgs/msg/Vector3Stamped', MAP, 10.0,
            f'Force of the {side} warp on its block, N, in the frame of the odometry.', _TETHERED,
        )
        for side in SIDES
    ),
    Topic(
        'tether/gear', 'visualization_msgs/msg/MarkerArray', MAP, 1.0,
        'The towed gear as line segments coloured by tension.', _TETHERED, ('foxglove_node',),
    ),
)  # fmt: skip
"""Topics of a gear behind a vehicle of another simulator; its frames are those of its odometry."""

COMMANDS = (
    Topic(
        'command/winch', 'sensor_msgs/msg/JointState', VESSEL, None,
        'position = wanted warp length per winch, m.',
        ('autotrawl_node', 'trial_node', 'set_points'),
        ('sim_node', 'tether_node', 'trial_node', 'view_node'),
    ),
    Topic(
        'command/vessel', 'geometry_msgs/msg/TwistStamped', VESSEL, None,
        'linear.x = wanted speed through water (m/s), angular.z = rate of turn to port (rad/s).',
        ('autopilot_node', 'trial_node', 'set_points'), ('sim_node', 'trial_node', 'view_node'),
    ),
    Topic(
        'command/fault', 'diagnostic_msgs/msg/KeyValue', '', None,
        "key = instrument topic, or topic/quantity; value = fault, or 'none'.",
        heard_by=('winch_node', 'door_sensor_node', 'trawl_sonar_node', 'vessel_node'),
    ),
)  # fmt: skip

CLOCK = Topic(
    '/clock', 'rosgraph_msgs/msg/Clock', '', None,
    'Simulated time, when publish_clock is set.', ('sim_node', 'bag_player'),
)  # fmt: skip

TRANSFORMS = Topic(
    '/tf', 'tf2_msgs/msg/TFMessage', '', 10.0, 'Frames in map, where tf2_msgs is installed.',
    ('sim_node', 'nmea_in', 'bag_player'), ('foxglove_node', 'operator'),
)  # fmt: skip

SYNC = 'sync/progress'
"""Topic on which consumers report their progress; sources wait for the slowest one."""

STATIC_TRANSFORMS = Topic(
    '/tf_static', TRANSFORMS.type, '', None,
    'Frames of sensors in the frame that they are fixed to, where tf2_msgs is installed.',
    ('vessel_node', 'door_sensor_node', 'trawl_sonar_node', 'nmea_in'),
    ('foxglove_node',), latched=True,
)  # fmt: skip

CONTRACT: tuple[Topic, ...] = (*TRUTH, *INSTRUMENTS, *ESTIMATES, *COMMANDS)
"""Topics that are recorded."""

TOPICS: dict[str, Topic] = {
    topic.name: topic
    for topic in (*CONTRACT, *TWINS, *TETHER, CLOCK, TRANSFORMS, STATIC_TRANSFORMS)
}


def absolute(name: str, namespace: str = NAMESPACE) -> str:
    """Return the full name of a topic, e.g. ``/trawl/truth/winch`` for ``truth/winch``."""
    if name.startswith('/'):
        return name
    return _prefix(namespace) + name


def find_topic(name: str, namespace: str = NAMESPACE) -> Topic | None:
    """Return the row of a relative or full topic name; None for a topic of another project."""
    if name in TOPICS:
        return TOPICS[name]
    return TOPICS.get(name.removeprefix(_prefix(namespace)))


def _prefix(namespace: str) -> str:
    inner = namespace.strip('/')
    return f'/{inner}/' if inner else '/'
