"""Schemas and channels of an MCAP file: which topic and type a channel's messages have."""

from collections.abc import Collection, Iterable

from mcap.records import Channel, Schema

from trawl_ros.bags.stored import Definition

Description = Schema | Channel
"""A record without which messages cannot be read."""


class Descriptions:
    """What is known of channels by their numbers; of two that differ the first one counts."""

    def __init__(self) -> None:
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._made: dict[int, tuple[str, Definition]] = {}

    def learn(self, records: Iterable[object]) -> None:
        """Take schemas and channels from among records."""
        for record in records:
            if isinstance(record, Schema):
                self._schemas.setdefault(record.id, record)
            elif isinstance(record, Channel):
                self._channels.setdefault(record.id, record)
        self._made.clear()

    def find(self, number: int) -> tuple[str, Definition] | None:
        """Give topic and definition of a channel's messages; None if nothing describes it."""
        channel = self._channels.get(number)
        if number not in self._made and channel:
            schema = self._schemas.get(channel.schema_id)
            self._made[number] = channel.topic, definition(channel, schema)
        return self._made.get(number)

    def lacking(self, numbers: Collection[int]) -> list[int]:
        """Give those channels that are not described, or whose type is not."""
        return [number for number in sorted(numbers) if not self._describes(number)]

    def all(self) -> list[tuple[str, Definition]]:
        """Give topic and definition of all channels."""
        found = (self.find(number) for number in self._channels)
        return [pair for pair in found if pair]

    def _describes(self, number: int) -> bool:
        channel = self._channels.get(number)
        # Schema 0 says that there is none.
        return channel is not None and channel.schema_id in (0, *self._schemas)


def definition(channel: Channel, schema: Schema | None) -> Definition:
    """Say of a channel what is said of messages whatever the storage."""
    return Definition(
        type=schema.name if schema else '',
        message_encoding=channel.message_encoding,
        schema_encoding=schema.encoding if schema else '',
        text=schema.data if schema else b'',
        qos=channel.metadata.get('offered_qos_profiles', ''),
        type_hash=channel.metadata.get('topic_type_hash', ''),
    )
