# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Incoming messages: decoded in turns, and no error of a message or its handler ends a node."""

import inspect
import traceback
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from threading import RLock
from typing import Any

from trawl_ros.core.errors import MessageError, TrawlError
from trawl_ros.core.foreign import short
from trawl_ros.core.limits import IMAGE_BYTES, MESSAGE_BYTES, SCAN_BYTES, Limit
from trawl_ros.core.stamps import FAR_NS, Leaps
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import deserialize
from trawl_ros.messages.stamps import from_time, stamp_of
from trawl_ros.nodes.graph.source import Source
from trawl_ros.records.topics import CLOCK


class Turns:
    """Turns of a node's callbacks: one at a time, and none after the end.

    A multi-threaded executor may still hold callbacks of a node that is destroyed, and an
    application may set parameters from another thread.
    """

    def __init__(self) -> None:
        self._lock = RLock()
        self._over = False

    def __enter__(self) -> bool:
        """Wait for the turn; False once the node has ended."""
        self._lock.acquire()
        return not self._over

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def end(self) -> bool:
        """Wait for the callback under way, and refuse all others; True for the first call."""
        with self as first:
            self._over = True
        return first


def installed(type_name: str) -> bool:
    """True if the package of a type is installed."""
    try:
        message_class(type_name)
    except MessageError:
        return False
    return True


def message_class(type_name: str) -> Any:
    """Find the class of a type such as ``sensor_msgs/msg/JointState``.

    Raises
    ------
    MessageError
        If no installed package has it.
    """
    parts = type_name.split('/')
    if len(parts) == 3 and all(part.isidentifier() for part in parts):
        package, kind, name = parts
        try:
            return getattr(import_module(f'{package}.{kind}'), name)
        except (ImportError, AttributeError):
            pass
    raise MessageError(
        f'{type_name}: no installed package has this message type; expected one such as '
        'sensor_msgs/msg/JointState'
    )


FAR_CLOCK_NS = 10 * SECOND
"""Stamps of /clock further than this from the last may be false: it goes on in small steps."""

_LARGE: dict[str, Limit] = {
    'sensor_msgs/msg/Image': IMAGE_BYTES,
    'sensor_msgs/msg/PointCloud2': IMAGE_BYTES,
    'sensor_msgs/msg/LaserScan': SCAN_BYTES,
    'diagnostic_msgs/msg/DiagnosticArray': SCAN_BYTES,
    'visualization_msgs/msg/MarkerArray': SCAN_BYTES,
}


class Incoming:
    """Callback of a subscription that uses a message, or reports the reason why it does not.

    Parameters
    ----------
    topic
        For what is said.
    use
        Handler of a message.
    refuse
        Told why a message is not used.
    end
        Told why the node cannot go on: a `TrawlError` that is no `MessageError`.
    source
        Judge of who has sent a message; it counts what gets lost.
    single
        True if only what its source has sent is used.
    turns
        Of the node's callbacks.
    """

    # Asked for both arguments, rclpy gives the message's number along with it.
    __signature__ = inspect.signature(lambda message, info: None)

    def __init__(
        self,
        topic: str,
        use: Callable[[Any], None],
        refuse: Callable[[str], None],
        end: Callable[[str], None],
        source: Source,
        single: bool,
        turns: Turns,
    ) -> None:
        self._turns = turns
        self._topic = topic
        self._use = use
        self._refuse = refuse
        self._end = end
        self._source = source
        self._single = single

    def __call__(self, *arrived: Any) -> None:
        """Handle a message with the information that ROS has of it."""
        # rclpy's own executor hands over message and info, its events executor a pair of them.
        message, info = arrived if len(arrived) == 2 else arrived[0]
        with self._turns as mine:
            if mine:
                self._handle(message, info)

    def _handle(self, message: Any, info: Any) -> None:
        try:
            alien = not self._source.take(info.get('publication_sequence_number'))
            if alien and self._single:
                raise MessageError(
                    f'{self._topic} has several publishers; only the one that was heard first is '
                    'used, as long as it is heard'
                )
            self._use(message)
        except MessageError as reason:
            self._refuse(str(reason))
        except TrawlError as reason:
            self._end(str(reason))
        except Exception as reason:
            self._refuse(f'{self._topic}: {error_of_program(reason)}')


def size_limit(type_name: str) -> Limit:
    """Return the largest size of a message of a type, in bytes."""
    return _LARGE.get(type_name, MESSAGE_BYTES)


def decoding(topic: str, type_name: str, use: Callable[[Any], None]) -> Callable[[bytes], None]:
    """Make the decoder of messages of a bounded size; no error of ``use`` ends the node."""
    limit = size_limit(type_name)

    def take(data: bytes) -> None:
        if len(data) > limit.value:
            raise MessageError(f'{topic}: a message of {len(data)} bytes; expected at most {limit}')
        try:
            use(deserialize(data, type_name))
        except TrawlError as reason:
            raise MessageError(str(reason)) from reason

    return take


def settling(
    topic: str,
    use: Callable[[Any], None],
    refuse: Callable[[str], None],
    *,
    stamp_in: Callable[[Any], int] = stamp_of,
    far_ns: int = FAR_NS,
) -> Callable[[Any], None]:
    """Make the filter that passes a message once its stamp is confirmed."""
    leaps: Leaps[Any] = Leaps(far_ns)

    def take(message: Any) -> None:
        believed, false = leaps.take(stamp_in(message), message)
        for _ in false:
            refuse(f'{topic} is stamped far from its other messages, and only for a moment')
        for message_of_leap in believed:
            use(message_of_leap)

    return take


def believing_clock(
    use: Callable[[Any], None], refuse: Callable[[str], None]
) -> Callable[[Any], None]:
    """Make the filter that passes a message of /clock once it is confirmed."""

    def stamp_in(message: Any) -> int:
        stamp = from_time(message.clock)
        if stamp < 0:
            raise MessageError(f'{CLOCK.name}: {stamp / SECOND:g} s; expected 0 or later')
        return stamp

    return settling(CLOCK.name, use, refuse, stamp_in=stamp_in, far_ns=FAR_CLOCK_NS)


def error_of_program(reason: Exception) -> str:
    """Describe an unforeseen error and its place in a line."""
    frames = traceback.extract_tb(reason.__traceback__)
    own = [frame for frame in frames if 'trawl_ros' in Path(frame.filename).parts] or frames
    place = f' in {Path(own[-1].filename).name}, line {own[-1].lineno}' if own else ''
    return f'an error of the program{place}: {short(reason)}'
