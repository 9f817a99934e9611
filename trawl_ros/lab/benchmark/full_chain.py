# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Publisher of all topics of the project at a steady rate, for measurements of the recorder.

Messages are valid and as large as on a tow; their content has no meaning.
"""

import json
import sys
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import numpy as np
from rosbags.interfaces import Nodetype

from trawl_ros.messages.cdr import STORE, serialize
from trawl_ros.messages.stamps import to_time
from trawl_ros.nodes.runtime.connected_node import DIAGNOSTICS
from trawl_ros.nodes.runtime.credit import Consumers, Pacer
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Names, Number
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.topics import COMMANDS, ESTIMATES, INSTRUMENTS, TRUTH, absolute

TOPICS = tuple(
    topic for topic in (*TRUTH, *INSTRUMENTS, *ESTIMATES, *COMMANDS) if topic.name != DIAGNOSTICS
)
SELDOM_HZ = 0.5
"""Rate of topics that are published on events."""

TICK_S = 0.004
NUMBERS = {
    'sensor_msgs/msg/Image': 200_000,
    'sensor_msgs/msg/LaserScan': 360,
    'sensor_msgs/msg/PointCloud2': 10_000,
}
"""Length of number sequences by type; 2 for other types."""

PARTS = {'visualization_msgs/msg/MarkerArray': 150, 'geometry_msgs/msg/PolygonStamped': 40}
"""Length of sequences of nested messages by type; 2 for other types."""

_EMPTY = {'string': '', 'bool': False, 'float32': 0.0, 'float64': 0.0}


def schedule(seconds: float, rate: float) -> list[tuple[float, int]]:
    """Schedule of `TOPICS` in time (s) with a total rate in Hz.

    Each topic has its share by its usual rate, and they are not all published at once.
    """
    usual = np.array([topic.rate or SELDOM_HZ for topic in TOPICS])
    periods = usual.sum() / (usual * rate)
    offsets = np.arange(len(TOPICS)) / len(TOPICS)
    return sorted(
        (float(time), number)
        for number, (period, offset) in enumerate(zip(periods, offsets, strict=True))
        for time in np.arange(offset * period, seconds, period)
    )


def example(type_name: str) -> Any:
    """Make a message of a type, of its usual length, with empty fields."""
    return _made(type_name, NUMBERS.get(type_name, 2), PARTS.get(type_name, 2))


def _made(type_name: str, numbers: int, parts: int) -> Any:
    _, fields = STORE.fielddefs[type_name]
    made = {name: _value(kind, numbers, parts) for name, kind in fields}
    return STORE.types[type_name](**made)


def _value(described: Any, numbers: int, parts: int) -> Any:
    kind, what = described
    if kind == Nodetype.BASE:
        return _EMPTY.get(what[0], 0)
    if kind == Nodetype.NAME:
        return _made(what, numbers, parts)
    inner, size = what
    if inner[0] == Nodetype.BASE and inner[1][0] != 'string':
        return np.zeros(size if kind == Nodetype.ARRAY else numbers, dtype=inner[1][0])
    # Of parts within parts the outer ones are many.
    return [_value(inner, 2, 2) for _ in range(size if kind == Nodetype.ARRAY else parts)]


def stamper(type_name: str) -> Callable[[int], bytes]:
    """Return a function that gives a message of a type with a stamp (ns), as bytes."""
    message = example(type_name)
    parts = message.markers if hasattr(message, 'markers') else [message]
    if not hasattr(parts[0], 'header'):
        data = serialize(message)
        return lambda stamp: data

    def stamped(stamp: int) -> bytes:
        parts[0].header.stamp = to_time(stamp)
        return serialize(message)

    return stamped


class FullChain(TrawlNode):
    """Node that publishes all topics at a total rate for some time, and prints its counts."""

    SPECS: ClassVar = (
        Number('rate', 500.0, 'Hz', 1.0, 1e5, 'Messages per second, of all topics together.'),
        Number('seconds', 10.0, 's', 0.1, 1e5, 'How long.'),
        Names('wait_for', 'Consumers (node names) without which it does not begin.'),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('full_chain', **kwargs)
        self._schedule = iter(schedule(self.parameters['seconds'], self.parameters['rate']))
        self._next = next(self._schedule, None)
        self._makers = [stamper(topic.type) for topic in TOPICS]
        for topic in TOPICS:
            self.advertise(topic.name)
        self._consumers = Consumers(self, self.parameters['wait_for'])
        self._pacer = Pacer(1.0)
        self.every(TICK_S, self._tick)

    def _tick(self) -> None:
        if not self._consumers.ready():
            return
        while self._next is not None and self._pacer.due(self._next[0]):
            number = self._next[1]
            self.send_bytes(TOPICS[number].name, self._makers[number](self.now()))
            self._next = next(self._schedule, None)
        if self._next is None and self.all_acknowledged(5.0):
            self.end(0)

    def finish_work(self) -> None:
        """Print the number of published messages by full topic name, and the delay."""
        names = {absolute(topic.name, self.get_namespace()) for topic in TOPICS}
        counts = self.traffic.counts('published')
        result = {
            'published': {name: counts[name] for name in sorted(names)},
            'behind_s': self._pacer.lost_s,
        }
        print(json.dumps(result), flush=True)  # noqa: T201


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(FullChain, args)


if __name__ == '__main__':
    sys.exit(main())
