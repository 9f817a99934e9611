"""Channels whose descriptions were lost, told by what is left of them and by their messages.

Evidence only: where two topics would do, none is taken, and whatever is taken is said.
"""

import itertools
import operator
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from mcap.records import Channel, Message, Schema

from trawl_ros.bags.storage.decoding import BagTypes
from trawl_ros.bags.storage.descriptions import Description, channel_definition
from trawl_ros.bags.storage.stored import Definition, StatedTopics, describe
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.limits import RECOVERED_CHANNELS
from trawl_ros.messages.cdr import STORE
from trawl_ros.records.topics import TOPICS, WINCH_NAMES, Topic, absolute, find_topic

TABLE = "the project's table of topics"

_PER_CHUNK = 4
_IN_ALL = 64
_BYTES = 1 << 22

Samples = Mapping[int, Sequence[bytes]]
"""Some messages of each channel, as they lie in the file."""


@dataclass(frozen=True)
class Recovered:
    """A channel's topic, the definition of its messages, and why it must be this one."""

    topic: str
    definition: Definition
    why: str


def recover(
    samples: Samples,
    claims: Iterable[Description],
    taken: Mapping[int, str],
    stated: StatedTopics | None,
    *,
    in_order: bool,
) -> dict[int, Recovered]:
    """Find out what the messages of channels are that nothing describes.

    Parameters
    ----------
    samples
        Messages of these channels.
    claims
        Schemas and channels out of damaged places.
    taken
        Topics by channel of those that are described.
    stated
        Topics by ``metadata.yaml``; without it, the project's own are the candidates.
    in_order
        True if the writer counts channels in the order in which it names topics there.

    Returns
    -------
    dict
        Topic by channel; channels left out may be several topics, or none that is known.
    """
    return _Recovery(samples, list(claims), dict(taken), stated, in_order).solve()


def sample_messages(
    chunks: Iterable[Sequence[object]], numbers: Iterable[int]
) -> dict[int, list[bytes]]:
    """Give some messages of channels, out of all chunks."""
    few = itertools.islice(numbers, RECOVERED_CHANNELS.value)
    samples: dict[int, list[bytes]] = {number: [] for number in few}
    for records in chunks:
        here: Counter[int] = Counter()
        for record in records:
            if not isinstance(record, Message) or record.channel_id not in samples:
                continue
            here[record.channel_id] += 1
            some = samples[record.channel_id]
            wanted = here[record.channel_id] <= _PER_CHUNK and len(some) < _IN_ALL
            if wanted and sum(map(len, some)) < _BYTES:
                some.append(record.data)
    return samples


class _Recovery:
    def __init__(
        self,
        samples: Samples,
        claims: list[Description],
        taken: dict[int, str],
        stated: StatedTopics | None,
        in_order: bool,
    ) -> None:
        self._samples = samples
        self._channels: defaultdict[int, list[Channel]] = defaultdict(list)
        self._schemas: defaultdict[str | int, list[Schema]] = defaultdict(list)
        """By their names, and by their numbers."""
        self._claimants: defaultdict[str, set[int]] = defaultdict(set)
        for claim in claims:
            if isinstance(claim, Channel):
                self._channels[claim.id].append(claim)
                self._claimants[claim.topic].add(claim.id)
            else:
                self._schemas[claim.id].append(claim)
                self._schemas[claim.name].append(claim)
        self._topics = taken
        self._stated = stated
        self._in_order = in_order
        self._types = BagTypes()
        self._found: dict[int, Recovered] = {}
        self._decoded: dict[tuple[int, str, bytes], list[Any]] = {}
        if stated:
            places = dict(stated.topics)
        else:
            places = {
                absolute(topic.name): Definition(topic.type, 'cdr', '', b'')
                for topic in TOPICS.values()
            }
        self._places = {
            topic: definition
            for topic, short in places.items()
            if (definition := self._complete(short))
        }

    def solve(self) -> dict[int, Recovered]:
        for number in self._samples:
            self._by_claims(number)
        self._by_content()
        return self._found

    @property
    def _open(self) -> list[int]:
        return [number for number in self._samples if number not in self._found]

    def _take(self, number: int, topic: str, definition: Definition, why: str) -> None:
        self._found[number] = Recovered(topic, definition, why)
        self._topics[number] = topic

    def _by_claims(self, number: int) -> None:
        """Take what is left of a channel's description if the messages agree."""
        fitting = {}
        for channel in self._channels[number]:
            # A number may be what is damaged.
            if len(self._claimants[channel.topic]) > 1:
                continue
            topic = self._spelled(channel.topic)
            definition: Definition | None
            if topic in self._places:
                definition = self._places[topic]
                witness = 'metadata.yaml' if self._stated else TABLE
            elif known := find_topic(topic):
                definition, witness = self._complete(Definition(known.type, 'cdr', '', b'')), TABLE
            else:
                definition, witness = self._claimed(channel), 'nothing'
            if definition and self._decode(number, definition):
                qos = definition.qos or channel_definition(channel, None).qos
                why = f'as damaged parts of the file say and {witness} confirms'
                fitting[topic] = replace(definition, qos=qos), why
        if len(fitting) == 1:
            ((topic, (definition, why)),) = fitting.items()
            self._take(number, topic, definition, why)

    def _spelled(self, topic: str) -> str:
        """Give the known topic that a name is but for one letter, if it is none itself."""
        near = [
            known
            for known in self._places
            if len(known) == len(topic) and sum(map(operator.ne, known, topic)) <= 1
        ]
        return near[0] if len(near) == 1 and topic not in self._places else topic

    def _by_content(self) -> None:
        options = {
            number: {
                topic
                for topic, definition in self._places.items()
                if topic not in self._topics.values() and self._may_be(number, topic, definition)
            }
            for number in self._open
        }
        where = 'of metadata.yaml' if self._stated else "of the project's"
        while True:
            left = {number: options[number] - set(self._topics.values()) for number in self._open}
            single = defaultdict(list)
            for number, topics in left.items():
                if len(topics) == 1:
                    single[next(iter(topics))].append(number)
            clear = {topic: numbers[0] for topic, numbers in single.items() if len(numbers) == 1}
            if not clear:
                break
            for topic, number in clear.items():
                definition = self._places[topic]
                self._take(number, topic, definition, f'as its messages fit no other topic {where}')
        order = self._order()
        if order and all(order.get(number) in left[number] for number in left if number in order):
            for number in [number for number in left if number in order]:
                topic = order[number]
                why = 'as it stands at this place among the topics of metadata.yaml'
                self._take(number, topic, self._places[topic], why)

    def _order(self) -> dict[int, str]:
        """Give topics by channel as metadata name them, if all that is known agrees."""
        if not self._in_order or not self._stated or self._stated.files != 1:
            return {}
        order = {number: topic for number, (topic, _) in enumerate(self._stated.topics, start=1)}
        agree = all(order.get(number, topic) == topic for number, topic in self._topics.items())
        return order if agree else {}

    def _complete(self, definition: Definition) -> Definition | None:
        """Give what was said of a topic with the text of its type's definition, if that is had."""
        if definition.type in STORE.types:
            ours = describe(definition.type, definition.qos)
            if definition.type_hash in ('', ours.type_hash):
                return ours
        for schema in self._schemas[definition.type]:
            whole = replace(definition, schema_encoding=schema.encoding, text=schema.data)
            if self._has_right_hash(whole):
                return whole
        return None

    def _claimed(self, channel: Channel) -> Definition | None:
        """Give a strange topic's definition, if there is one and its hash is right."""
        definitions = (
            channel_definition(channel, schema) for schema in self._schemas[channel.schema_id]
        )
        return next(filter(self._has_right_hash, definitions), None)

    def _has_right_hash(self, definition: Definition) -> bool:
        try:
            own_hash = self._types.store('', definition).hash_rihs01(definition.type)
        except BagError:
            return False
        return definition.type_hash == own_hash

    def _decode(self, number: int, definition: Definition) -> list[Any]:
        """Decode a channel's messages; none at all if one is of another type."""
        key = number, definition.type, definition.text
        if key not in self._decoded:
            try:
                decode = self._types.decoder('', definition)
                self._decoded[key] = [decode(data) for data in self._samples[number]]
            except (BagError, MessageError):
                self._decoded[key] = []
        return self._decoded[key]

    def _may_be(self, number: int, topic: str, definition: Definition) -> bool:
        messages = self._decode(number, definition)
        known = find_topic(topic)
        return bool(messages) and (
            known is None or all(_is_of(known, message) for message in messages)
        )


def _is_of(topic: Topic, message: Any) -> bool:
    """True if a message has the frame and names that the project's topic has."""
    header = getattr(message, 'header', None)
    if header is not None and header.frame_id != topic.frame:
        return False
    rule = _SIGNS.get(topic.name)
    return rule is None or rule(message)


def _measured(message: Any) -> bool:
    return tuple(message.name) == WINCH_NAMES and len(message.effort) == len(WINCH_NAMES)


_SIGNS: Mapping[str, Callable[[Any], bool]] = {
    'winch/joint_states': _measured,
    'truth/winch': _measured,
    'command/winch': lambda message: len(message.effort) == 0,
}
"""Signs by which topics of the same type and frame are told apart."""
