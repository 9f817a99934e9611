"""Schemas and channels of an MCAP file: topic and type of each channel's messages."""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import BinaryIO

from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Schema

from trawl_ros.bags.storage.chunks import DAMAGE, MAX_CHUNK_BYTES, parse_records, salvage
from trawl_ros.bags.storage.stored import Definition
from trawl_ros.core.limits import RECOVERED_RECORDS

Description = Schema | Channel
"""A record without which messages cannot be read."""

# Opcode, length, one or two numbers, and a length before a type's or topic's name. Lengths stay
# below 4 GB, so their upper halves are zero.
_RECORD = re.compile(
    rb'(?=(\x03(.{4})\0{4}.{2}.{3}\0[A-Za-z]|\x04(.{4})\0{4}.{4}.{3}\0/))', re.DOTALL
)
_HEAD = 9
_MOST_BYTES = 1 << 20
_TAIL_BYTES = 16 << 20


class Descriptions:
    """Descriptions of channels by their numbers; of two that differ the first one counts."""

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
        """Settle what a channel is of which the file does not say it."""
        self._added[number] = topic, definition

    def find(self, number: int) -> tuple[str, Definition] | None:
        """Give topic and definition of a channel's messages; None if nothing describes it."""
        if number in self._added:
            return self._added[number]
        channel = self._channels.get(number)
        if number not in self._made and channel:
            schema = self._schemas.get(channel.schema_id)
            self._made[number] = channel.topic, channel_definition(channel, schema)
        return self._made.get(number)

    def lacking(self, numbers: Collection[int]) -> list[int]:
        """Return those channels that are not described, or whose type is not."""
        return [number for number in sorted(numbers) if not self._describes(number)]

    def all(self) -> dict[int, tuple[str, Definition]]:
        """Give topic and definition of all channels by their numbers."""
        numbers = dict.fromkeys([*self._channels, *self._added])
        return {number: pair for number in numbers if (pair := self.find(number))}

    def records(self) -> list[Description]:
        """Give all schemas and channels that were learnt."""
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


def read_remains(stream: BinaryIO, damaged: Mapping[int, int], size: int) -> list[Description]:
    """Find schemas and channels in damaged chunks, and behind the last of all records.

    Parameters
    ----------
    stream
        The file; it is moved about in.
    damaged
        Lengths of the damaged chunks by their offsets.
    size
        Length of the file, bytes.

    Returns
    -------
    list
        Each of those that are equal once, and `RECOVERED_RECORDS` at most.
    """
    descriptions: list[Description] = []
    seen: set[bytes] = set()
    places = [(max(0, size - _TAIL_BYTES), _TAIL_BYTES), *damaged.items()]
    for offset, length in places:
        stream.seek(offset)
        data = stream.read(min(length, MAX_CHUNK_BYTES))
        for record in find_descriptions(salvage(data) if offset in damaged else data, seen):
            descriptions.append(record)
            if len(descriptions) == RECOVERED_RECORDS.value:
                return descriptions
    return descriptions


def find_descriptions(data: bytes, seen: set[bytes]) -> Iterator[Description]:
    """Find schemas and channels among damaged bytes, each record on its own.

    Whoever uses them has to see whether they are right: no checksum says so. ``seen`` are the
    bytes of those that were found before, and are not given again.
    """
    for place in _RECORD.finditer(data):
        length = _HEAD + int.from_bytes(place[2] or place[3], 'little')
        raw = data[place.start() : place.start() + length]
        if length > _MOST_BYTES or len(raw) < length or raw in seen:
            continue
        builder = RecordBuilder()
        try:
            record = next(parse_records(raw))
            if not isinstance(record, Description):
                continue
            record.write(builder)
        except DAMAGE:
            continue
        # All lengths within fit the record's.
        if builder.end() == raw:  # type: ignore[no-untyped-call]  # of mcap
            seen.add(raw)
            yield record
