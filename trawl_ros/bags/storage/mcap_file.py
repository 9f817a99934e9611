# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""MCAP file opened for reading, also if it was cut short or damaged.

A sound file is read by the index at its end. If that is missing or wrong, the file is scanned
record by record as far as possible.
"""

import struct
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Header, Message, Statistics
from mcap.writer import MCAP0_MAGIC

from trawl_ros.bags.storage.chunk_index import Piece, in_log_order, is_finished, read_summary
from trawl_ros.bags.storage.chunks import (
    DAMAGE,
    MAX_CHUNK_BYTES,
    RECORD_START,
    Allowance,
    Damaged,
    Record,
    open_chunk,
    parse_records,
)
from trawl_ros.bags.storage.damage import (
    find_copies,
    read_remains,
    recover,
    sample_messages,
    scan_records,
)
from trawl_ros.bags.storage.mcap_output import LIBRARY
from trawl_ros.bags.storage.stored import Definition, Descriptions, RawMessage
from trawl_ros.core.errors import BagError
from trawl_ros.core.foreign import open_file
from trawl_ros.core.limits import LATEST_STAMP

_CHUNK_HEAD = struct.Struct('<QQQII')
"""First and last time, size, checksum, and length of the compression's name behind it."""
_COMPRESSION_BYTES = 16
_HEADER_BYTES = 256
_MESSAGE_HEAD = struct.Struct('<HIQ')


class McapFile:
    """MCAP file opened for reading.

    Parameters
    ----------
    path
        The file.
    report
        Takes a sentence for each thing that is wrong but can be lived with.
    stated
        Gives the topics by the bag's metadata, for a file that has lost their descriptions.

    Attributes
    ----------
    indexed : bool
        True if messages are found by the index at its end, and not by going through the file.

    Raises
    ------
    BagError
        If there is no file, it is empty, or not MCAP.
    """

    storage = 'mcap'
    distro = ''

    def __init__(
        self,
        path: Path,
        report: Callable[[str], None],
        stated: Callable[[], Mapping[str, Definition]] | None = None,
    ) -> None:
        self.path = path
        self._report = report
        self._stated = stated
        self._known = Descriptions()
        self._used: set[int] = set()
        """Channels that have messages."""
        self._statistics: Statistics | None = None
        self._damaged: dict[int, int] = {}
        """Lengths of damaged chunks by their offsets."""
        self._library = ''
        self.passed_bytes = 0
        """Bytes between records, or behind the last one, that make no sense."""
        self.complete = False
        """True if the file ends as a finished one does."""
        self.chunk_compressions: set[str] = set()
        """Compressions of the chunks ('' for not at all)."""
        with open_file(path, BagError) as stream:
            self._size = stream.seek(0, 2)
            allowed = Allowance(path, self._size)
            self._check_start(stream)
            indexed = self._by_index(stream)
            self.indexed = indexed is not None
            pieces = sorted(self._by_scan(stream, allowed) if indexed is None else indexed)
            self._pieces = self._without_copies(stream, pieces)
            self._describe(stream, allowed)

    @property
    def damaged_chunks(self) -> int:
        """Number of damaged chunks so far; complete once all messages were read."""
        return len(self._damaged)

    @property
    def definitions(self) -> dict[str, Definition]:
        """Definition of each topic's messages; the first channel of a topic counts."""
        by_topic: dict[str, Definition] = {}
        for topic, definition in self._known.all().values():
            by_topic.setdefault(topic, definition)
        return by_topic

    def types(self) -> set[tuple[str, str]]:
        """Return all pairs (topic, type)."""
        return {(topic, definition.type) for topic, definition in self._known.all().values()}

    def counts(self) -> dict[tuple[str, str], int] | None:
        """Return the stated number of messages by (topic, type); None if the file states none.

        Topics without messages are left out.
        """
        if self._statistics is None:
            return None
        counts: dict[tuple[str, str], int] = {}
        for number, count in self._statistics.channel_message_counts.items():
            described = self._known.find(number)
            if described and count:
                key = (described[0], described[1].type)
                counts[key] = counts.get(key, 0) + count
        return counts

    def messages(self) -> Iterator[RawMessage]:
        """Yield all messages in the order of their log times; equal ones in their stored order.

        Memory holds only chunks that overlap. In files of this project the sequence numbers of a
        topic's messages are their order of arrival.
        """
        lost_channels: Counter[int] = Counter()
        late: Counter[str] = Counter()
        allowed = Allowance(self.path, self._size)
        counted = self._library == LIBRARY
        with open_file(self.path, BagError) as stream:
            load = partial(self._load, stream, allowed=allowed)
            known = {
                number: (topic, definition.type)
                for number, (topic, definition) in self._known.all().items()
            }
            for message in in_log_order(self.path, self._pieces, load):
                described = known.get(message.channel_id)
                if described is None:
                    lost_channels[message.channel_id] += 1
                elif message.log_time > LATEST_STAMP.value:
                    late[described[0]] += 1
                else:
                    yield RawMessage(
                        *described,
                        message.log_time,
                        message.publish_time,
                        message.data,
                        message.channel_id,
                        message.sequence if counted else 0,
                    )
        for number, count in lost_channels.items():
            self._report(
                f'{self.path}: {count} messages of channel {number}, whose description was lost, '
                'were left out'
            )
        for topic, count in late.items():
            self._report(
                f'{self.path}: {count} messages on {topic} have no possible time, and were left out'
            )

    def _check_start(self, stream: BinaryIO) -> None:
        stream.seek(0)
        magic = stream.read(len(MCAP0_MAGIC))
        if not magic:
            raise BagError(
                f'{self.path}: the file is empty, expected an MCAP file; copy or record it again'
            )
        if magic != MCAP0_MAGIC:
            raise BagError(
                f'{self.path}: starts with {str(magic)[1:]}, expected an MCAP file; '
                '`trawl import-log LOG --draft` begins a mapping of another kind of log'
            )
        with suppress(*DAMAGE):
            header = next(parse_records(stream.read(_HEADER_BYTES)))
            self._library = header.library if isinstance(header, Header) else ''

    def _by_index(self, stream: BinaryIO) -> tuple[Piece, ...] | None:
        """Find the chunks by the summary; None where it is missing, damaged or without index."""
        self.complete = is_finished(stream, self._size)
        if not self.complete:
            return None
        try:
            summary = read_summary(stream, self._size)
            pieces = summary.pieces if summary and summary.pieces else ()
            if any(piece.offset + piece.length > self._size for piece in pieces):
                raise Damaged('its chunks go beyond the end of the file')
            if sum(piece.length for piece in pieces) > self._size:
                raise Damaged('its chunks overlap')
        except DAMAGE as reason:
            self._report(
                f'{self.path}: the index at the end is damaged ({reason}); '
                'the file is read from its start instead'
            )
            return None
        if summary is None:
            return None
        self._known.learn(summary.records)
        self._used |= summary.channels
        self._statistics = summary.statistics
        self.chunk_compressions |= summary.compressions
        return summary.pieces

    def _by_scan(self, stream: BinaryIO, allowed: Allowance) -> list[Piece]:
        """Scan the file record by record, and open chunks for the channels in them."""
        pieces = []
        for opcode, offset, length in self._walk(stream):
            stream.seek(offset + RECORD_START.size)
            if opcode == Opcode.CHUNK and length >= RECORD_START.size + _CHUNK_HEAD.size:
                start, *_, name = _CHUNK_HEAD.unpack(stream.read(_CHUNK_HEAD.size))
                compression = stream.read(min(name, _COMPRESSION_BYTES))
                piece = Piece(start, offset, length)
            elif opcode == Opcode.MESSAGE and length >= RECORD_START.size + _MESSAGE_HEAD.size:
                number, _, start = _MESSAGE_HEAD.unpack(stream.read(_MESSAGE_HEAD.size))
                self._used.add(number)
                pieces.append(Piece(start, offset, length))
                continue
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                piece = Piece(0, offset, length)
            else:
                continue
            records = self._load(stream, piece, allowed)
            self._known.learn(records or ())
            if opcode == Opcode.CHUNK and records is not None:
                messages = [record for record in records if isinstance(record, Message)]
                self._used |= {message.channel_id for message in messages}
                self.chunk_compressions.add(compression.decode('ascii', 'replace'))
                # No checksum covers the times that the chunk's head states.
                start = min((message.log_time for message in messages), default=start)
                pieces.append(Piece(start, offset, length))
        return pieces

    def _without_copies(self, stream: BinaryIO, pieces: list[Piece]) -> list[Piece]:
        copies = find_copies(stream, pieces)
        for copy, first in copies.items():
            self._report(
                f'{self.path}: the chunk at byte {copy.offset} is a copy of the one at byte '
                f'{first.offset} and was left out'
            )
        return [piece for piece in pieces if piece not in copies]

    def _describe(self, stream: BinaryIO, allowed: Allowance) -> None:
        """Search chunks for channels that the summary does not describe."""
        for piece in self._pieces if self.indexed else ():
            if not self._known.lacking(self._used):
                return
            self._known.learn(self._load(stream, piece, allowed) or ())
        if lost := self._known.lacking(self._used):
            self._recover(stream, lost)

    def _recover(self, stream: BinaryIO, lost: list[int]) -> None:
        """Recover channels from remains of their descriptions in damaged parts."""
        allowed = Allowance(self.path, self._size)
        chunks = (self._load(stream, piece, allowed) or [] for piece in self._pieces)
        recovered = recover(
            sample_messages(chunks, lost),
            [*self._known.records(), *read_remains(stream, self._damaged, self._size)],
            [topic for n, (topic, _) in self._known.all().items() if n not in lost],
            self._stated() if self._stated else None,
        )
        for number, channel in recovered.items():
            self._known.add(number, channel.topic, channel.definition)
            self._report(
                f'{self.path}: the description of channel {number} was lost; it is taken for '
                f'{channel.topic}, as damaged parts of the file say and {channel.witness} confirms'
            )

    def _walk(self, stream: BinaryIO) -> Iterator[tuple[int, int, int]]:
        """Yield opcode, offset and length of each record before the end of data."""
        for record in scan_records(stream, self._size, self._step_over):
            if record[0] != Opcode.DATA_END:
                yield record
            elif not self.complete:
                self._report(f'{self.path}: the index at the end is cut short; not needed')

    def _step_over(self, sentence: str, count: int) -> None:
        self.passed_bytes += count
        self._report(f'{self.path}: {sentence}')

    def _load(self, stream: BinaryIO, piece: Piece, allowed: Allowance) -> list[Record] | None:
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
                records = open_chunk(data, allowed)
            else:
                records = [r for r in (next(parse_records(data)),) if isinstance(r, Record)]
        except DAMAGE as reason:
            self._damaged[piece.offset] = piece.length
            self._report(
                f'{self.path}: the chunk at byte {piece.offset} is damaged ({reason}) '
                'and was skipped'
            )
            return None
        return records
