# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Replayed topics of a bag: those that can be published here, and their QoS."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from rclpy.qos import QoSProfile

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import Definition, RawMessage
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import STORE, type_hash
from trawl_ros.nodes.playback.recorded_qos import offered_again
from trawl_ros.nodes.runtime.incoming import message_class
from trawl_ros.nodes.runtime.qos import offered
from trawl_ros.records.topics import CLOCK, find_topic


class Excerpt:
    """Excerpt: messages of some topics of a bag, from a start to an end.

    Parameters
    ----------
    bag
        The bag.
    topics
        Full names.
    start_s, end_s
        Recorded time since the bag's first message, s; an end of 0 is that of the bag.

    Attributes
    ----------
    upcoming : RawMessage or None
        The next to be played; None at the end.

    Raises
    ------
    BagError
        If there is no message in it.
    """

    def __init__(self, bag: Bag, topics: Collection[str], start_s: float, end_s: float) -> None:
        self._bag = bag
        self._topics = frozenset(topics)
        first = next(bag.as_stored(), None)
        origin = first.log_time if first else 0
        self._start = origin + round(start_s * SECOND)
        self._end = origin + round(end_s * SECOND) if end_s else None
        self._messages: Iterator[RawMessage] = iter(())
        self.upcoming: RawMessage | None = None
        self.begin()

    def begin(self) -> RawMessage:
        """Return to the first message, and give it."""
        self._messages = self._bag.raw(self._topics)
        self.advance()
        while self.upcoming is not None and self.upcoming.log_time < self._start:
            self.advance()
        if self.upcoming is None:
            raise BagError(
                f'{self._bag.path}: no message on the topics to be played between the wanted start '
                'and end; expected an earlier start or a later end'
            )
        return self.upcoming

    def advance(self) -> None:
        """Advance to the next message."""
        following = next(self._messages, None)
        behind = following and self._end is not None and following.log_time > self._end
        self.upcoming = None if behind else following


@dataclass(frozen=True)
class Replayed:
    """Replayed topic: its type, its QoS, and whether that is as recorded."""

    type: str
    profile: QoSProfile
    as_recorded: bool


def replayed(
    bag: Bag, wanted: Collection[str], namespace: str
) -> tuple[dict[str, Replayed], list[str]]:
    """Select the topics of a bag to be played.

    Parameters
    ----------
    bag
        The bag.
    wanted
        Full names of the topics in the bag; none for all that can be played.
    namespace
        Of the project's topics.

    Returns
    -------
    topics
        By full name.
    left_out
        A sentence for each topic that cannot be played.

    Raises
    ------
    BagError
        If a topic that is wanted is not there or cannot be played, or none can.
    """
    definitions, recorded = bag.definitions(), bag.offered()
    # A new clock is made where one is wanted; an old one would be a second one.
    there = sorted(set(definitions) - {CLOCK.name})
    if missing := sorted(set(wanted) - set(there)):
        raise BagError(f'{bag.path}: no topic {", ".join(missing)}; there are: {", ".join(there)}')
    by_topic: dict[str, Replayed] = {}
    left_out = []
    for topic in there:
        if wanted and topic not in wanted:
            continue
        if reason := _hindrance(bag, topic, definitions[topic]):
            sentence = f'{bag.path}: {topic} cannot be played: {reason}'
            if wanted:
                raise BagError(sentence)
            left_out.append(sentence)
            continue
        usual = offered(find_topic(topic, namespace))
        again = offered_again(recorded[topic], usual)
        by_topic[topic] = Replayed(definitions[topic].type, again or usual, again is not None)
    if not by_topic:
        raise BagError('; '.join(left_out) or f'{bag.path}: no topic to be played')
    return by_topic, left_out


def _hindrance(bag: Bag, topic: str, definition: Definition) -> str:
    """Reason why the bytes of a topic have no meaning for subscribers here; '' without one."""
    name = definition.type
    try:
        message_class(name)
        another = name in STORE.types and definition.type_hash != type_hash(name)
        if another and bag.types_of(topic) is not STORE:
            return f'{name} was another type where it was recorded'
    except (MessageError, BagError) as reason:
        return str(reason)
    return ''
