"""Topics that a node listens to and that are published in another namespace than its own."""

from collections.abc import Mapping

from rclpy.node import Node

from trawl_ros.records.topics import COMMANDS, SYNC

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
