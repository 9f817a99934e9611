"""Topic table of the project: name, type, frame, rate and content of each topic.

Names are relative; a node in namespace ``trawl`` turns ``truth/winch`` into
``/trawl/truth/winch``. ``/clock`` and ``/diagnostics`` are absolute by ROS convention.
"""

from dataclasses import dataclass

from trawl_ros.records.truth import SIDES

NAMESPACE = 'trawl'

MAP = 'map'
VESSEL = 'vessel'
SONAR = 'sonar'
DOOR_FRAMES = {side: f'door_{side}' for side in SIDES}

WINCH_NAMES = tuple(f'{side}_warp' for side in SIDES)
"""Joint names of the winches, in the order of `SIDES`."""


@dataclass(frozen=True)
class Topic:
    """Topic: a row of the table.

    ``frame`` is ``header.frame_id`` ('' where the type has no header), ``rate`` the usual
    rate in Hz (None: on an event), ``latched`` says that a late subscriber gets the last one.
    ``silence`` is how long (s) an instrument that works may say nothing at sea.
    """

    name: str
    type: str
    frame: str
    rate: float | None
    sentence: str
    latched: bool = False
    silence: float = 0.0


ACOUSTIC_SILENCE = 300.0
"""Longest silence (s) of an acoustic net sensor that works: those of a survey had up to 291 s in a
haul (public repository afsc-gap-products/trawlmetrics, vessel 94, 2022)."""


def _door_truth(side: str) -> tuple[Topic, ...]:
    door = DOOR_FRAMES[side]
    return (
        Topic(
            f'truth/door/{side}/odom',
            'nav_msgs/msg/Odometry',
            MAP,
            10.0,
            f'Pose of the {side} door in map, twist in the door frame.',
        ),
        Topic(
            f'truth/door/{side}/angles',
            'geometry_msgs/msg/Vector3Stamped',
            MAP,
            10.0,
            'x = attack α, y = slip β, z = inclination δ (unsigned), rad.',
        ),
        Topic(
            f'truth/door/{side}/wrench',
            'geometry_msgs/msg/WrenchStamped',
            door,
            10.0,
            'Hydrodynamic force (N) and moment (N m) in the door frame.',
        ),
    )


def _door_instruments(side: str) -> tuple[Topic, ...]:
    door = DOOR_FRAMES[side]
    return (
        Topic(
            f'door/{side}/pressure',
            'sensor_msgs/msg/FluidPressure',
            door,
            1.0,
            f'Absolute pressure at the {side} door, Pa.',
        ),
        Topic(
            f'door/{side}/attitude',
            'sensor_msgs/msg/Imu',
            door,
            1.0,
            f'Inclinometer of the {side} door: pitch and roll, yaw unknown, no rates.',
        ),
    )


TRUTH = (
    *_door_truth('port'),
    *_door_truth('starboard'),
    Topic(
        'truth/net/mouth',
        'geometry_msgs/msg/PolygonStamped',
        MAP,
        10.0,
        'N points of the headrope from port to starboard, then N of the footrope back.',
    ),
    Topic(
        'truth/net/opening',
        'geometry_msgs/msg/Vector3Stamped',
        MAP,
        10.0,
        "x = horizontal opening, y = vertical opening, z = depth of the headrope's centre, m.",
    ),
    Topic(
        'truth/winch',
        'sensor_msgs/msg/JointState',
        MAP,
        10.0,
        'True warp length (m), pay-out speed (m/s) and tension at the block (N).',
    ),
    Topic(
        'truth/vessel/odom',
        'nav_msgs/msg/Odometry',
        MAP,
        10.0,
        'Ship over ground: pose in map, twist in vessel.',
    ),
    Topic(
        'truth/vessel/velocity_water',
        'geometry_msgs/msg/TwistStamped',
        VESSEL,
        10.0,
        'Ship relative to the water at the surface, m/s.',
    ),
    Topic(
        'truth/sonar/pose',
        'geometry_msgs/msg/PoseStamped',
        MAP,
        10.0,
        'Pose of frame sonar (x down, y port, z forward) in map.',
    ),
    Topic(
        'truth/sonar/section',
        'sensor_msgs/msg/PointCloud2',
        SONAR,
        10.0,
        "Where ropes and twine pass through the sonar's plane: x, y, z and diameter, m.",
    ),
    Topic(
        'truth/sonar/opening',
        'geometry_msgs/msg/Vector3Stamped',
        SONAR,
        10.0,
        "x = height, y = width of the mouth in the sonar's plane, m.",
    ),
    Topic(
        'truth/schools',
        'sensor_msgs/msg/PointCloud2',
        MAP,
        10.0,
        'Schools of fish: x, y, z, length, width, height (m), density (per m³).',
    ),
    Topic(
        'truth/seabed',
        'geometry_msgs/msg/Vector3Stamped',
        MAP,
        10.0,
        'Depth of the seabed: x = under the ship, y = under the headrope, m.',
    ),
    Topic(
        'truth/gear',
        'visualization_msgs/msg/MarkerArray',
        '',
        1.0,
        'Warps, doors, bridles and net to look at, in map.',
    ),
)

INSTRUMENTS = (
    Topic(
        'winch/joint_states',
        'sensor_msgs/msg/JointState',
        VESSEL,
        10.0,
        'Counter (m), pay-out speed (m/s) and load cell (N) of both winches.',
    ),
    *_door_instruments('port'),
    *_door_instruments('starboard'),
    Topic(
        'door/spread',
        'sensor_msgs/msg/Range',
        DOOR_FRAMES['port'],
        1.0,
        'Acoustic distance from door to door, m.',
        silence=ACOUSTIC_SILENCE,
    ),
    Topic(
        'sonar/pressure',
        'sensor_msgs/msg/FluidPressure',
        SONAR,
        1.0,
        "Absolute pressure at the headrope's centre, Pa.",
    ),
    Topic(
        'sonar/opening_height',
        'sensor_msgs/msg/Range',
        SONAR,
        None,
        "Vertical opening as the sonar's operator reads it, m.",
    ),
    Topic(
        'sonar/opening_width',
        'sensor_msgs/msg/Range',
        SONAR,
        None,
        "Horizontal opening as the sonar's operator reads it, m.",
    ),
    Topic(
        'sonar/image',
        'sensor_msgs/msg/Image',
        SONAR,
        None,
        'One sweep, mono8: a row per beam, a column per range cell.',
    ),
    Topic(
        'sonar/scan',
        'sensor_msgs/msg/LaserScan',
        SONAR,
        None,
        'First echo per beam with its intensity, for display.',
    ),
    Topic(
        'sonar/points',
        'sensor_msgs/msg/PointCloud2',
        MAP,
        None,
        'The echoes of a sweep in map, for display.',
    ),
    Topic(
        'sonar/bottom',
        'sensor_msgs/msg/Range',
        SONAR,
        1.0,
        "From the headrope's centre down to the seabed, m.",
        silence=ACOUSTIC_SILENCE,
    ),
    Topic(
        'vessel/velocity_water',
        'geometry_msgs/msg/TwistStamped',
        VESSEL,
        1.0,
        'Speed log: velocity through the water, m/s.',
    ),
    Topic(
        'vessel/velocity_ground',
        'geometry_msgs/msg/TwistStamped',
        MAP,
        1.0,
        'GPS: velocity over ground, m/s.',
    ),
    Topic(
        'vessel/heading',
        'sensor_msgs/msg/Imu',
        VESSEL,
        1.0,
        'Heading as ENU yaw; roll and pitch unknown, no rates.',
    ),
    Topic(
        'vessel/fix',
        'sensor_msgs/msg/NavSatFix',
        VESSEL,
        1.0,
        'Position, WGS 84.',
    ),
    Topic(
        'vessel/echo_sounder/depth',
        'sensor_msgs/msg/Range',
        VESSEL,
        1.0,
        'From the keel down to the seabed, m.',
    ),
    Topic(
        'vessel/echo_sounder/school',
        'sensor_msgs/msg/Range',
        VESSEL,
        1.0,
        'From the keel down to the uppermost fish under her, m; infinite without any.',
    ),
    Topic(
        'vessel/fish_sonar',
        'geometry_msgs/msg/PoseArray',
        VESSEL,
        0.1,
        'Where the fish sonar sees schools.',
    ),
)

ESTIMATES = (
    Topic(
        'identification/estimate',
        'std_msgs/msg/Float64MultiArray',
        '',
        None,
        'The twelve board coefficients in the order of eq. 36.',
        latched=True,
    ),
    Topic(
        'identification/covariance',
        'std_msgs/msg/Float64MultiArray',
        '',
        None,
        'Their covariance, 12 x 12 row-major.',
        latched=True,
    ),
    Topic(
        'identification/status',
        'diagnostic_msgs/msg/DiagnosticArray',
        '',
        None,
        'The same by name, with intervals, counts by reason, converged or not and why.',
        latched=True,
    ),
    Topic(
        'identification/innovation',
        'sensor_msgs/msg/JointState',
        '',
        None,
        'name = channel, position = innovation, velocity = its deviation, effort = test ratio.',
    ),
    Topic(
        'discrepancy/findings',
        'diagnostic_msgs/msg/DiagnosticArray',
        '',
        None,
        'One status per finding: verdict, effect, size, interval, evidence.',
        latched=True,
    ),
    Topic(
        'trial/status',
        'diagnostic_msgs/msg/DiagnosticArray',
        '',
        None,
        'Phase and target of a trial that runs itself, and why it holds or waits.',
        latched=True,
    ),
    Topic(
        '/diagnostics',
        'diagnostic_msgs/msg/DiagnosticArray',
        '',
        1.0,
        'One status per node and subsystem.',
    ),
)

COMMANDS = (
    Topic(
        'command/winch',
        'sensor_msgs/msg/JointState',
        VESSEL,
        None,
        'position = wanted warp length per winch, m.',
    ),
    Topic(
        'command/vessel',
        'geometry_msgs/msg/TwistStamped',
        VESSEL,
        None,
        'linear.x = wanted speed through water (m/s), angular.z = rate of turn to port (rad/s).',
    ),
    Topic(
        'command/fault',
        'diagnostic_msgs/msg/KeyValue',
        '',
        None,
        "key = instrument topic, or topic/quantity; value = fault, or 'none'.",
    ),
)

PICTURES = ('sonar/image', 'sonar/scan', 'sonar/points')
"""Of the instruments' topics those that take most of the room in a bag."""

RANGES = {
    'spread': 'door/spread',
    'opening_height': 'sonar/opening_height',
    'opening_width': 'sonar/opening_width',
    'bottom': 'sonar/bottom',
    'depth': 'vessel/echo_sounder/depth',
    'school': 'vessel/echo_sounder/school',
}
"""Topic of each distance, by what `RangeSample.what` says it is."""

CLOCK = Topic(
    '/clock', 'rosgraph_msgs/msg/Clock', '', None, 'Simulated time, when publish_clock is set.'
)

TRANSFORMS = Topic(
    '/tf', 'tf2_msgs/msg/TFMessage', '', 10.0, 'Frames in map, where tf2_msgs is installed.'
)

SYNC = 'sync/progress'
"""Topic on which consumers tell how far they have come; sources wait for the slowest."""

STATIC_TRANSFORMS = Topic(
    '/tf_static',
    TRANSFORMS.type,
    '',
    None,
    'Frames of others that stay, for viewers.',
    latched=True,
)

TOPICS = {
    topic.name: topic for topic in (*TRUTH, *INSTRUMENTS, *ESTIMATES, *COMMANDS, CLOCK, TRANSFORMS)
}


def absolute(name: str, namespace: str = NAMESPACE) -> str:
    """Return the full name of a topic, e.g. ``/trawl/truth/winch`` for ``truth/winch``."""
    if name.startswith('/'):
        return name
    return _prefix(namespace) + name


def find_topic(name: str, namespace: str = NAMESPACE) -> Topic | None:
    """Find the row for a relative or full topic name; None for a topic of somebody else."""
    if name in TOPICS:
        return TOPICS[name]
    return TOPICS.get(name.removeprefix(_prefix(namespace)))


def _prefix(namespace: str) -> str:
    inner = namespace.strip('/')
    return f'/{inner}/' if inner else '/'
