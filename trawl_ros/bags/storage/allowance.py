"""Allowance of a file of a bag: how much of it is unpacked, by the size that it has."""

import struct
from pathlib import Path

from trawl_ros.core.errors import BagError
from trawl_ros.core.limits import BAG_MESSAGES, BAG_UNPACKED

BYTES_PER_MESSAGE = 8
"""Of a file, for each message beyond `BAG_MESSAGES`; its entry in an index takes 16."""

RATIO = 200
"""Unpacked bytes per byte of a file, beyond `BAG_UNPACKED`; bags of tows have 8."""

_RECORD_START = struct.Struct('<BQ')


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
        self._bytes = BAG_UNPACKED.value + RATIO * size
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
            raise self._beyond(f'{BAG_UNPACKED} and {RATIO} per byte')

    def take_records(self, plain: bytes) -> None:
        """Count the records in bytes that are about to be taken apart.

        Raises
        ------
        BagError
            As `take_bytes`.
        """
        place = 0
        while place + _RECORD_START.size <= len(plain):
            place += _RECORD_START.size + _RECORD_START.unpack_from(plain, place)[1]
            self._records -= 1
            if self._records < 0:
                raise self._beyond(f'{BAG_MESSAGES} and one per {BYTES_PER_MESSAGE} bytes')

    def _beyond(self, most: str) -> BagError:
        return BagError(
            f'{self._path}: {self._size} bytes that unpack to more than any recording does; '
            f'expected {most} at most'
        )
