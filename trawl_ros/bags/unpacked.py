"""Files that rosbag2 compressed as a whole, unpacked for as long as they are read."""

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

from trawl_ros.bags.storage.allowance import RATIO
from trawl_ros.bags.storage.chunks import Damaged, inflate_file
from trawl_ros.core.errors import BagError
from trawl_ros.core.foreign import open_file
from trawl_ros.core.limits import BAG_UNPACKED

SPARE_BYTES = 1 << 30
"""Bytes left free on the disk when a compressed file is unpacked."""


class Unpacked:
    """Files that rosbag2 compressed as a whole, unpacked into a folder that goes with this."""

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
                most = BAG_UNPACKED.value + RATIO * path.stat().st_size
                inflate_file(source, target, min(free, most))
        except Damaged as reason:
            raise BagError(f'{path}: cannot be unpacked ({reason})') from reason
        except OSError as reason:
            raise BagError(f'{path}: cannot be unpacked ({reason.strerror})') from reason
        return plain
