"""Disturbance of a graph: a publisher on topics not its own, too much, or at wrong times."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from trawl_ros.core.time import SECOND
from trawl_ros.lab.running.monitor import Monitor
from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.stamps import header, stamp_of, to_time
from trawl_ros.messages.truth_to_messages import clock_message
from trawl_ros.nodes.runtime.credit import HEADER
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import STREAM
from trawl_ros.records.topics import CLOCK, SYNC, find_topic

FACTOR = 1.15
"""By which a second publisher's readings differ."""

FLOOD_HZ, TICK_S = 1000.0, 0.005
REPEAT_S = 0.1
LATEST_S = 2**31 - 1
"""The latest stamp that a message can have."""

QUANTITIES = ('position', 'effort', 'range', 'fluid_pressure')


class Stranger(Monitor):
    """Disturbs a graph while entered.

    Parameters
    ----------
    environment
        Of the graph's nodes.
    kind
        ``'second publisher'``, ``'flood'``, ``'clock'``, ``'stamp'`` or ``'progress'``.
    target
        A topic, or by how much (s) the clock is off.
    """

    NAME = 'stranger'

    def __init__(self, environment: Mapping[str, str], kind: str, target: str) -> None:
        super().__init__(environment)
        self._kind = kind
        self._target = target
        self._newest: bytes | None = None
        self._latest = 0
        self.sent = 0

    def listen_to_more(self, node: TrawlNode) -> None:
        """Start to publish."""
        target = self._target
        if self._kind == 'clock':
            node.advertise(CLOCK.name)
            off = round(float(target) * SECOND)
            # Its own messages set its clock too, so the time at the start is what counts.
            node.every(REPEAT_S, lambda: self._set_clock(node, off))
        elif self._kind == 'progress':
            node.advertise(SYNC, HEADER)
            node.every(REPEAT_S, lambda: self._say(SYNC, serialize(header(SECOND, self.NAME))))
        else:
            topic = find_topic(target)
            assert topic is not None
            self._type = topic.type
            node.advertise(target)
            node.listen_raw(target, self._type, self._hear, STREAM)
            if self._kind == 'flood':
                node.every(TICK_S, self._flood)
            elif self._kind == 'stamp':
                node.every(REPEAT_S, self._stamp)

    def _say(self, topic: str, data: bytes) -> None:
        self.sent += 1
        self._node.send_bytes(topic, data)

    def _set_clock(self, node: TrawlNode, off: int) -> None:
        if not self._latest:
            self._latest = node.now()
        if self._latest:
            topic, message = clock_message(self._latest + off)
            self._say(topic, serialize(message))

    def _hear(self, data: bytes) -> None:
        stamp = stamp_of(deserialize(data, self._type))
        # Its own messages come back with a stamp that it has had.
        if stamp <= self._latest or stamp >= LATEST_S * SECOND:
            return
        self._latest, self._newest = stamp, data
        if self._kind == 'second publisher':
            message = deserialize(data, self._type)
            wrong = {name: getattr(message, name) for name in QUANTITIES if hasattr(message, name)}
            scaled = {name: FACTOR * value for name, value in wrong.items()}
            self._say(self._target, serialize(replace(message, **scaled)))

    def _flood(self) -> None:
        if self._newest is not None:
            for _ in range(round(FLOOD_HZ * TICK_S)):
                self._say(self._target, self._newest)

    def _stamp(self) -> None:
        if self._newest is not None:
            message: Any = deserialize(self._newest, self._type)
            late = replace(message.header, stamp=to_time(LATEST_S * SECOND))
            self._say(self._target, serialize(replace(message, header=late)))
