# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checks of the ROS graph: two clocks or sources, other types or QoS than expected."""

from collections.abc import Mapping, Sequence

from rclpy.duration import Infinite
from rclpy.node import Node
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible
from rclpy.topic_endpoint_info import TopicEndpointInfo

from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status
from trawl_ros.records.topics import (
    CLOCK,
    COMMANDS,
    STATIC_TRANSFORMS,
    SYNC,
    TRANSFORMS,
    find_topic,
)

OF_ANY_GRAPH = {SYNC, *(topic.name for topic in COMMANDS)}
"""Topics that a graph may do without, while another ship's graph has them."""

MOST_NAMED = 4


def elsewhere(node: Node, subscribed: Mapping[str, str]) -> str:
    """Say which topics nobody publishes here, and in which namespace somebody does.

    Another ship's graph is no reason to say so: with readings in the node's own namespace, or for
    commands and reports of progress, only topics count that nobody there listens to.

    Parameters
    ----------
    node
        The node.
    subscribed
        Types of its subscriptions, by full topic name.

    Returns
    -------
    str
        A sentence; empty where there is nothing to say, or ROS is shut down.
    """
    if not node.context.ok():
        return ''
    own = node.get_namespace().rstrip('/')
    wanted = {
        name.removeprefix(f'{own}/'): kind
        for name, kind in subscribed.items()
        if name.startswith(f'{own}/')
    }
    silent = {name: kind for name, kind in wanted.items() if not _published(node, f'{own}/{name}')}
    deaf = all(name in silent or name in OF_ANY_GRAPH for name in wanted)
    found: dict[str, set[str]] = {}
    for full, kinds in node.get_topic_names_and_types() if silent else ():
        for name in _ends(full) & silent.keys():
            place = full.removesuffix(f'/{name}')
            heard = node.count_subscribers(full) > 0
            hidden = heard and (name in OF_ANY_GRAPH or not deaf)
            if place != own and silent[name] in kinds and not hidden and _published(node, full):
                found.setdefault(place or '/', set()).add(name)
    return '; '.join(
        f'nobody publishes {_some(names)} in {own or "/"}, but the graph does in namespace '
        f'{place}; expected one namespace: start one side with '
        f'--ros-args -r __ns:={place}, or the other '
        f'with __ns:={own or "/"}'
        for place, names in sorted(found.items())
    )


def _some(names: set[str]) -> str:
    rest = len(names) - MOST_NAMED
    return ', '.join(sorted(names)[:MOST_NAMED]) + (f' and {rest} more' if rest > 0 else '')


def _published(node: Node, topic: str) -> bool:
    return bool(node.count_publishers(topic) > 0)


def _ends(full: str) -> set[str]:
    """Return all names that a topic may have in a namespace: ``b/c`` and ``c`` of ``/a/b/c``."""
    parts = full.strip('/').split('/')
    return {'/'.join(parts[first:]) for first in range(len(parts))}


SHARED = (
    '/diagnostics',
    SYNC,
    *(topic.name for topic in (*COMMANDS, TRANSFORMS, STATIC_TRANSFORMS)),
)
"""Topics on which several may speak."""


UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""Name that the middleware gives a node of which it has heard nothing but the publisher."""


def clock_status(node: Node) -> Status:
    """Return the status of a node's clock: its source, and a warning of several."""
    publishers = [info.node_name for info in node.get_publishers_info_by_topic(CLOCK.name)]
    names = ', '.join(sorted(publishers))
    simulated = bool(node.get_parameter('use_sim_time').value)
    values = {
        'publishers on /clock': str(len(publishers)),
        'use_sim_time': str(simulated).lower(),
        'time': f'{node.get_clock().now().nanoseconds / 1e9:.3f}',
    }
    if len(publishers) > 1:
        message = f'{len(publishers)} publishers on /clock ({names}); expected one'
        return Status('clock', ERROR, message, values)
    if simulated and not publishers:
        message = 'use_sim_time is set, but nobody publishes /clock'
        return Status('clock', WARN, message, values)
    if publishers and not simulated and node.get_name() not in publishers:
        message = f'{names} publishes /clock, but use_sim_time is not set; expected one clock'
        return Status('clock', WARN, message, values)
    return Status('clock', OK, 'simulated time' if publishers else 'system time', values)


def of_one_node(publishers: Sequence[TopicEndpointInfo]) -> bool:
    """True if publishers belong to nodes of one known name: a restarted node, or twins."""
    names = {(info.node_namespace, info.node_name) for info in publishers}
    return len(names) == 1 and UNKNOWN not in next(iter(names))


def connection_problems(
    node: Node, subscribed: Mapping[str, str], offered: Mapping[str, QoSProfile]
) -> list[str]:
    """Return a sentence for each connection that is not as expected.

    Parameters
    ----------
    node
        The node.
    subscribed
        Types of its subscriptions, by full topic name.
    offered
        With which quality of service it publishes, by full topic name.
    """
    problems = []
    shared = {node.resolve_topic_name(name) for name in SHARED}
    for topic, expected in subscribed.items():
        infos = node.get_publishers_info_by_topic(topic)
        for info in infos:
            if info.topic_type != expected:
                problems.append(
                    f'{topic} has type {info.topic_type} from {info.node_name}; expected {expected}'
                )
        if len(infos) > 1 and topic not in shared and find_topic(topic, node.get_namespace()):
            names = ', '.join(sorted(info.node_name for info in infos))
            problems.append(f'{len(infos)} publishers on {topic} ({names}); expected one')
    for topic, profile in offered.items():
        for info in node.get_subscriptions_info_by_topic(topic):
            if reason := _mismatch(_as_found(profile), info.qos_profile):
                problems.append(f'{topic}: nothing arrives at {info.node_name}: {reason}')
    return problems


def _as_found(profile: QoSProfile) -> QoSProfile:
    """Convert an own profile to the form in which others see it: no deadline where none is set."""
    return QoSProfile(
        depth=profile.depth,
        reliability=profile.reliability,
        durability=profile.durability,
        deadline=Infinite,
        liveliness_lease_duration=Infinite,
    )


def _mismatch(offered: QoSProfile, asked: QoSProfile) -> str:
    """Reason why publisher and subscriber are incompatible; empty where they match."""
    compatibility, reason = qos_check_compatible(offered, asked)
    if compatibility != QoSCompatibility.ERROR:
        return ''
    return '; '.join(
        part.removeprefix('ERROR:').strip() for part in reason.split(';') if 'ERROR' in part
    ).lower()
