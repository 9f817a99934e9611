# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Encoder of CDR for messages of thousands of points, which generated encoders take one by one."""

import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

HEAD = b'\x00\x01\x00\x00'
"""Encapsulation of little-endian CDR; alignment counts from behind it."""


@dataclass(frozen=True)
class Encoded:
    """Message that is CDR already: `serialize` returns its bytes."""

    __msgtype__: str
    data: bytes


class CdrWriter:
    """Writer of little-endian CDR (OMG DDSI-RTPS 2.5, 10.2), field after field."""

    def __init__(self) -> None:
        self._data = bytearray(HEAD)

    def numbers(self, code: str, *values: float) -> None:
        """Write numbers of one width, by a format of `struct` without byte order, as ``'3d'``."""
        self._align(struct.calcsize(code[-1]))
        self._data += struct.pack(f'<{code}', *values)

    def text(self, value: str) -> None:
        """Write a string."""
        encoded = value.encode() + b'\0'
        self.numbers('I', len(encoded))
        self._data += encoded

    def rows(self, array: NDArray[Any]) -> None:
        """Write a sequence of numbers, shape (n,), or of records of k numbers, shape (n, k)."""
        self.numbers('I', len(array))
        if len(array):
            self._align(array.itemsize)
            self._data += np.ascontiguousarray(array).tobytes()

    def _align(self, width: int) -> None:
        self._data += bytes(-(len(self._data) - len(HEAD)) % width)

    def data(self) -> bytes:
        """Return the message."""
        return bytes(self._data)
