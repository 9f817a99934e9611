"""Decoder that fills one message again and again, for topics whose messages are laid out alike.

Decoding spends its time on objects and on lengths of strings and sequences. Those of a topic hardly
ever change: where they are byte for byte what they were, numbers stand where they stood.
"""

import struct
from collections.abc import Callable
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

from trawl_ros.core.errors import MessageError

ENCAPSULATION = b'\0\1\0\0'
"""Start of little-endian CDR; other messages are decoded one by one."""

LAYOUTS = 8
"""Layouts that are looked for in a topic at most; one with more has none that is worth it."""

ALIGNMENT, PATTERN = 4, 251

LARGEST = 1 << 14
"""Size (bytes) of a message from which on its content takes longer than its layout."""

CODES = {
    'bool': '?', 'byte': 'B', 'char': 'B', 'int8': 'b', 'uint8': 'B', 'int16': 'h', 'uint16': 'H',
    'int32': 'i', 'uint32': 'I', 'int64': 'q', 'uint64': 'Q', 'float32': 'f', 'float64': 'd',
}  # fmt: skip


class Unsuited(ValueError):
    """A type with parts that are not read here."""


class Layout:
    """Layout of messages with the same strings and lengths, with the message that is filled.

    Parameters
    ----------
    message
        Message as decoded, which is filled from now on.
    data
        Its bytes.
    store, name
        Types of the bag, and the message's.

    Raises
    ------
    Unsuited
        If not all of it can be read here.
    """

    def __init__(self, message: Any, data: bytes, store: Typestore, name: str) -> None:
        self._message, self._data, self._store = message, data, store
        self._fixed: list[tuple[int, int, bytes]] = []
        self._singles: list[tuple[Any, str]] = []
        self._arrays: list[tuple[Any, str, np.dtype[Any], int, int]] = []
        self._spans: list[tuple[int, int]] = []
        self._place, self._read, self._form = len(ENCAPSULATION), 0, '<'
        self._walk(message, name)
        self._unpack = struct.Struct(self._form).unpack_from

    def fill(self, data: bytes) -> Any | None:
        """Fill the message from bytes of the same length; None if they are laid out otherwise."""
        for start, end, there in self._fixed:
            if data[start:end] != there:
                return None
        for (owner, name), value in zip(self._singles, self._unpack(data), strict=True):
            setattr(owner, name, value)
        for owner, name, kind, count, offset in self._arrays:
            setattr(owner, name, np.frombuffer(data, kind, count, offset))
        return self._message

    def _walk(self, message: Any, name: str) -> None:
        fields: Any = self._store.fielddefs[name][1]
        for field, (node, detail) in fields:
            if node == Nodetype.NAME:
                self._walk(getattr(message, field), detail)
            elif node == Nodetype.BASE and detail[0] == 'string':
                self._string()
            elif node == Nodetype.BASE:
                self._number(message, field, detail[0], None)
            else:
                count = detail[1] if node == Nodetype.ARRAY else self._length()
                self._several(message, field, detail[0], count)

    def _several(self, message: Any, field: str, kind: Any, count: int) -> None:
        node, detail = kind
        if node == Nodetype.NAME:
            for each in getattr(message, field):
                self._walk(each, detail)
        elif detail[0] == 'string':
            for _ in range(count):
                self._string()
        elif count:
            self._number(message, field, detail[0], count)

    def _number(self, message: Any, field: str, kind: str, count: int | None) -> None:
        code = CODES.get(kind)
        if code is None:
            raise Unsuited(kind)
        size = struct.calcsize(code)
        start = self._aligned(size)
        self._place = start + size * (1 if count is None else count)
        self._spans.append((start, self._place))
        if count is None:
            self._form += f'{start - self._read}x{code}'
            self._read = self._place
            self._singles.append((message, field))
        else:
            self._arrays.append((message, field, np.dtype(code).newbyteorder('<'), count, start))

    def _string(self) -> None:
        start = self._aligned(4)
        self._keep(start, start + 4 + self._length())

    def _length(self) -> int:
        """Read the length of a string or sequence, which is to stay the same."""
        start = self._aligned(4)
        self._keep(start, start + 4)
        return int.from_bytes(self._data[start : start + 4], 'little')

    def _keep(self, start: int, end: int) -> None:
        """Note bytes that have to be the same, with those before them but for few numbers."""
        self._place = end
        if self._fixed and start - self._fixed[-1][1] < ALIGNMENT:
            start = self._fixed.pop()[0]
        self._fixed.append((start, end, self._data[start:end]))

    def _aligned(self, size: int) -> int:
        """Place of the next number of this size."""
        return self._place + -(self._place - len(ENCAPSULATION)) % size

    def tried_on(self) -> bytes:
        """Bytes of a message with this layout in which all numbers differ."""
        data = bytearray(self._data)
        pattern = bytes(number % PATTERN for number in range(len(data)))
        for start, end in self._spans:
            data[start:end] = pattern[start:end]
        return bytes(data)


class RefillingDecoder:
    """Decoder of a topic that may give the same message each time, with other content.

    Parameters
    ----------
    decode
        Decoder of all messages, which has taken one of a layout before it is read here.
    store, name
        Types of the bag, and the topic's.
    """

    def __init__(self, decode: Callable[[bytes], Any], store: Typestore, name: str) -> None:
        self._decode, self._store, self._name = decode, store, name
        self._layouts: dict[int, Layout] = {}
        self._tried = 0

    def __call__(self, data: bytes) -> Any:
        """Decode a message, which is good until the next is decoded.

        Raises
        ------
        MessageError
            As the decoder of all messages.
        """
        layout = self._layouts.get(len(data))
        if layout is not None and data[:4] == ENCAPSULATION:
            message = layout.fill(data)
            if message is not None:
                return message
        message = self._decode(data)
        if self._tried < LAYOUTS and len(data) <= LARGEST and data[:4] == ENCAPSULATION:
            self._tried += 1
            self._learn(data)
        return message

    def _learn(self, data: bytes) -> None:
        """Find the layout of a message, and try it on bytes in which all numbers differ."""
        try:
            layout = Layout(self._decode(data), data, self._store, self._name)
            trial = layout.tried_on()
            decoded, filled = self._decode(trial), layout.fill(trial)
        except Unsuited:
            self._tried = LAYOUTS
        except MessageError:
            return
        else:
            if filled is not None and self._bytes_of(filled) == self._bytes_of(decoded):
                self._layouts[len(data)] = layout

    def _bytes_of(self, message: Any) -> bytes:
        return bytes(self._store.serialize_cdr(message, self._name, little_endian=True))
