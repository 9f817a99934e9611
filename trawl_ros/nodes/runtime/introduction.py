"""Introduction of a node: the lines of its log with which it starts."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

SAID = ('gear', 'scenario', 'mode', 'bag', 'output', 'state', 'time_scale', 'rate')
"""Parameters that say what a node works on."""

MOST_TOPICS = 6


def introduction(
    kind: type, values: Mapping[str, Any], namespace: str, topics: Mapping[str, Sequence[str]]
) -> list[str]:
    """Give the lines.

    Parameters
    ----------
    kind
        Class of the node; one that does not say what it does has nothing to say.
    values
        Parameters by name.
    namespace
        Of the node, with which names of topics are not to begin.
    topics
        Full names by what the node does with them.
    """
    words = vars(kind).get('__doc__')
    if not words:
        return []
    first = words.split('\n\n', 1)[0].split('. ', 1)[0]
    sentence = ' '.join(first.replace('`', '').split()).rstrip('.')
    work = [f'{name} {values[name]}' for name in SAID if values.get(name) not in (None, '')]
    lines = [f'{sentence} ({", ".join(work)})' if work else sentence]
    listed = [f'{what} {_some(names, namespace)}' for what, names in topics.items() if names]
    return [*lines, f'in {namespace}: {"; ".join(listed)}'] if listed else lines


def _some(names: Iterable[str], namespace: str) -> str:
    short = [name.removeprefix(f'{namespace.rstrip("/")}/') for name in names]
    rest = len(short) - MOST_TOPICS
    return ', '.join(short[:MOST_TOPICS]) + (f' and {rest} more' if rest > 0 else '')
