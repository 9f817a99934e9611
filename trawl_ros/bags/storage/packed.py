# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages and files that rosbag2 compressed (zstd), unpacked as they are read.

Metadata state the compression, but may be lost. A ROS 2 message begins with a zero byte, and a zstd
frame with its magic number, so each can be recognised.
"""

import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO

import zstandard

from trawl_ros.bags.storage.chunks import (
    MAX_CHUNK_BYTES,
    STEP_BYTES,
    UNPACKED_PER_BYTE,
    Allowance,
    Damaged,
    read_up_to,
    unpacker,
)
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.core.errors import BagError
from trawl_ros.core.foreign import open_file
from trawl_ros.core.limits import BAG_UNPACKED

MAGIC = b'\x28\xb5\x2f\xfd'

SPARE_BYTES = 1 << 30
"""Bytes that stay free on the disk when a compressed file is unpacked."""

_FRAME_START = 64
"""Bytes of a compressed frame that hold its header."""


class PackedMessages:
    """Unpacker of the messages of a bag.

    Attributes
    ----------
    found
        True if there was a compressed message so far.
    lost
        Messages that could not be unpacked, by topic.
    """

    def __init__(self) -> None:
        self.found = False
        self.lost: Counter[str] = Counter()

    def unpack(self, messages: Iterable[RawMessage], allowed: Allowance) -> Iterator[RawMessage]:
        """Yield messages as they were published, without damaged ones."""
        for stored in messages:
            if not stored.data.startswith(MAGIC):
                yield stored
                continue
            self.found = True
            try:
                plain = inflate(stored.data)
            except Damaged:
                self.lost[stored.topic] += 1
                continue
            allowed.take_bytes(len(plain))
            yield stored._replace(data=plain)

    def report(self, path: Path, report: Callable[[str], None]) -> None:
        """Report the lost messages."""
        for topic, count in self.lost.items():
            report(f'{path}: {count} compressed messages on {topic} are damaged')


class Unpacked:
    """Files that rosbag2 compressed as a whole, unpacked into a temporary folder."""

    def __init__(self, packed: list[Path]) -> None:
        self.packed = packed
        self._folder = TemporaryDirectory()
        self.plain = [self._unpack(path, Path(self._folder.name)) for path in packed]

    @staticmethod
    def _unpack(path: Path, folder: Path) -> Path:
        plain = folder / path.stem
        try:
            free = shutil.disk_usage(folder).free - SPARE_BYTES
            with open_file(path, BagError) as source, plain.open('xb') as target:
                most = BAG_UNPACKED.value + UNPACKED_PER_BYTE * path.stat().st_size
                inflate_file(source, target, min(free, most))
        except Damaged as reason:
            raise BagError(f'{path}: cannot be unpacked ({reason})') from reason
        except OSError as reason:
            raise BagError(f'{path}: cannot be unpacked ({reason.strerror})') from reason
        return plain


def inflate(data: bytes) -> bytes:
    """Unpack one message that rosbag2 compressed by itself (zstd).

    Raises
    ------
    Damaged
        If it is not zstd, or becomes larger than what is read.
    """
    try:
        plain = read_up_to(unpacker(data), MAX_CHUNK_BYTES + 1)
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
        reader = unpacker(packed)
        while piece := reader.read(STEP_BYTES):
            size += len(piece)
            if size > limit:
                raise Damaged(f'it becomes more than {limit} bytes, for which there is no room')
            plain.write(piece)
        packed.seek(0)
        _check_size(packed.read(_FRAME_START), size)
    except zstandard.ZstdError as reason:
        raise Damaged(str(reason)) from reason


def _check_size(start: bytes, size: int) -> None:
    """Compare with the size in the frame; its reader accepts a frame that was cut short."""
    stated = zstandard.get_frame_parameters(start).content_size
    if stated != zstandard.CONTENTSIZE_UNKNOWN and size < stated:
        raise Damaged(f'it should become {stated} bytes and becomes {size}')
