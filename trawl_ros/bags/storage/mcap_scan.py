"""MCAP scan: from record to record through a file without an index, also across damage.

Where the chain of records breaks, the next chunk is looked for byte by byte: its header is known
by lengths that fit each other, and what it holds is believed only if its checksum is right.
"""

import re
import struct
from collections.abc import Callable, Iterator
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from trawl_ros.bags.storage.chunks import MAX_CHUNK_BYTES

RECORD_START = struct.Struct('<BQ')
_FIRST_PRIVATE = 0x80
_WINDOW = 1 << 20

# Opcode, length, two times, size, checksum, compression, length of the compressed records.
# Lengths stay below 4 GB, so their upper halves are zero.
_CHUNK_HEADER = re.compile(
    rb'\x06(.{4})\0{4}.{16}.{4}\0{4}.{4}(\x04\0{3}zstd|\x03\0{3}lz4|\0{4})(.{4})\0{4}', re.DOTALL
)
_LONGEST_HEADER = 57
_BEFORE_COMPRESSION = 28
_INDEX_HEAD = struct.Struct('<HI')


def scan_records(
    stream: BinaryIO, size: int, report: Callable[[str, int], None]
) -> Iterator[tuple[int, int, int]]:
    """Give opcode, offset and length of each record, up to and with the end of data.

    Parameters
    ----------
    stream
        The file; it is moved about in.
    size
        Its length in bytes.
    report
        Takes a sentence, without the file's name, for each stretch that is stepped over, and how
        many bytes that is.
    """
    offset = len(MCAP0_MAGIC)
    while offset + RECORD_START.size <= size:
        stream.seek(offset)
        opcode, inner = RECORD_START.unpack(stream.read(RECORD_START.size))
        length = RECORD_START.size + inner
        known = 0 < opcode <= Opcode.DATA_END or opcode >= _FIRST_PRIVATE
        if known and offset + length <= size and _fits(stream, opcode, offset, inner):
            yield opcode, offset, length
            if opcode == Opcode.DATA_END:
                return
            offset += length
            continue
        following = next_chunk(stream, offset + 1, size)
        if following is None:
            break
        gap = following - offset
        report(f'damaged at byte {offset}; {gap} bytes were stepped over', gap)
        offset = following
    rest = size - offset
    report(
        f'cut short or damaged at byte {offset}; what stands before is used'
        + (f', {rest} bytes behind are not' if rest > 0 else ''),
        max(rest, 0),
    )


def next_chunk(stream: BinaryIO, offset: int, size: int) -> int | None:
    """Find the next offset at which bytes are the header of a chunk; None if there is none."""
    while offset < size:
        stream.seek(offset)
        window = stream.read(_WINDOW)
        place = 0
        while header := _CHUNK_HEADER.search(window, place):
            start = offset + header.start()
            inner = int.from_bytes(header[1], 'little')
            if start + RECORD_START.size + inner <= size and _chunk_fits(header, inner):
                return start
            place = header.start() + 1
        # Windows overlap, so that a header across two of them is found too.
        offset += _WINDOW - _LONGEST_HEADER
    return None


def _fits(stream: BinaryIO, opcode: int, offset: int, inner: int) -> bool:
    """True if a record's length agrees with the lengths of its own parts."""
    if opcode == Opcode.CHUNK:
        stream.seek(offset)
        header = _CHUNK_HEADER.match(stream.read(_LONGEST_HEADER))
        # A chunk too large to be opened is passed by its length, and said by who opens it.
        return inner > MAX_CHUNK_BYTES or (header is not None and _chunk_fits(header, inner))
    if opcode == Opcode.MESSAGE_INDEX:
        head = stream.read(_INDEX_HEAD.size)
        return (
            len(head) == _INDEX_HEAD.size
            and inner == _INDEX_HEAD.size + _INDEX_HEAD.unpack(head)[1]
        )
    return True


def _chunk_fits(header: re.Match[bytes], inner: int) -> bool:
    records = int.from_bytes(header[3], 'little')
    return inner == _BEFORE_COMPRESSION + len(header[2]) + 8 + records
