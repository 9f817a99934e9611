"""Summary section of an MCAP file, with the index of its chunks."""

import zlib
from dataclasses import dataclass
from typing import BinaryIO

from mcap.reader import FOOTER_SIZE
from mcap.records import ChunkIndex, Footer, Statistics
from mcap.writer import MCAP0_MAGIC

from trawl_ros.bags.storage.chunks import MAX_CHUNK_BYTES, Damaged, parse_records

_TAIL_BYTES = FOOTER_SIZE + len(MCAP0_MAGIC)


@dataclass(frozen=True, order=True)
class Piece:
    """Chunk, or message outside of chunks: earliest log time (ns), offset and length."""

    start: int
    offset: int
    length: int


@dataclass(frozen=True)
class Summary:
    """Summary of a file.

    ``pieces`` is None where it does not say where all messages are, ``channels`` those that have
    messages. ``records`` are all of it; writers may have left any of them out.
    """

    records: tuple[object, ...]
    pieces: tuple[Piece, ...] | None
    channels: frozenset[int]
    statistics: Statistics | None
    compressions: frozenset[str]


def is_finished(stream: BinaryIO, size: int) -> bool:
    """True if a file ends as a finished one does."""
    stream.seek(max(size - len(MCAP0_MAGIC), 0))
    return size >= len(MCAP0_MAGIC) + _TAIL_BYTES and stream.read() == MCAP0_MAGIC


def read_summary(stream: BinaryIO, size: int) -> Summary | None:
    """Read the summary of a finished file; None if it has none.

    Raises
    ------
    Damaged
        And what else `DAMAGE` names, if it is not what its writer wrote.
    """
    stream.seek(size - _TAIL_BYTES)
    end = stream.read(_TAIL_BYTES)
    footer = next(parse_records(end[:FOOTER_SIZE]))
    if not isinstance(footer, Footer):
        raise Damaged('no footer')
    if footer.summary_start == 0:
        return None
    length = size - _TAIL_BYTES - footer.summary_start
    if not 0 < length <= MAX_CHUNK_BYTES:
        raise Damaged(f'a summary of {length} bytes')
    stream.seek(footer.summary_start)
    summary = stream.read(length)
    # All but the checksum itself is covered, with the footer's own start.
    if footer.summary_crc and zlib.crc32(summary + end[: FOOTER_SIZE - 4]) != footer.summary_crc:
        raise Damaged('its checksum does not match')
    return _summary(tuple(parse_records(summary + end)))


def _summary(records: tuple[object, ...]) -> Summary:
    indexes = [record for record in records if isinstance(record, ChunkIndex)]
    stated = next((record for record in records if isinstance(record, Statistics)), None)
    whole = stated is not None and (
        not stated.message_count or 0 < len(indexes) == stated.chunk_count
    )
    with_messages = stated.channel_message_counts if stated else {}
    numbers = {number for number, count in with_messages.items() if count}
    return Summary(
        records=records,
        pieces=tuple(
            Piece(index.message_start_time, index.chunk_start_offset, index.chunk_length)
            for index in indexes
        )
        if whole
        else None,
        channels=frozenset(numbers.union(*(index.message_index_offsets for index in indexes))),
        statistics=stated,
        compressions=frozenset(index.compression for index in indexes),
    )
