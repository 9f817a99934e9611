# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Stamps: integer nanoseconds in the project, seconds and nanoseconds in messages."""

import struct
from typing import Any

from rosbags.typesys.stores.ros2_jazzy import builtin_interfaces__msg__Time as Time
from rosbags.typesys.stores.ros2_jazzy import std_msgs__msg__Header as Header

from trawl_ros.core.errors import MessageError
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import STORE

MARKERS = 'visualization_msgs/msg/MarkerArray'


def header_stamp(type_name: str, data: bytes) -> int | None:
    """Return the stamp (ns) of a message's header; None without a header.

    For an array of markers it is the stamp of the first marker.
    """
    if type_name == MARKERS:
        # The header follows the number of markers.
        stamp = stamp_in(data, ENCAPSULATION + 4) if len(data) > 20 else None
    else:
        stamp = stamp_in(data) if _begins_with_header(type_name) else None
    return stamp if stamp is not None and stamp >= 0 else None


def _begins_with_header(type_name: str) -> bool:
    if type_name not in _KNOWN:
        kind = STORE.types.get(type_name)
        names = list(getattr(kind, '__dataclass_fields__', {}))
        _KNOWN[type_name] = names[:1] == ['header']
    return _KNOWN[type_name]


_KNOWN: dict[str, bool] = {}


def to_time(stamp: int) -> Time:
    """Turn nanoseconds into a ``builtin_interfaces/Time``."""
    seconds, nanoseconds = divmod(int(stamp), SECOND)
    return Time(seconds, nanoseconds)


def from_time(time: Any) -> int:
    """Turn a ``builtin_interfaces/Time`` into nanoseconds.

    Raises
    ------
    MessageError
        If there are more nanoseconds than a second has.
    """
    nanoseconds = int(time.nanosec)
    if nanoseconds >= SECOND:
        raise MessageError(f'a stamp with {nanoseconds} ns; expected less than {SECOND}')
    return int(time.sec) * SECOND + nanoseconds


def header(stamp: int, frame: str) -> Header:
    """Make a header of a stamp (ns) and a frame."""
    return Header(to_time(stamp), frame)


def stamp_of(message: Any) -> int:
    """Read ``header.stamp`` of a message, in nanoseconds."""
    return from_time(message.header.stamp)


ENCAPSULATION = 4
"""Number of CDR bytes ahead of the message; the second one gives the byte order."""

_TIMES = {0: struct.Struct('>iI'), 1: struct.Struct('<iI')}


def stamp_in(data: bytes, offset: int = ENCAPSULATION) -> int | None:
    """Read the stamp (ns) at an offset in CDR; None if the bytes are too few or not CDR."""
    try:
        seconds, nanoseconds = _TIMES[data[1]].unpack_from(data, offset)
    except (struct.error, KeyError, IndexError):
        return None
    return int(seconds) * SECOND + int(nanoseconds)
