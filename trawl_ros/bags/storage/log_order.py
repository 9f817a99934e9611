"""Messages of chunks in the order of their log times."""

import heapq
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from mcap.records import Message

from trawl_ros.bags.storage.chunk_index import Piece
from trawl_ros.bags.storage.chunks import Record
from trawl_ros.core.errors import BagError
from trawl_ros.core.limits import BAG_WAITING


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
    waiting: list[tuple[int, int, int, Message]] = []
    held = 0
    for piece in [*pieces, None]:
        while waiting and (piece is None or waiting[0][0] < piece.start):
            message = heapq.heappop(waiting)[3]
            held -= len(message.data)
            yield message
        if piece is None:
            break
        for place, record in enumerate(load(piece) or ()):
            if isinstance(record, Message):
                held += len(record.data)
                heapq.heappush(waiting, (record.log_time, piece.offset, place, record))
        if held > BAG_WAITING.value:
            raise BagError(
                f'{path}: chunks before byte {piece.offset} overlap in time; expected '
                f'{BAG_WAITING} at most to be held at once'
            )
