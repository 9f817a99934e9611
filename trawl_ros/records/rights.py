"""Rights of each node: which topics it publishes and hears, which services it answers.

A node has no more than it uses, so that on a secured graph (SROS 2) an instrument cannot command
and nobody but controllers, set points and an operator writes ``command/*``.
"""

from dataclasses import dataclass

from trawl_ros.records.topics import (
    CLOCK,
    COMMANDS,
    ESTIMATES,
    INSTRUMENTS,
    STATIC_TRANSFORMS,
    SYNC,
    TRANSFORMS,
    TRUTH,
    Topic,
)


def _names(topics: tuple[Topic, ...], *beginnings: str) -> tuple[str, ...]:
    """Return names of topics, of those with certain beginnings where some are given."""
    names = [topic.name for topic in topics]
    return tuple(name for name in names if not beginnings or name.startswith(beginnings))


@dataclass(frozen=True)
class Rights:
    """Rights of a node beyond those that all nodes have.

    Attributes
    ----------
    publishes, hears
        Names of topics, relative to the namespace unless they begin with a slash.
    answers
        Services that it offers, ``~`` being the node.
    calls
        Services of others that it may call.
    """

    publishes: tuple[str, ...]
    hears: tuple[str, ...]
    answers: tuple[str, ...] = ()
    calls: tuple[str, ...] = ()


EVERY_NODE = Rights(
    publishes=('/rosout', '/parameter_events', '/diagnostics'),
    hears=(CLOCK.name,),
    answers=tuple(
        f'~/{service}'
        for service in (
            'describe_parameters',
            'get_parameter_types',
            'get_parameters',
            'get_type_description',
            'list_parameters',
            'set_parameters',
            'set_parameters_atomically',
        )
    ),
)
"""Rights of every node: to log, report, hear the clock and answer for its parameters."""

_FAULT = 'command/fault'
_READINGS = (
    *_names(INSTRUMENTS, 'door/', 'winch/'),
    'sonar/pressure',
    'sonar/opening_height',
    *_names(INSTRUMENTS, 'vessel/velocity', 'vessel/heading'),
)
"""Readings from which boards are identified."""

_SPOKEN = (
    *_READINGS,
    'sonar/bottom',
    'vessel/fix',
    'vessel/echo_sounder/depth',
)
"""Readings that ships' instruments send as sentences."""


_SHOWN = (
    *(
        name
        for name in _names(TRUTH)
        if not name.endswith(('/angles', '/wrench')) and name != 'truth/sonar/pose'
    ),
    *_names(INSTRUMENTS),
    'identification/status',
    'identification/innovation',
    *_names(ESTIMATES, 'discrepancy/', 'trial/'),
    'command/winch',
    'command/vessel',
)
"""Topics that are shown in space and over time."""


def _consumer(
    publishes: tuple[str, ...], hears: tuple[str, ...], answers: tuple[str, ...] = ()
) -> Rights:
    """Return the rights of a node for which sources wait."""
    return Rights((*publishes, SYNC), hears, answers)


RIGHTS = {
    'sim_node': Rights(
        publishes=(*_names(TRUTH), CLOCK.name, TRANSFORMS.name),
        hears=('command/winch', 'command/vessel', SYNC),
        answers=('pause', 'resume', 'step', 'reset'),
    ),
    'winch_node': _consumer(_names(INSTRUMENTS, 'winch/'), (_FAULT, 'truth/winch')),
    'door_sensor_node': _consumer(
        _names(INSTRUMENTS, 'door/'),
        (_FAULT, 'truth/door/port/odom', 'truth/door/starboard/odom'),
    ),
    'trawl_sonar_node': _consumer(
        _names(INSTRUMENTS, 'sonar/'),
        (
            _FAULT,
            'truth/net/opening',
            'truth/schools',
            'truth/seabed',
            'truth/sonar/pose',
            'truth/sonar/section',
        ),
    ),
    'vessel_node': _consumer(
        _names(INSTRUMENTS, 'vessel/'),
        (_FAULT, *_names(TRUTH, 'truth/vessel/'), 'truth/schools', 'truth/seabed'),
    ),
    'autotrawl_node': _consumer(('command/winch',), ('winch/joint_states',)),
    'autopilot_node': _consumer(
        ('command/vessel',),
        (
            'vessel/fish_sonar',
            'vessel/fix',
            'vessel/heading',
            'vessel/velocity_ground',
            'vessel/velocity_water',
        ),
    ),
    'trial_node': _consumer(
        ('command/winch', 'command/vessel', 'trial/status'),
        (
            'command/winch',
            'command/vessel',
            *_names(INSTRUMENTS, 'winch/'),
            'door/port/pressure',
            'door/starboard/pressure',
            'sonar/pressure',
            'sonar/opening_height',
            'sonar/bottom',
            'vessel/velocity_water',
            'vessel/heading',
            'vessel/echo_sounder/depth',
            'identification/status',
            SYNC,
        ),
        ('trial/pause', 'trial/resume', 'trial/veto', 'trial/take_over'),
    ),
    'nmea_in': Rights(_SPOKEN, ()),
    'nmea_out': _consumer((), _SPOKEN),
    'view_node': Rights((), _SHOWN),
    'foxglove_node': Rights(
        (),
        (
            *_names((*TRUTH, *INSTRUMENTS, *ESTIMATES, *COMMANDS)),
            TRANSFORMS.name,
            STATIC_TRANSFORMS.name,
        ),
    ),
    'identification_node': _consumer(
        _names(ESTIMATES, 'identification/'), _READINGS, ('identification/finish',)
    ),
    'discrepancy_node': _consumer(
        _names(ESTIMATES, 'discrepancy/'),
        (*_READINGS, 'vessel/echo_sounder/depth'),
        ('discrepancy/finish', 'discrepancy/acknowledge', 'discrepancy/dismiss'),
    ),
    'bag_recorder': _consumer((), _names((*TRUTH, *INSTRUMENTS, *ESTIMATES, *COMMANDS))),
    # Recorded commands are not played on a secured graph.
    'bag_player': Rights(
        (*_names((*TRUTH, *INSTRUMENTS, *ESTIMATES)), CLOCK.name, TRANSFORMS.name),
        (SYNC,),
        ('~/pause', '~/resume', '~/toggle_paused', '~/play_next'),
    ),
}
"""Rights by the name of the node."""

OPERATOR = 'operator'
"""Enclave of the people on the bridge: whoever holds its keys may command."""

SET_POINTS = 'set_points'
"""Enclave of an ``nmea_in`` that passes set points on. Nobody signs sentences: whoever reaches its
links commands then, so these rights are in an enclave of their own."""


def enclaves() -> dict[str, Rights]:
    """Return the rights by enclave: those of the nodes, of set points and of an operator."""
    said = RIGHTS['nmea_in'].publishes
    commanding = Rights((*said, 'command/winch', 'command/vessel'), ('winch/joint_states',))
    return {**RIGHTS, SET_POINTS: commanding, OPERATOR: operator_rights()}


def operator_rights() -> Rights:
    """Return the rights of an operator: all is heard, every command and service may be used."""
    services = [
        service.replace('~', node)
        for node, rights in RIGHTS.items()
        for service in (*rights.answers, *EVERY_NODE.answers)
    ]
    return Rights(
        _names(COMMANDS),
        (
            *_names((*TRUTH, *INSTRUMENTS, *ESTIMATES, *COMMANDS)),
            TRANSFORMS.name,
            SYNC,
            '/rosout',
            '/parameter_events',
        ),
        calls=tuple(services),
    )
