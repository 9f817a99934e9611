"""Messages of chunks in the order of their log times."""

import heapq
import math
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
