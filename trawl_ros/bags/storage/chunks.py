"""Chunk of an MCAP file, decoded with checks of sizes and checksums.

Sizes are checked before memory is taken, and checksums before anything is believed.
"""

import io
import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import StreamReader

from trawl_ros.bags.storage.allowance import Allowance
from trawl_ros.core.limits import CHUNK_BYTES

MAX_CHUNK_BYTES = CHUNK_BYTES.value
"""Largest chunk (and largest single record) that is read; writers make them of about 1 MB."""

DAMAGE = (
    McapError,
    struct.error,
    ValueError,
    OverflowError,
    KeyError,
    zstandard.ZstdError,
    RuntimeError,
)
"""All that is raised by the MCAP records and decompressors when bytes are not what they say."""

Record = Schema | Channel | Message

_RECORD_HEAD = 9
_MESSAGE = struct.Struct('<BQHIQQ')
"""Opcode, length, channel, sequence, log and publish time of a message."""

_STEP = 1 << 20
_SMALL_STEP = 1 << 10
_FRAME_START = 64
"""Bytes of a compressed frame that hold its header."""


class Damaged(ValueError):
    """Damaged bytes; the text says how."""


def parse_records(data: bytes) -> Iterator[object]:
    """Read records from bytes, up to and with a footer and the magic bytes behind it."""
    return StreamReader(io.BytesIO(data), skip_magic=True, emit_chunks=True).records


def open_chunk(record: bytes, allowed: Allowance) -> list[Record]:
    """Give schemas, channels and messages of a chunk, in the order in which they stand there.

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
    """Take the unpacked content of a chunk apart.

    Nearly all of it are whole messages, which are read here; the rest is left to ``mcap``, whose
    reader of single numbers takes ten times as long.
    """
    records: list[Record] = []
    stream = io.BytesIO(plain)
    rest = ReadDataStream(stream)
    head, unpack = _MESSAGE.size, _MESSAGE.unpack_from
    place, size = 0, len(plain)
    while place < size:
        if plain[place] == Opcode.MESSAGE and place + head <= size:
            _, length, channel, sequence, log_time, publish_time = unpack(plain, place)
            end = place + _RECORD_HEAD + length
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


def salvage(record: bytes) -> bytes:
    """Unpack a damaged chunk as far as that goes; what comes out may be wrong anywhere."""
    pieces: list[bytes] = []
    try:
        chunk = next(parse_records(record))
        if not isinstance(chunk, Chunk):
            return b''
        if chunk.compression == '':
            return chunk.data
        unpack = (
            lz4.frame.open(io.BytesIO(chunk.data))
            if chunk.compression == 'lz4'
            else _unpacker(chunk.data)
        )
        left = min(chunk.uncompressed_size, MAX_CHUNK_BYTES)
        while left > 0 and (piece := unpack.read(min(left, _SMALL_STEP))):
            pieces.append(piece)
            left -= len(piece)
    except (*DAMAGE, EOFError):
        pass
    return b''.join(pieces)


def inflate(data: bytes) -> bytes:
    """Unpack one message that rosbag2 compressed by itself (zstd).

    Raises
    ------
    Damaged
        If it is not zstd, or becomes larger than what is read.
    """
    try:
        plain = _read_up_to(_unpacker(data), MAX_CHUNK_BYTES + 1)
        if len(plain) > MAX_CHUNK_BYTES:
            raise Damaged(f'it becomes more than the {MAX_CHUNK_BYTES} bytes that are read')
        _check_size(data, len(plain))
    except zstandard.ZstdError as reason:
        raise Damaged(str(reason)) from reason
    return plain


def inflate_file(packed: BinaryIO, plain: BinaryIO, limit: int) -> None:
    """Unpack a file that rosbag2 compressed as a whole (zstd).

    Raises
    ------
    Damaged
        If it is not zstd, or becomes larger than ``limit`` bytes.
    """
    size = 0
    try:
        reader = _unpacker(packed)
        while piece := reader.read(_STEP):
            size += len(piece)
            if size > limit:
                raise Damaged(f'it becomes more than {limit} bytes, for which there is no room')
            plain.write(piece)
        packed.seek(0)
        _check_size(packed.read(_FRAME_START), size)
    except zstandard.ZstdError as reason:
        raise Damaged(str(reason)) from reason


def _check_size(start: bytes, size: int) -> None:
    """Compare with the size in the frame; its reader takes one that is cut short for the end."""
    stated = zstandard.get_frame_parameters(start).content_size
    if stated != zstandard.CONTENTSIZE_UNKNOWN and size < stated:
        raise Damaged(f'it should become {stated} bytes and becomes {size}')


def _unpacker(data: bytes | BinaryIO) -> zstandard.ZstdDecompressionReader:
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
            plain = _read_up_to(_unpacker(chunk.data), size + 1)
        case 'lz4':
            plain = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        case other:
            raise Damaged(f'its compression is {other!r}, expected zstd, lz4 or none')
    if len(plain) != size:
        raise Damaged(f'it claims {size} bytes and holds {"more" if len(plain) > size else "less"}')
    return plain


def _read_up_to(reader: zstandard.ZstdDecompressionReader, limit: int) -> bytes:
    pieces: list[bytes] = []
    left = limit
    while left and (piece := reader.read(min(left, _STEP))):
        pieces.append(piece)
        left -= len(piece)
    return b''.join(pieces)
