"""One MCAP file: what is in it and where, also when it was cut short or damaged.

A sound file is read by the index at its end. Where that is missing or wrong, the file is gone
through record by record as far as it goes.
"""

import heapq
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.reader import FOOTER_SIZE
from mcap.records import Channel, ChunkIndex, Footer, Message, Schema, Statistics
from mcap.writer import MCAP0_MAGIC

from trawl_ros.bags.chunks import (
    DAMAGE,
    MAX_CHUNK_BYTES,
    Damaged,
    Record,
    open_chunk,
    parse_records,
)
from trawl_ros.bags.stored import Definition, Stored
from trawl_ros.bags.walk import RECORD_START, walk
from trawl_ros.errors import BagError

_CHUNK_HEAD = struct.Struct('<QQQII')
"""First and last time, size, checksum, and length of the compression's name behind it."""
_COMPRESSION_BYTES = 16
_MESSAGE_TIME = struct.Struct('<HIQ')


@dataclass(frozen=True, order=True)
class Piece:
    """A chunk, or a message outside of chunks: earliest log time (ns), offset and length."""

    start: int
    offset: int
    length: int


class McapFile:
    """An MCAP file opened for reading.

    Parameters
    ----------
    path
        The file.
    report
        Takes a sentence for each thing that is wrong but can be lived with.

    Attributes
    ----------
    indexed : bool
        Whether messages are found by the index at its end, and not by going through the file.

    Raises
    ------
    BagError
        If there is no file, it is empty, or not MCAP.
    """

    storage = 'mcap'
    distro = ''

    def __init__(self, path: Path, report: Callable[[str], None]) -> None:
        self.path = path
        self._report = report
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._statistics: Statistics | None = None
        self._damaged: set[int] = set()
        self.passed_bytes = 0
        """Bytes between records, or behind the last one, that make no sense."""
        self.complete = False
        """Whether the file ends as a finished one does."""
        self.chunk_compressions: set[str] = set()
        """How chunks are compressed ('' for not at all)."""
        with self._open() as stream:
            self._size = stream.seek(0, 2)
            self._check_start(stream)
            indexed = self._by_index(stream)
            self.indexed = indexed is not None
            self._pieces = sorted(self._by_scan(stream) if indexed is None else indexed)

    @property
    def damaged_chunks(self) -> int:
        """How many chunks failed so far; complete once all messages were read."""
        return len(self._damaged)

    @property
    def definitions(self) -> dict[str, Definition]:
        """What is known of each topic's messages; the first channel of a topic counts."""
        found: dict[str, Definition] = {}
        for channel in self._channels.values():
            found.setdefault(channel.topic, self._definition(channel))
        return found

    def types(self) -> set[tuple[str, str]]:
        """Give all (topic, type) there are."""
        return {(c.topic, self._definition(c).type) for c in self._channels.values()}

    def counts(self) -> dict[tuple[str, str], int] | None:
        """Give the number of messages by (topic, type) as the file states it; None if it does not.

        Topics without messages are left out.
        """
        if self._statistics is None:
            return None
        found: dict[tuple[str, str], int] = {}
        for number, count in self._statistics.channel_message_counts.items():
            channel = self._channels.get(number)
            if channel and count:
                key = (channel.topic, self._definition(channel).type)
                found[key] = found.get(key, 0) + count
        return found

    def messages(self) -> Iterator[Stored]:
        """Give all messages in the order of their log times; equal ones as they stand in the file.

        Chunks are opened as their time comes, so that memory holds only those that overlap.
        """
        waiting: list[tuple[int, int, int, Message]] = []
        lost_channels: dict[int, int] = {}
        with self._open() as stream:
            for piece in [*self._pieces, None]:
                while waiting and (piece is None or waiting[0][0] < piece.start):
                    message = heapq.heappop(waiting)[3]
                    channel = self._channels.get(message.channel_id)
                    if channel is None:
                        lost_channels.setdefault(message.channel_id, 0)
                        lost_channels[message.channel_id] += 1
                        continue
                    yield Stored(channel.topic, self._definition(channel).type, message)
                if piece is None:
                    break
                for place, record in enumerate(self._load(stream, piece) or ()):
                    if isinstance(record, Message):
                        heapq.heappush(waiting, (record.log_time, piece.offset, place, record))
        for number, count in lost_channels.items():
            self._report(
                f'{self.path}: {count} messages of channel {number}, whose description was lost, '
                'were left out'
            )

    def _open(self) -> BinaryIO:
        try:
            return self.path.open('rb')
        except OSError as reason:
            raise BagError(f'{self.path}: cannot be read ({reason.strerror})') from reason

    def _check_start(self, stream: BinaryIO) -> None:
        stream.seek(0)
        magic = stream.read(len(MCAP0_MAGIC))
        if not magic:
            raise BagError(f'{self.path}: the file is empty; expected an MCAP file')
        if magic != MCAP0_MAGIC:
            raise BagError(f'{self.path}: starts with {magic!r}; expected an MCAP file')

    def _by_index(self, stream: BinaryIO) -> list[Piece] | None:
        """Find the chunks by the summary; None where it is missing, damaged or without index."""
        tail = FOOTER_SIZE + len(MCAP0_MAGIC)
        if self._size < len(MCAP0_MAGIC) + tail:
            return None
        stream.seek(self._size - tail)
        end = stream.read(tail)
        if not end.endswith(MCAP0_MAGIC):
            return None
        self.complete = True
        try:
            footer = next(parse_records(end[:FOOTER_SIZE]))
            if not isinstance(footer, Footer):
                raise Damaged('no footer')
            if footer.summary_start == 0:
                return None
            length = self._size - tail - footer.summary_start
            if not 0 < length <= MAX_CHUNK_BYTES:
                raise Damaged(f'a summary of {length} bytes')
            stream.seek(footer.summary_start)
            summary = stream.read(length)
            # All but the checksum itself is covered, with the footer's own start.
            covered = summary + end[: FOOTER_SIZE - 4]
            if footer.summary_crc and zlib.crc32(covered) != footer.summary_crc:
                raise Damaged('its checksum does not match')
            return self._take_summary(list(parse_records(summary + end)))
        except DAMAGE as reason:
            self._report(
                f'{self.path}: the index at the end is damaged ({reason}); '
                'the file is read from its start instead'
            )
            return None

    def _take_summary(self, records: list[object]) -> list[Piece] | None:
        pieces = []
        for record in records:
            if isinstance(record, Schema | Channel):
                self._learn(record)
            elif isinstance(record, Statistics):
                self._statistics = record
            elif isinstance(record, ChunkIndex):
                self.chunk_compressions.add(record.compression)
                pieces.append(
                    Piece(record.message_start_time, record.chunk_start_offset, record.chunk_length)
                )
        stated = self._statistics
        if stated is None or (stated.message_count and len(pieces) != stated.chunk_count):
            return None
        return pieces if pieces or not stated.message_count else None

    def _by_scan(self, stream: BinaryIO) -> list[Piece]:
        """Go through the file record by record, and open chunks for the channels in them."""
        pieces = []
        for opcode, offset, length in self._walk(stream):
            stream.seek(offset + RECORD_START.size)
            if opcode == Opcode.CHUNK and length >= RECORD_START.size + _CHUNK_HEAD.size:
                start, *_, name = _CHUNK_HEAD.unpack(stream.read(_CHUNK_HEAD.size))
                compression = stream.read(min(name, _COMPRESSION_BYTES))
                piece = Piece(start, offset, length)
            elif opcode == Opcode.MESSAGE and length >= RECORD_START.size + _MESSAGE_TIME.size:
                _, _, start = _MESSAGE_TIME.unpack(stream.read(_MESSAGE_TIME.size))
                pieces.append(Piece(start, offset, length))
                continue
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                piece = Piece(0, offset, length)
            else:
                continue
            records = self._load(stream, piece)
            for record in records or ():
                if isinstance(record, Schema | Channel):
                    self._learn(record)
            if opcode == Opcode.CHUNK and records is not None:
                self.chunk_compressions.add(compression.decode('ascii', 'replace'))
                pieces.append(piece)
        return pieces

    def _walk(self, stream: BinaryIO) -> Iterator[tuple[int, int, int]]:
        """Give opcode, offset and length of each record before the end of data."""
        for found in walk(stream, self._size, self._step_over):
            if found[0] != Opcode.DATA_END:
                yield found
            elif not self.complete:
                self._report(f'{self.path}: the index at the end is cut short; not needed')

    def _step_over(self, sentence: str, count: int) -> None:
        self.passed_bytes += count
        self._report(f'{self.path}: {sentence}')

    def _load(self, stream: BinaryIO, piece: Piece) -> list[Record] | None:
        """Read a piece; None, with a report, if it is damaged."""
        try:
            if piece.length > MAX_CHUNK_BYTES:
                raise Damaged(f'it is {piece.length} bytes long')
            stream.seek(piece.offset)
            data = stream.read(piece.length)
            if len(data) != piece.length:
                raise Damaged('it goes beyond the end of the file')
            opcode, inner = RECORD_START.unpack(data[: RECORD_START.size])
            if inner + RECORD_START.size != piece.length:
                raise Damaged('its length is not what the index says')
            if opcode == Opcode.CHUNK:
                records = open_chunk(data)
            else:
                records = [r for r in (next(parse_records(data)),) if isinstance(r, Record)]
        except DAMAGE as reason:
            self._damaged.add(piece.offset)
            self._report(
                f'{self.path}: the chunk at byte {piece.offset} is damaged ({reason}) '
                'and was stepped over'
            )
            return None
        for record in records:
            if isinstance(record, Schema | Channel):
                self._learn(record)
        return records

    def _learn(self, record: Schema | Channel) -> None:
        if isinstance(record, Schema):
            self._schemas.setdefault(record.id, record)
        else:
            self._channels.setdefault(record.id, record)

    def _definition(self, channel: Channel) -> Definition:
        schema = self._schemas.get(channel.schema_id)
        said = (
            channel.metadata.get('offered_qos_profiles', ''),
            channel.metadata.get('topic_type_hash', ''),
        )
        if schema is None:
            return Definition('', channel.message_encoding, '', b'', *said)
        return Definition(
            schema.name, channel.message_encoding, schema.encoding, schema.data, *said
        )
