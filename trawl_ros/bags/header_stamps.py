"""Header stamps of stored messages, read by the bag's own types."""

import struct
from collections.abc import Callable

from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import BagError
from trawl_ros.core.time import SECOND

StampReader = Callable[[bytes], int | None]

_HEADER = 'std_msgs/msg/Header'
_ENCAPSULATION = 4
_TIMES = {0: struct.Struct('>iI'), 1: struct.Struct('<iI')}


def stamp_reader(bag: Bag, topic: str) -> StampReader | None:
    """Make the reader of the stamp (ns) in a topic's bytes, without decoding the rest.

    Returns
    -------
    callable or None
        None where the type does not begin with a header or is not known. The callable gives
        None for bytes that are too short.
    """
    try:
        _, fields = bag.types_of(topic).fielddefs[bag.topics[topic]]
    except (BagError, KeyError):
        return None
    if not fields or fields[0][1][1] != _HEADER:
        return None
    return _read


def _read(data: bytes) -> int | None:
    try:
        seconds, nanoseconds = _TIMES[data[1]].unpack_from(data, _ENCAPSULATION)
    except (struct.error, KeyError, IndexError):
        return None
    return int(seconds) * SECOND + int(nanoseconds)
