# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""MCAP file for writing: chunks with checksums, channels, and an index at its end.

Messages cannot be read without the descriptions of their channels. These are repeated in later
chunks, so that two small damages cannot make a whole file unreadable.
"""

from pathlib import Path
from types import MappingProxyType

from mcap.records import Channel, Schema
from mcap.writer import CompressionType, Writer

from trawl_ros.bags.storage.stored import Definition

CHUNK_BYTES = 1 << 20
COMPRESSIONS = MappingProxyType(
    {'zstd': CompressionType.ZSTD, 'lz4': CompressionType.LZ4, 'none': CompressionType.NONE}
)
REPEAT_BYTES = 1 << 16
"""Distance of repeated descriptions, bytes: once in each full chunk, for 1 to 3 % of the file."""
LIBRARY = 'trawl_ros'
"""Text in the file's header; a version there would change the bytes."""


class McapOutput:
    """New MCAP file; its header is written at once.

    Parameters
    ----------
    path
        Of the new file.
    compression
        One of `COMPRESSIONS`.

    Attributes
    ----------
    count : int
        Messages so far.
    span : tuple of int, or None
        First and last log time (ns) so far.
    """

    def __init__(self, path: Path, compression: str) -> None:
        self.path = path
        self.count = 0
        self.span: tuple[int, int] | None = None
        self._channels: dict[str, tuple[int, int]] = {}
        self._schemas: dict[tuple[str, str, bytes], int] = {}
        self._descriptions: list[Schema | Channel] = []
        self._described = 0
        """Number of them that stand in more than one chunk."""
        self._chunk_start = 0
        self._next_repeat = REPEAT_BYTES
        self._stream = path.open('xb')
        self._mcap = Writer(
            self._stream, chunk_size=CHUNK_BYTES, compression=COMPRESSIONS[compression]
        )
        self._mcap.start(profile='ros2', library=LIBRARY)
        self.flush()

    @property
    def size(self) -> int:
        """Bytes in the file, without the chunk in progress."""
        return self._stream.tell()

    def write(
        self, topic: str, definition: Definition, data: bytes, log_time: int, publish_time: int
    ) -> None:
        """Add a message; the first one of a topic also writes its channel."""
        self._repeat_descriptions()
        channel, sequence = self._channels.get(topic) or (self._register(topic, definition), 0)
        self._mcap.add_message(channel, log_time, data, publish_time, sequence)
        self._channels[topic] = (channel, sequence + 1)
        self.count += 1
        first, last = self.span or (log_time, log_time)
        self.span = min(first, log_time), max(last, log_time)

    def flush(self) -> None:
        """End the current chunk and pass everything to the operating system."""
        self._mcap.flush()  # type: ignore[no-untyped-call]  # of mcap

    def finish(self) -> None:
        """Write the index and close; a second call does nothing."""
        if self._stream.closed:
            return
        self._mcap.finish()  # type: ignore[no-untyped-call]  # of mcap
        self._stream.close()

    def _register(self, topic: str, definition: Definition) -> int:
        key = (definition.type, definition.schema_encoding, definition.text)
        if key not in self._schemas:
            number = self._mcap.register_schema(*key)
            self._schemas[key] = number
            name, encoding, text = key
            self._descriptions.append(Schema(number, text, encoding, name))
        described = {
            'offered_qos_profiles': definition.qos,
            'topic_type_hash': definition.type_hash,
        }
        schema, encoding = self._schemas[key], definition.message_encoding
        number = self._mcap.register_channel(topic, encoding, schema, described)
        self._descriptions.append(Channel(number, topic, encoding, described, schema))
        return number

    def _repeat_descriptions(self) -> None:
        """Start a chunk with the descriptions of earlier chunks, if that is due.

        It is due in the chunk after one with a new description, and `REPEAT_BYTES` later.
        """
        if self.size == self._chunk_start:
            return
        self._chunk_start = self.size
        if self._described < len(self._descriptions) or self.size >= self._next_repeat:
            # The library has no way of its own to say something of a channel twice.
            builder = vars(self._mcap)['_Writer__chunk_builder']
            for record in self._descriptions:
                record.write(builder.record_writer)
            self._described = len(self._descriptions)
            self._next_repeat = self.size + REPEAT_BYTES
