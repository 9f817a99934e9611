"""Flow control: consumers report their progress, and sources wait for the slowest.

An acknowledged message is not a processed one: DDS says that the bytes have arrived, not that
the subscriber has come to them. A source that runs as fast as it can would fill queues until
they overflow, so each consumer gives back, on ``sync/progress``, the stamp of the latest
message that it has fully dealt with.
"""

import math
import time
from collections.abc import Callable, Sequence
from typing import Any

from trawl_ros.core.errors import MessageError
from trawl_ros.core.limits import CONSUMERS
from trawl_ros.core.time import SECOND
from trawl_ros.messages.stamps import from_time, header
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import STREAM
from trawl_ros.records.topics import SYNC

HEADER = 'std_msgs/msg/Header'
INTERVAL_NS = SECOND // 2
"""Data time between two reports of progress."""

HEARTBEAT_S = 0.5
SETTLED_S = 1.0
"""Discovery is taken to be over when nobody was added for this long."""

IDLE_S = 2 * HEARTBEAT_S
"""Silence after which a consumer has nothing left to deal with."""

BUSY = 'busy'
"""Word behind the name of a consumer that has not dealt with all that it was given yet."""

NOTHING = 0
"""Stamp that a consumer reports before it has dealt with anything."""

SILENT_S = 10.0
"""A consumer not heard for this long has gone."""

STALLED_S = 120.0
"""A consumer that does not get on for this long is not waited for; a look at a window takes less.
"""


def consumer_of(message: Any) -> tuple[str, bool]:
    """Name of the consumer that reports its progress, and whether it is busy."""
    name = message.frame_id.removesuffix(f' {BUSY}')
    return name, name != message.frame_id


class ConsumerProgress:
    """Progress of a consumer: reported now and then, at least every `HEARTBEAT_S` of wall time.

    Parameters
    ----------
    node
        The consumer.
    ready
        True if the node may announce itself; a source that waits for it starts then.
    idle
        For one that deals with what other consumers of the source give out, which may fall
        silent: whether nothing is left to deal with. Having heard nothing for a while it is then
        as far as the clock. Otherwise the source would wait for it, it for them, and they,
        started anew, for the source.
    busy
        True if it has not dealt with all that it was given yet: it is waited for then, and not
        taken for one that the rest does not concern.
    """

    def __init__(
        self,
        node: TrawlNode,
        ready: Callable[[], bool] = lambda: True,
        *,
        idle: Callable[[], bool] = lambda: False,
        busy: Callable[[], bool] = lambda: False,
    ) -> None:
        self._node = node
        self._ready = ready
        self._idle = idle
        self._busy = busy
        self._heard_at = time.monotonic()
        self._done = NOTHING
        self._reported = NOTHING
        node.advertise(SYNC, HEADER)
        node.every(HEARTBEAT_S, self._beat)

    @property
    def stamp(self) -> int:
        """Stamp of the latest message that was dealt with, ns; 0 before the first."""
        return self._done

    def done(self, stamp: int) -> None:
        """Register that all up to this stamp (ns) is dealt with; an earlier one starts anew."""
        self._done = stamp
        self._heard_at = time.monotonic()
        self._node.headway.reached(stamp)
        if not 0 <= stamp - self._reported < INTERVAL_NS:
            self._report()

    def _beat(self) -> None:
        if not self._ready():
            return
        quiet = time.monotonic() - self._heard_at > IDLE_S
        if quiet and self._done != NOTHING and self._idle():
            self._done = max(self._done, self._node.now())
        self._report()

    def _report(self) -> None:
        self._reported = self._done
        name = self._node.get_name() + f' {BUSY}' * self._busy()
        message = header(self._done, name)
        self._node.send(SYNC, message)


class Consumers:
    """Consumers of a source, and their progress.

    Those it needs count from the beginning on. Others count once they have dealt with anything
    of it: what was published before they were there will never reach them, so to wait for
    them would be to wait for ever. The same holds for one that was started anew; and one that
    is not heard for `SILENT_S`, or has kept the source waiting for `STALLED_S` without getting on,
    does not count, needed or not, until it is heard or gets on again.

    Parameters
    ----------
    node
        The source.
    names
        Consumers (names of nodes) without which it does not start. Others that report join in.
    """

    def __init__(self, node: TrawlNode, names: Sequence[str]) -> None:
        self._node = node
        self._names = tuple(names)
        self._stamps: dict[str, int] = {}
        self._heard: dict[str, float] = {}
        self._waited_for: dict[str, float] = {}
        self._busy: set[str] = set()
        self._span = (0, 0)
        self._subscribers: dict[str, tuple[int, int]] = {}
        self._changed = time.monotonic()
        self._ready = False
        node.listen(SYNC, self._take, STREAM, HEADER)

    def ready(self) -> bool:
        """True if all have been there, and discovery has come to rest; once true it stays so."""
        subscribers = self._node.subscribers()
        if subscribers != self._subscribers:
            self._subscribers, self._changed = subscribers, time.monotonic()
        settled = time.monotonic() - self._changed > SETTLED_S
        self._ready = self._ready or (settled and not self.missing())
        return self._ready

    def missing(self) -> list[str]:
        """Names of the required consumers that have not been heard, or not for long."""
        return [name for name in self._names if not self._present(name)]

    def stalled(self) -> list[str]:
        """Names of consumers that make no progress and are not waited for any more."""
        now = time.monotonic()
        return [
            name
            for name, since in self._waited_for.items()
            if self._present(name) and now - since > STALLED_S
        ]

    def begin(self, stamp: int) -> None:
        """Begin data time (anew) at a stamp (ns): earlier reports do not count."""
        self._stamps = dict.fromkeys(self._names, stamp)
        self._waited_for = {}
        self._span = (stamp, stamp)

    def sent(self, stamp: int) -> None:
        """Register the newest stamp that was published."""
        self._span = (self._span[0], stamp)
        self._node.headway.reached(stamp)

    def followed(self, stamp: int) -> bool:
        """True if all that count have come to a stamp (ns); asked when the source could go on."""
        slowest = self.slowest()
        if slowest is None or slowest >= stamp:
            return True
        for name, done in self._stamps.items():
            if done < stamp:
                self._waited_for.setdefault(name, time.monotonic())
        return False

    def slowest(self) -> int | None:
        """Return the stamp (ns) that all have reached; None where nobody counts."""
        stalled = self.stalled()
        counting = (
            stamp
            for name, stamp in self._stamps.items()
            if self._present(name) and name not in stalled
        )
        return min(counting, default=None)

    def busy(self) -> bool:
        """True if one that counts has not dealt with all that it was given yet."""
        return any(name in self._stamps and self._present(name) for name in self._busy)

    def _present(self, name: str) -> bool:
        return time.monotonic() - self._heard.get(name, -math.inf) < SILENT_S

    def _take(self, message: Any) -> None:
        name, busy = consumer_of(message)
        stamp = from_time(message.stamp)
        if name == self._node.get_name():
            return
        if name not in self._heard and len(self._heard) >= CONSUMERS.value:
            raise MessageError(f'{SYNC}: one consumer more; expected at most {CONSUMERS}')
        self._heard[name] = time.monotonic()
        (self._busy.add if busy else self._busy.discard)(name)
        first, latest = self._span
        # Progress outside of what was published since the beginning is from before it, and what
        # was dealt with once stays so.
        if first < stamp <= latest and stamp > self._stamps.get(name, first):
            self._stamps[name] = stamp
            self._waited_for.pop(name, None)
        elif stamp == NOTHING and self._stamps.get(name, first) > first:
            del self._stamps[name]
            self._waited_for.pop(name, None)
