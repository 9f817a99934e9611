"""Stamps: integer nanoseconds in the project, seconds and nanoseconds in messages."""

from typing import Any

from rosbags.typesys.stores.ros2_jazzy import builtin_interfaces__msg__Time as Time
from rosbags.typesys.stores.ros2_jazzy import std_msgs__msg__Header as Header

from trawl_ros.core.errors import MessageError
from trawl_ros.core.time import SECOND


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
