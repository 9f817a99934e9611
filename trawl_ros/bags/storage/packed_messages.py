"""Messages that rosbag2 compressed one by one, unpacked as they are read.

Metadata say so, but may be lost. A message of ROS 2 begins with a zero, one of zstd with its magic
number, so each tells by itself.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from trawl_ros.bags.storage.allowance import Allowance
from trawl_ros.bags.storage.chunks import Damaged, inflate
from trawl_ros.bags.storage.stored import Stored

MAGIC = b'\x28\xb5\x2f\xfd'


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

    def unpack(self, messages: Iterable[Stored], allowed: Allowance) -> Iterator[Stored]:
        """Yield messages as they were published; leave out those that are damaged."""
        for stored in messages:
            if not stored.message.data.startswith(MAGIC):
                yield stored
                continue
            self.found = True
            try:
                plain = replace(stored.message, data=inflate(stored.message.data))
            except Damaged:
                self.lost[stored.topic] += 1
                continue
            allowed.take_bytes(len(plain.data))
            yield stored._replace(message=plain)

    def report(self, path: Path, report: Callable[[str], None]) -> None:
        """Report what was lost."""
        for topic, count in self.lost.items():
            report(f'{path}: {count} compressed messages on {topic} are damaged')
