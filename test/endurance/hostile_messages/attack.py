"""Attack on a node: hostile messages on each of its subscriptions, and what came of them."""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rclpy.executors import Executor
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription

from endurance.hostile_messages.mutations import hostile_bytes
from trawl_ros.messages.cdr import deserialize
from trawl_ros.messages.fields import beyond
from trawl_ros.nodes.runtime.connected_node import DIAGNOSTICS
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.records.topics import find_topic

Stream = Sequence[tuple[str, str, bytes]]
"""Sound messages in order: full topic name, type, CDR."""

SPIN_EVERY = 100
"""Messages after which the node's timers get their turn."""

RANGE = 'sensor_msgs__msg__Range.range'

PATIENCE_S = 15.0
"""Wall time in which a node must answer. A source that was told of consumers that never were goes
on without them after 10 s."""


@dataclass
class AttackTally:
    """Tally of an attack on a node.

    ``sent`` hostile messages by topic; ``refused`` of them were counted; ``ended`` says why the
    node did not survive, '' if it did; ``not_finite`` names fields that were published with NaN or
    infinity and are finite in a sound tow; ``answers`` is how much the node published on a sound
    stream after the attack, and ``longest_report`` the length of the longest sentence on
    /diagnostics.
    """

    node: str
    sent: dict[str, int] = field(default_factory=dict)
    refused: int = 0
    ended: str = ''
    not_finite: set[str] = field(default_factory=set)
    answers: int = 0
    longest_report: int = 0


class Attack:
    """Feeds one node with bytes, straight into the callbacks of its subscriptions.

    Parameters
    ----------
    node
        The node.
    executor
        Spins it.
    stream
        Sound messages, of which hostile ones are made.
    seed
        Of all draws.
    """

    def __init__(self, node: TrawlNode, executor: Executor, stream: Stream, seed: int) -> None:
        self.tally = AttackTally(node.get_name())
        self._node = node
        self._executor = executor
        self._rng = np.random.default_rng(seed)
        self._number = 0
        self._finite_in_peace: dict[str, set[str]] = {}
        self._peace = True
        self._entries: dict[str, Subscription] = {
            entry.topic_name: entry for entry in node.subscriptions
        }
        self._stream = [one for one in stream if one[0] in self._entries]
        self._watch()

    @property
    def topics(self) -> list[str]:
        """All topics the node listens to."""
        return sorted(self._entries)

    def feed_sound(self) -> int:
        """Feed the sound stream; give how many messages the node answered with, or used where it
        publishes none.
        """
        before = self._answers()
        for number, (topic, _, data) in enumerate(self._stream):
            self._give(topic, data)
            if number % SPIN_EVERY == 0:
                self._spin()
        self._spin()
        return self._answers() - before

    def feed_until_answered(self) -> int:
        """Feed the sound stream, and wait for a node that goes by wall time; give its answers."""
        answers = self.feed_sound()
        before, end = self._answers(), time.monotonic() + PATIENCE_S
        while not answers and time.monotonic() < end:
            self._spin(0.05)
            answers = self._answers() - before
        return answers

    def feed_hostile(self, examples: Mapping[str, tuple[str, Sequence[bytes]]], count: int) -> None:
        """Feed a number of hostile messages, the same to each topic, in random order."""
        self._peace = False
        before = self._node.traffic.total('refused')
        order = self._rng.permutation(np.resize(np.arange(len(self.topics)), count))
        for number, index in enumerate(order):
            topic = self.topics[index]
            type_name, sound = examples[topic]
            data = hostile_bytes(sound[int(self._rng.integers(len(sound)))], type_name, self._rng)
            self.tally.sent[topic] = self.tally.sent.get(topic, 0) + 1
            self._give(topic, data)
            if number % SPIN_EVERY == 0:
                self._spin()
            if self.tally.ended:
                return
        self.tally.refused = self._node.traffic.total('refused') - before

    def feed_mixed(self, share: float) -> None:
        """Feed the sound stream with hostile versions of what is near in it between."""
        self._peace = False
        for number, (topic, _, data) in enumerate(self._stream):
            self._give(topic, data)
            if self._rng.random() < share:
                near = self._rng.integers(
                    max(number - 100, 0), min(number + 100, len(self._stream))
                )
                other, type_name, sound = self._stream[near]
                self.tally.sent[other] = self.tally.sent.get(other, 0) + 1
                self._give(other, hostile_bytes(sound, type_name, self._rng))
            if number % SPIN_EVERY == 0:
                self._spin()

    def _answers(self) -> int:
        """Give how much was published so far, without what a node says of itself.

        A node that publishes nothing else, as a viewer does, has answered what it did not refuse.
        """
        traffic = self._node.traffic
        counts = traffic.counts('published')
        published = sum(count for topic, count in counts.items() if topic != DIAGNOSTICS)
        return published or traffic.total('received') - traffic.total('refused')

    def _give(self, topic: str, data: bytes) -> None:
        entry = self._entries[topic]
        self._number += 1
        try:
            message = data if entry.raw else deserialize_message(data, entry.msg_type)
        except Exception:
            # The middleware gives such bytes to nobody.
            return
        self._guard(lambda: entry.callback(message, {'publication_sequence_number': self._number}))

    def _spin(self, timeout_s: float = 0.0) -> None:
        self._guard(lambda: self._executor.spin_once(timeout_sec=timeout_s))
        longest = max(len(status.message) for status in self._node.all_statuses())
        self.tally.longest_report = max(self.tally.longest_report, longest)

    def _guard(self, act: Callable[[], Any]) -> None:
        try:
            act()
        except Exception as reason:
            self.tally.ended = f'{type(reason).__name__}: {reason}'[:200]
        if self._node.exit_code is not None:
            self.tally.ended = f'exit code {self._node.exit_code}'

    def _watch(self) -> None:
        """Look at all that the node publishes."""
        publish = self._node.send_bytes

        def send_bytes(topic: str, data: bytes) -> None:
            publish(topic, data)
            full = self._node.full_name(topic)
            row = find_topic(topic, self._node.get_namespace())
            if row is None:
                return
            found = unsound(deserialize(data, row.type))
            known = self._finite_in_peace.setdefault(full, set())
            if self._peace:
                known |= found
            else:
                self.tally.not_finite |= {f'{full} {name}' for name in found - known}

        self._node.send_bytes = send_bytes  # type: ignore[method-assign]


def unsound(message: Any) -> set[str]:
    """Name the fields of a message with a number that is not finite, against REP-117.

    An infinite range is a distance beyond what the sensor can measure.
    """
    found = beyond(message)
    return found - {RANGE} if math.isinf(getattr(message, 'range', 0.0)) else found


def examples_of(stream: Stream) -> dict[str, tuple[str, list[bytes]]]:
    """Give sound messages by full topic name, each with its type."""
    found: dict[str, tuple[str, list[bytes]]] = {}
    for topic, type_name, data in stream:
        found.setdefault(topic, (type_name, []))[1].append(data)
    return found
