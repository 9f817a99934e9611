"""The page of docs/interface.md, drawn from the registry and the parameters of the nodes.

`python test/interface/page.py` draws it again.
"""

from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from types import ModuleType

from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.nodes.runtime.datum import datum_specs
from trawl_ros.nodes.runtime.frames import frame_specs
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import FIXED, Flag, Names, Number, Spec
from trawl_ros.nodes.runtime.qos import LARGE_TYPES, LARGE_WAIT_S, offered
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.frames import (
    DOOR_MOUNTS,
    FRAME_SENTENCES,
    WIDTH_MOUNT,
    WITHOUT_PREFIX,
    echo_sounder_mount,
)
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.registry import Sensor, Topic
from trawl_ros.records.rights import EVERY_NODE, NODE_RIGHTS
from trawl_ros.records.topics import (
    CLOCK,
    COMMANDS,
    ESTIMATES,
    INSTRUMENTS,
    STATIC_TRANSFORMS,
    SYNC,
    TETHER,
    TRANSFORMS,
    TRUTH,
    TWINS,
    WINCH_NAMES,
)

DOCUMENT = Path(__file__).parents[2] / 'docs' / 'interface.md'
NODES = tuple(NODE_RIGHTS)
WITH_DATUM = ('vessel_node', 'autopilot_node', 'nmea_in')

CONVENTIONS = {
    'sensor_msgs/msg/JointState': ('m, m/s, N', 'NaN'),
    'sensor_msgs/msg/FluidPressure': ('Pa; variance Pa²', 'no message; NaN'),
    'sensor_msgs/msg/Imu': (
        'quaternion; covariance rad²',
        'orientation_covariance[0] −1 where absent, variance 1e6 where not measured',
    ),
    'sensor_msgs/msg/Range': (
        'm; variance m²', '+Inf beyond max_range, −Inf below min_range, NaN lost (REP-117)',
    ),
    'sensor_msgs/msg/LaserScan': ('m, rad, s', '+Inf without an echo (REP-117)'),
    'sensor_msgs/msg/Image': ('0 to 255', 'no message; dead rows are 0'),
    'sensor_msgs/msg/PointCloud2': ('m', 'no point'),
    'sensor_msgs/msg/NavSatFix': (
        'degrees (WGS 84); covariance m²', 'status −1 and NaN; altitude is always NaN',
    ),
    'geometry_msgs/msg/TwistStamped': ('m/s, rad/s', 'NaN'),
    'geometry_msgs/msg/TwistWithCovarianceStamped': (
        'm/s, rad/s; covariance of their squares', 'no message; variance 1e6 where not measured',
    ),
    'geometry_msgs/msg/PoseWithCovarianceStamped': (
        'm; covariance m², rad²', 'no message; variance 1e6 where not measured',
    ),
    'geometry_msgs/msg/Vector3Stamped': ('m', 'NaN'),
    'geometry_msgs/msg/WrenchStamped': ('N, N m', 'never missing'),
    'geometry_msgs/msg/PolygonStamped': ('m', 'never missing'),
    'geometry_msgs/msg/PoseStamped': ('m, quaternion', 'never missing'),
    'geometry_msgs/msg/PoseArray': ('m, quaternion', 'no pose'),
    'nav_msgs/msg/Odometry': (
        'm, quaternion, m/s, rad/s', 'never missing; covariance 0 unless odometry_std is set',
    ),
    'visualization_msgs/msg/MarkerArray': ('m', 'no marker'),
    'std_msgs/msg/Float64MultiArray': ('1', 'no message'),
    'std_msgs/msg/Header': ('ns', 'no message'),
    'diagnostic_msgs/msg/DiagnosticArray': ('said with each value', 'empty text'),
    'diagnostic_msgs/msg/KeyValue': ('SI', 'no message'),
    'rosgraph_msgs/msg/Clock': ('ns', 'no message'),
    'tf2_msgs/msg/TFMessage': ('m, quaternion', 'no transform'),
}  # fmt: skip
"""Units of a type's numbers, and what stands for a missing one."""

MISSING = {
    'truth/seabed': '+Inf where there is no seabed',
    'vessel/echo_sounder/school': '+Inf without fish (REP-117)',
    'truth/observables': 'no message',
    'command/winch': 'winch not named',
}
"""What stands for a missing number of single topics."""

UNITS = {
    **dict.fromkeys(('truth/door/port/angles', 'truth/door/starboard/angles'), 'rad'),
    **dict.fromkeys(('winch/port/warp_angles', 'winch/starboard/warp_angles'), 'rad'),
    **dict.fromkeys(('tether/port/force', 'tether/starboard/force'), 'N'),
    'truth/observables': 'm, N, rad',
    'identification/innovation': 'that of the channel; effort 1',
    'command/winch': 'm, m/s',
}
"""Units of single topics."""

SERVICE_SENTENCES = {
    'pause': 'Stop the tow where it is; truth and clock stand still.',
    'resume': 'Go on after pause.',
    'step': 'Advance a paused tow to its next truth.',
    'reset': 'Return to the start of the tow.',
    'trial/pause': 'Hold the present state.',
    'trial/resume': 'Go on after pause or a take-over.',
    'trial/veto': 'Strike off the state that is wanted now.',
    'trial/take_over': 'Leave winches and ship to the caller.',
    'identification/finish': 'Fit with all that has come, and write the report.',
    'discrepancy/finish': 'Diagnose with all that has come, and write the report.',
    'discrepancy/acknowledge': 'Note that the newest finding is known.',
    'discrepancy/dismiss': 'Note that the newest finding is none.',
    '~/pause': 'Stop playing.',
    '~/resume': 'Go on playing.',
    '~/toggle_paused': 'Stop or go on.',
    '~/play_next': 'Play the next message of a paused bag.',
}

PROGRESS = Topic(
    SYNC, 'std_msgs/msg/Header', '', 2.0, 'Progress of consumers: frame_id is the node, stamp how '
    'far it is. Sources wait for the slowest one.',
)  # fmt: skip

SECTIONS: dict[str, tuple[Topic, ...]] = {
    'Truth': TRUTH,
    'Instruments': INSTRUMENTS,
    'With covariance, and estimates by name': TWINS,
    'Estimates and states': ESTIMATES,
    'Commands': COMMANDS,
    'Behind a vehicle of another simulator': TETHER,
    'Clock, transforms and progress': (CLOCK, TRANSFORMS, STATIC_TRANSFORMS, PROGRESS),
}


def module(node: str) -> ModuleType:
    return import_module(f'trawl_ros.nodes.{node}')


def node_class(node: str) -> type[TrawlNode]:
    """Class of a node: the one that its module defines."""
    found = [
        kind
        for kind in vars(module(node)).values()
        if isinstance(kind, type)
        and issubclass(kind, TrawlNode)
        and kind.__module__ == f'trawl_ros.nodes.{node}'
    ]
    (kind,) = found
    return kind


def specs(node: str) -> tuple[Spec, ...]:
    """Parameters of a node."""
    datum = datum_specs(load_instruments().vessel) if node in WITH_DATUM else ()
    return (*node_class(node).SPECS, *datum, *frame_specs(node))


def qos(topic: Topic) -> str:
    profile = offered(topic)
    durability = profile.durability.name.lower().replace('_', '-')
    return f'{profile.reliability.name.lower()}, {durability}, depth {profile.depth}'


def quoted(names: Iterable[str]) -> str:
    return ', '.join(f'`{name}`' for name in names)


def table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    listed = list(heads)
    lines = [listed, ['---'] * len(listed), *rows]
    # A bar would end the cell, and what looks like a tag or stars would be one.
    return '\n'.join(
        f'| {" | ".join(cell.replace("|", chr(92) + "|").replace(" <", " &lt;") for cell in row)} |'
        for row in lines
    )


def topic_row(topic: Topic) -> tuple[str, ...]:
    unit, missing = CONVENTIONS[topic.type]
    unit, missing = UNITS.get(topic.name, unit), MISSING.get(topic.name, missing)
    rate = f'{topic.rate:g} Hz' if topic.rate else 'on an event'
    if isinstance(topic, Sensor) and topic.rate is None:
        rate = 'per sweep'
    return (
        f'`{topic.name}`',
        topic.type.replace('/msg/', '/'),
        f'`{topic.frame}`' if topic.frame else '',
        rate,
        unit,
        missing,
        'latched' if topic.latched else '',
        topic.sentence,
    )


def parameter_row(spec: Spec) -> tuple[str, ...]:
    unit = bounds = ''
    if isinstance(spec, Number):
        unit = spec.unit if spec.unit != 'none' else ''
        bounds = f'{spec.low:g} to {spec.high:g}'
    elif isinstance(spec, Flag):
        bounds = 'true, false'
    elif not isinstance(spec, Names) and spec.choices:
        bounds = ', '.join(spec.choices)
    default = spec.default
    if isinstance(default, bool):
        said = str(default).lower()
    elif isinstance(default, tuple):
        said = ', '.join(default)
    else:
        said = f'{default:.6g}' if isinstance(default, int | float) else default
    change = 'yes' if spec.live else ''
    return f'`{spec.name}`', f'`{said}`' if said else '', unit, bounds, change, spec.sentence


def frames_table() -> str:
    mounts = {
        mount.frame: mount
        for mount in (
            echo_sounder_mount(load_instruments().vessel.draught_m),
            *DOOR_MOUNTS,
            WIDTH_MOUNT,
        )
    }
    return table(
        ('frame', 'parameter', 'fixed to', 'origin and axes'),
        (
            (
                f'`{frame}`',
                f'`{frame}_frame`' + (', no prefix' if frame in WITHOUT_PREFIX else ''),
                f'`{mounts[frame].parent}`' if frame in mounts else '',
                sentence,
            )
            for frame, sentence in FRAME_SENTENCES.items()
        ),
    )


def joints_table() -> str:
    named = {
        '`winch/joint_states`, `truth/winch`, `command/winch`': WINCH_NAMES,
        '`truth/observables`': OBSERVABLES,
        '`identification/estimate`, statuses of `identification/coefficients`': COEFFICIENTS,
    }
    rows = ((topics, quoted(names)) for topics, names in named.items())
    return table(('topic', 'names in order'), rows)


def services_table() -> str:
    rows = (
        (f'`{service}`', f'`{node}`', 'std_srvs/Trigger', SERVICE_SENTENCES[service])
        for node, rights in NODE_RIGHTS.items()
        for service in rights.answers
    )
    return table(('service', 'node', 'type', 'what it does'), rows)


def node_section(node: str) -> str:
    rights = NODE_RIGHTS[node]
    ways = {
        'Publishes': rights.publishes, 'Listens to': rights.hears, 'Services': rights.answers,
    }  # fmt: skip
    said = [f'{way}: {quoted(names)}.' for way, names in ways.items() if names]
    heads = ('parameter', 'default', 'unit', 'range', 'at run time', 'meaning')
    rows = table(heads, map(parameter_row, specs(node)))
    return '\n\n'.join([f'### {node}', *said, rows])


def page() -> str:
    """Text of the page."""
    heads = (
        'topic',
        'type',
        'frame',
        'rate',
        'units',
        'where a value is missing',
        'durability',
        'content',
    )
    topics = [
        f'### {title}\n\n{table(heads, map(topic_row, rows))}' for title, rows in SECTIONS.items()
    ]
    return '\n\n'.join(
        [
            '# Interface of the nodes',
            'Drawn from the code by `python test/interface/page.py`; tests hold it to the running '
            'graph. Names without a slash in front are relative to the namespace, `/trawl` by '
            'default. Units are SI and angles radians (REP-103).',
            '## Frames',
            'Parameters give frames other names: `frame_prefix` goes before all but that of '
            '`map`. `vessel_frame:=base_link` and `odom_frame:=odom` make the tree of REP-105. '
            'Poses are on `/tf`, sensors on `/tf_static`, where tf2_msgs is installed; '
            '`config/urdf/trawl.urdf` has the same frames with shapes. A range is measured along '
            'x of its frame.',
            frames_table(),
            '## Quality of service',
            f'Publishers offer {qos(CLOCK)}; latched topics {qos(STATIC_TRANSFORMS)}; '
            f'of {" and ".join(LARGE_TYPES)} they keep {LARGE_WAIT_S:g} s. '
            '`qos_overrides` change history, depth and reliability of each. Subscribers take best '
            'effort too.',
            '## Topics',
            *topics,
            '## Joint names',
            joints_table(),
            '## Services',
            f'Each node also offers {quoted(EVERY_NODE.answers)}.',
            services_table(),
            '## Nodes and parameters',
            f'What cannot be changed at run time is refused: "{FIXED}". Every node publishes '
            '`/diagnostics` at 1 Hz (REP-107).',
            *map(node_section, NODES),
        ]
    ) + '\n'  # fmt: skip


if __name__ == '__main__':
    DOCUMENT.write_text(page(), encoding='utf-8')
