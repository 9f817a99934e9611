"""Duplicate chunks of an MCAP file, as where a damaged disk gives a block once more."""

import hashlib
from collections import defaultdict
from collections.abc import Iterable
from typing import BinaryIO

from mcap.opcode import Opcode

from trawl_ros.bags.storage.chunk_index import Piece


def find_copies(stream: BinaryIO, pieces: Iterable[Piece]) -> dict[Piece, Piece]:
    """Find chunks equal to an earlier one byte for byte.

    A recorder never writes two: the same messages would have come at the same nanoseconds.

    Returns
    -------
    dict
        The first by each copy of it.
    """
    alike: defaultdict[tuple[int, int], list[Piece]] = defaultdict(list)
    for piece in pieces:
        alike[piece.start, piece.length].append(piece)
    copies = {}
    for group in alike.values():
        first: dict[bytes, Piece] = {}
        for piece in sorted(group) if len(group) > 1 else ():
            stream.seek(piece.offset)
            if stream.read(1) != bytes([Opcode.CHUNK]):
                continue
            stream.seek(piece.offset)
            digest = hashlib.sha256(stream.read(piece.length)).digest()
            if first.setdefault(digest, piece) != piece:
                copies[piece] = first[digest]
    return copies
