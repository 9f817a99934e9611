# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages and definitions as a bag's file has them, whatever its storage."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import NamedTuple

from mcap.records import Channel, Schema

from trawl_ros.core.errors import BagError
from trawl_ros.messages.cdr import STORE, message_definition, type_hash


class RawMessage(NamedTuple):
    """Raw message of a bag.

    Attributes
    ----------
    topic, type
        Full topic name and message type.
    log_time, publish_time
        Times of recording and of publication, ns.
    data
        The message in CDR.
    channel
        Number of the channel.
    sequence
        Number of arrival, 0 if unknown.
    """

    topic: str
    type: str
    log_time: int
    publish_time: int
    data: bytes
    channel: int = 0
    sequence: int = 0


@dataclass(frozen=True)
class Definition:
    """Definition of a channel's messages: encodings, and the text of the type.

    ``qos`` is what publishers offered, as `bags.qos` reads it, ``type_hash`` the type's RIHS01;
    each '' where the bag does not say.
    """

    type: str
    message_encoding: str
    schema_encoding: str
    text: bytes
    qos: str = ''
    type_hash: str = ''


Description = Schema | Channel
"""Record of an MCAP file that is needed to read messages."""


def describe(type_name: str, qos: str) -> Definition:
    """Return the definition for a topic: its type's text and hash, and offered QoS.

    Raises
    ------
    BagError
        If the type's definition is unknown.
    """
    if type_name not in STORE.types:
        raise BagError(f'type {type_name}, whose definition is unknown')
    return Definition(
        type=type_name,
        message_encoding='cdr',
        schema_encoding='ros2msg',
        text=message_definition(type_name).encode(),
        qos=qos,
        type_hash=type_hash(type_name),
    )


class Descriptions:
    """Descriptions of channels by their numbers; if two differ, the first one counts."""

    def __init__(self) -> None:
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._made: dict[int, tuple[str, Definition]] = {}
        self._added: dict[int, tuple[str, Definition]] = {}

    def learn(self, records: Iterable[object]) -> None:
        """Register schemas and channels among records."""
        for record in records:
            if isinstance(record, Schema):
                self._schemas.setdefault(record.id, record)
            elif isinstance(record, Channel):
                self._channels.setdefault(record.id, record)
        self._made.clear()

    def add(self, number: int, topic: str, definition: Definition) -> None:
        """Set the description of a channel that the file does not describe."""
        self._added[number] = topic, definition

    def find(self, number: int) -> tuple[str, Definition] | None:
        """Return topic and definition of a channel's messages; None if nothing describes it."""
        if number in self._added:
            return self._added[number]
        channel = self._channels.get(number)
        if number not in self._made and channel:
            schema = self._schemas.get(channel.schema_id)
            self._made[number] = channel.topic, channel_definition(channel, schema)
        return self._made.get(number)

    def lacking(self, numbers: Collection[int]) -> list[int]:
        """Return the channels that are not described, or whose type is not."""
        return [number for number in sorted(numbers) if not self._describes(number)]

    def all(self) -> dict[int, tuple[str, Definition]]:
        """Return topic and definition of all channels by their numbers."""
        numbers = dict.fromkeys([*self._channels, *self._added])
        return {number: pair for number in numbers if (pair := self.find(number))}

    def records(self) -> list[Description]:
        """Return all schemas and channels that were learnt."""
        return [*self._schemas.values(), *self._channels.values()]

    def _describes(self, number: int) -> bool:
        channel = self._channels.get(number)
        # Schema 0 says that there is none.
        return channel is not None and channel.schema_id in (0, *self._schemas)


def channel_definition(channel: Channel, schema: Schema | None) -> Definition:
    """Definition of a channel, in the form common to all storages."""
    return Definition(
        type=schema.name if schema else '',
        message_encoding=channel.message_encoding,
        schema_encoding=schema.encoding if schema else '',
        text=schema.data if schema else b'',
        qos=channel.metadata.get('offered_qos_profiles', ''),
        type_hash=channel.metadata.get('topic_type_hash', ''),
    )
