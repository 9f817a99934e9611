# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rights of each node: topics it publishes and subscribes to, and services it offers.

A node has only the rights it uses. On a secured graph (SROS 2) an instrument therefore cannot
command: only controllers, set points and an operator write ``command/*``.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from trawl_ros.records.topics import (
    CLOCK,
    COMMANDS,
    CONTRACT,
    ESTIMATES,
    INSTRUMENTS,
    STATIC_TRANSFORMS,
    SYNC,
    TETHER,
    TOPICS,
    TRANSFORMS,
    TRUTH,
    TWINS,
    Topic,
)


def _names(topics: Iterable[Topic]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(topic.name for topic in topics))


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
"""Rights of every node: to log, to report, to read the clock, and to offer its parameters."""

_SERVICES: dict[str, tuple[str, ...]] = {
    'sim_node': ('pause', 'resume', 'step', 'reset'),
    'winch_node': (),
    'door_sensor_node': (),
    'trawl_sonar_node': (),
    'vessel_node': (),
    'autotrawl_node': (),
    'autopilot_node': (),
    'trial_node': ('trial/pause', 'trial/resume', 'trial/veto', 'trial/take_over'),
    'nmea_in': (),
    'nmea_out': (),
    'view_node': (),
    'foxglove_node': (),
    'identification_node': ('identification/finish',),
    'discrepancy_node': ('discrepancy/finish', 'discrepancy/acknowledge', 'discrepancy/dismiss'),
    'bag_recorder': (),
    'tether_node': (),
    'bag_player': ('~/pause', '~/resume', '~/toggle_paused', '~/play_next'),
}
"""Services that each node offers."""

_SOURCES = ('sim_node', 'bag_player')
"""Nodes that wait for consumers."""

_NOT_WAITED_FOR = (*_SOURCES, 'nmea_in', 'set_points', 'tether_node', 'view_node', 'foxglove_node')

# Recorded commands are not played on a secured graph.
_ALL_PUBLISHED = {'bag_player': (*TRUTH, *INSTRUMENTS, *ESTIMATES)}
_ALL_HEARD = {'foxglove_node': (*CONTRACT, *TWINS, *TETHER), 'bag_recorder': CONTRACT}
"""Nodes that play, record or show every topic of some kinds."""


def _rights(node: str) -> Rights:
    """Return the rights of a node from the rows of the registry."""
    rows = TOPICS.values()
    publishes = [*_ALL_PUBLISHED.get(node, ()), *(row for row in rows if node in row.published_by)]
    hears = [*_ALL_HEARD.get(node, ()), *(row for row in rows if node in row.heard_by)]
    told = () if node in _NOT_WAITED_FOR else (SYNC,)
    waits = (SYNC,) if node in (*_SOURCES, 'trial_node') else ()
    return Rights((*_names(publishes), *told), (*_names(hears), *waits), _SERVICES.get(node, ()))


NODE_RIGHTS = {node: _rights(node) for node in _SERVICES}
"""Rights by the name of the node."""

OPERATOR = 'operator'
"""Enclave of the bridge: whoever holds its keys may command."""

SET_POINTS = 'set_points'
"""Enclave of an ``nmea_in`` that forwards set points.

Sentences are not signed, so anyone who reaches its links can command. These rights therefore have
an enclave of their own.
"""


def enclaves() -> dict[str, Rights]:
    """Return the rights by enclave: those of the nodes, of set points and of an operator."""
    said, own = NODE_RIGHTS['nmea_in'].publishes, _rights(SET_POINTS)
    commanding = Rights((*said, *own.publishes), own.hears)
    return {**NODE_RIGHTS, SET_POINTS: commanding, OPERATOR: operator_rights()}


def operator_rights() -> Rights:
    """Return the rights of an operator: to read every topic and use every command and service."""
    services = [
        service.replace('~', node)
        for node, rights in NODE_RIGHTS.items()
        for service in (*rights.answers, *EVERY_NODE.answers)
    ]
    return Rights(
        _names(COMMANDS),
        (
            *_names((*CONTRACT, *TWINS)),
            TRANSFORMS.name,
            STATIC_TRANSFORMS.name,
            SYNC,
            '/rosout',
            '/parameter_events',
        ),
        calls=tuple(services),
    )
