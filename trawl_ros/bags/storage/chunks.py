# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Chunk of an MCAP file, decoded with checks of sizes and checksums.

Sizes are checked before memory is allocated, and checksums before any content is used.
"""

import io
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import StreamReader

from trawl_ros.core.errors import BagError
from trawl_ros.core.limits import BAG_MESSAGES, BAG_UNPACKED, CHUNK_BYTES

MAX_CHUNK_BYTES = CHUNK_BYTES.value
"""Largest chunk (and largest single record) that is read; writers make chunks of about 1 MB."""

DAMAGE = (
    McapError,
    struct.error,
    ValueError,
    OverflowError,
    KeyError,
    zstandard.ZstdError,
    RuntimeError,
)
"""Exceptions that MCAP records and decompressors raise for invalid bytes."""

Record = Schema | Channel | Message

BYTES_PER_MESSAGE = 8
"""Bytes of a file for each message beyond `BAG_MESSAGES`; its entry in an index takes 16."""

UNPACKED_PER_BYTE = 200
"""Unpacked bytes per byte of a file, beyond `BAG_UNPACKED`; bags of tows have 8."""

STEP_BYTES = 1 << 20
"""Number of bytes that are unpacked at once."""

RECORD_START = struct.Struct('<BQ')
"""Opcode and length of a record."""

_MESSAGE = struct.Struct('<BQHIQQ')
"""Opcode, length, channel, sequence, log and publish time of a message."""


class Damaged(ValueError):
    """Damaged bytes; the text says how."""


class Allowance:
    """Allowance of one pass through a file: the bytes that may be unpacked from it.

    Parameters
    ----------
    path
        Of the file, named in errors.
    size
        Size of it in bytes: small files that claim to hold much hold nothing that was recorded.
    """

    def __init__(self, path: Path, size: int) -> None:
        self._path = path
        self._size = size
        self._bytes = BAG_UNPACKED.value + UNPACKED_PER_BYTE * size
        self._records = BAG_MESSAGES.value + size // BYTES_PER_MESSAGE

    def take_bytes(self, count: int) -> None:
        """Count bytes that were unpacked; a chunk of them is bounded by itself.

        Raises
        ------
        BagError
            If that is more than is allowed.
        """
        self._bytes -= count
        if self._bytes < 0:
            raise self._beyond(f'{BAG_UNPACKED} and {UNPACKED_PER_BYTE} per byte')

    def take_records(self, plain: bytes) -> None:
        """Count the records in bytes that are about to be parsed.

        Raises
        ------
        BagError
            As `take_bytes`.
        """
        place = 0
        while place + RECORD_START.size <= len(plain):
            place += RECORD_START.size + RECORD_START.unpack_from(plain, place)[1]
            self._records -= 1
            if self._records < 0:
                raise self._beyond(f'{BAG_MESSAGES} and one per {BYTES_PER_MESSAGE} bytes')

    def _beyond(self, most: str) -> BagError:
        return BagError(
            f'{self._path}: {self._size} bytes that unpack to more than any recording does; '
            f'expected {most} at most'
        )


def parse_records(data: bytes) -> Iterator[object]:
    """Read records from bytes, up to and with a footer and the magic bytes behind it."""
    return StreamReader(io.BytesIO(data), skip_magic=True, emit_chunks=True).records


def open_chunk(record: bytes, allowed: Allowance) -> list[Record]:
    """Yield schemas, channels and messages of a chunk, in their stored order.

    Parameters
    ----------
    record
        The whole record with opcode and length.
    allowed
        Bytes that may still be taken out of the file.

    Raises
    ------
    Damaged
        If the record is no chunk, too large, or fails its checksum.
    BagError
        If more is in it than is allowed.
    """
    try:
        chunk = next(parse_records(record))
        if not isinstance(chunk, Chunk):
            raise Damaged('no chunk starts there')
        plain = _decompress(chunk)
        allowed.take_bytes(len(plain))
        allowed.take_records(plain)
        if chunk.uncompressed_crc and zlib.crc32(plain) != chunk.uncompressed_crc:
            raise Damaged('its checksum does not match')
        return _records_in(plain)
    except Damaged:
        raise
    except DAMAGE as reason:
        raise Damaged(str(reason) or 'its records are cut short') from reason


def _records_in(plain: bytes) -> list[Record]:
    """Parse the unpacked content of a chunk.

    Nearly all of it are complete messages, which are parsed here. The rest is left to ``mcap``,
    whose parser of single numbers takes ten times as long.
    """
    records: list[Record] = []
    stream = io.BytesIO(plain)
    rest = ReadDataStream(stream)
    head, unpack = _MESSAGE.size, _MESSAGE.unpack_from
    place, size = 0, len(plain)
    while place < size:
        if plain[place] == Opcode.MESSAGE and place + head <= size:
            _, length, channel, sequence, log_time, publish_time = unpack(plain, place)
            end = place + RECORD_START.size + length
            if place + head <= end <= size:
                data = plain[place + head : end]
                records.append(Message(channel, log_time, data, publish_time, sequence))
                place = end
                continue
        before = rest.count
        stream.seek(place)
        record = _record_of(rest)
        if record is not None:
            records.append(record)
        place += rest.count - before
    return records


def _record_of(stream: ReadDataStream) -> Record | None:
    """Read the next record; None for one of another kind."""
    opcode, length = stream.read1(), stream.read8()
    record: Record | None = None
    match opcode:
        case Opcode.CHANNEL:
            record = Channel.read(stream)
        case Opcode.MESSAGE:
            record = Message.read(stream, length)
        case Opcode.SCHEMA:
            record = Schema.read(stream)
        case _:
            stream.read(length)
    return record


def unpacker(data: bytes | BinaryIO) -> zstandard.ZstdDecompressionReader:
    """Reader of zstd in bounded memory."""
    return zstandard.ZstdDecompressor(max_window_size=MAX_CHUNK_BYTES).stream_reader(
        data, read_across_frames=True
    )


def _decompress(chunk: Chunk) -> bytes:
    size = chunk.uncompressed_size
    if size > MAX_CHUNK_BYTES:
        raise Damaged(f'it claims {size} bytes, more than the {MAX_CHUNK_BYTES} that are read')
    match chunk.compression:
        case '':
            plain = chunk.data
        case 'zstd':
            # Step by step, since a frame may claim another size than the chunk does.
            plain = read_up_to(unpacker(chunk.data), size + 1)
        case 'lz4':
            plain = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        case other:
            raise Damaged(f'its compression is {other!r}, expected zstd, lz4 or none')
    if len(plain) != size:
        raise Damaged(f'it claims {size} bytes and holds {"more" if len(plain) > size else "less"}')
    return plain


def read_up_to(reader: zstandard.ZstdDecompressionReader, limit: int) -> bytes:
    """Read what a decompressor gives, up to a number of bytes."""
    pieces: list[bytes] = []
    left = limit
    while left and (piece := reader.read(min(left, STEP_BYTES))):
        pieces.append(piece)
        left -= len(piece)
    return b''.join(pieces)
