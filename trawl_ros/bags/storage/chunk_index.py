# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Index of an MCAP file: its summary, its chunks, and their messages in time order."""

import heapq
import math
import zlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap.reader import FOOTER_SIZE
from mcap.records import ChunkIndex, Footer, Message, Statistics
from mcap.writer import MCAP0_MAGIC

from trawl_ros.bags.storage.chunks import MAX_CHUNK_BYTES, Damaged, Record, parse_records
from trawl_ros.core.errors import BagError
from trawl_ros.core.limits import BAG_WAITING

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

    ``pieces`` is None if it does not state where all messages are. ``channels`` are those that have
    messages. ``records`` are all of it; writers may have left any of them out.
    """

    records: tuple[object, ...]
    pieces: tuple[Piece, ...] | None
    channels: frozenset[int]
    statistics: Statistics | None
    compressions: frozenset[str]


def is_finished(stream: BinaryIO, size: int) -> bool:
    """True if a file has the end of a finished one."""
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


def in_log_order(
    path: Path, pieces: Iterable[Piece], load: Callable[[Piece], list[Record] | None]
) -> Iterator[Message]:
    """Yield all messages in the order of their log times; equal ones as they stand in the file.

    Chunks are opened as their time comes, so that memory holds only those that overlap.

    Parameters
    ----------
    path
        Of the file.
    pieces
        Its chunks, in the order of their first times.
    load
        Reads the records of a chunk; None where it is damaged.

    Raises
    ------
    BagError
        If more bytes of chunks overlap than `BAG_WAITING`.
    """
    runs: list[tuple[int, int, int, list[Message]]] = []
    held = 0
    for number, piece in enumerate([*pieces, None]):
        end = math.inf if piece is None else piece.start
        while runs and runs[0][0] < end:
            _, offset, begun, run = heapq.heappop(runs)
            # Alone, as chunks of most writers are, a run goes on to its end.
            until = min(end, runs[0][0] + (offset < runs[0][1])) if runs else end
            while True:
                message = run.pop()
                held -= len(message.data)
                yield message
                if not run:
                    break
                if run[-1].log_time >= until:
                    heapq.heappush(runs, (run[-1].log_time, offset, begun, run))
                    break
        if piece is None:
            break
        run = [record for record in load(piece) or () if isinstance(record, Message)]
        if run:
            held += sum(len(message.data) for message in run)
            run.sort(key=lambda message: message.log_time)
            run.reverse()
            heapq.heappush(runs, (run[-1].log_time, piece.offset, number, run))
        if held > BAG_WAITING.value:
            raise BagError(
                f'{path}: chunks before byte {piece.offset} overlap in time; expected '
                f'{BAG_WAITING} at most to be held at once'
            )
