# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Flow control: consumers report their progress, and sources wait for the slowest.

An acknowledged message is not a processed one: DDS says that the bytes have arrived, not that
the subscriber has come to them. A source that runs as fast as it can would fill queues until
they overflow, so each consumer gives back, on ``sync/progress``, the stamp of the latest
message that it has fully dealt with.
"""

import math
import time
from collections import defaultdict
from collections.abc import Callable, MutableMapping, Sequence
from dataclasses import dataclass
from typing import Any

from trawl_ros.core.errors import MessageError
from trawl_ros.core.limits import CONSUMERS
from trawl_ros.core.time import SECOND
from trawl_ros.messages.stamps import from_time, header
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import STREAM
from trawl_ros.records.topics import SYNC

LARGEST_DELAY_S = 1.0
"""Wall time that is made up for; what is beyond it is lost, so that no rush follows a pause."""


class Pacer:
    """Pacer of data time against wall time.

    Parameters
    ----------
    factor
        Data seconds per wall second; 0 sets no pace.
    clock
        Gives wall time in s.

    Attributes
    ----------
    lost_s : float
        Wall time (s) by which data fell behind for good.
    """

    def __init__(self, factor: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._factor = factor
        self._origin: tuple[float, float] | None = None
        self.lost_s = 0.0

    @property
    def factor(self) -> float:
        """Data seconds per wall second; 0 sets no pace."""
        return self._factor

    def change(self, factor: float) -> None:
        """Change the factor, from the present data time on."""
        self._factor = factor
        self._origin = None

    def restart(self) -> None:
        """Take the next data time as the present."""
        self._origin = None

    def due(self, data_s: float) -> bool:
        """True if data of this time (s) may be published."""
        if self._factor == 0.0:
            return True
        now = self._clock()
        if self._origin is None:
            self._origin = (now, data_s)
        wall, data = self._origin
        late = now - wall - (data_s - data) / self._factor
        if late > LARGEST_DELAY_S:
            self.lost_s += late
            self._origin = (now, data_s)
        return late >= 0.0


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
"""A consumer that has kept the source waiting for this long is not waited for; a look at a window
takes less.
"""

LEAST_RATE = 0.05
"""Progress (s of data per s of wall time) below which waiting adds up to `STALLED_S`: a stamp that
creeps on would otherwise stop the source for good."""

WAITING_S = 30.0
"""A source that waits for this long for a consumer says so."""


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
        started again, for the source.
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
        """Register that all up to this stamp (ns) is dealt with; an earlier one starts again."""
        self._done = stamp
        self._heard_at = time.monotonic()
        self._node.real_time_factor.reached(stamp)
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


@dataclass
class _Wait:
    """Wall time (s) for which a consumer has kept the source waiting, less its progress."""

    spent: float = 0.0
    since: float | None = None

    def begin(self, now: float) -> None:
        if self.since is None:
            self.since = now

    def end(self, now: float) -> None:
        # One second more than it takes to stall, so that it takes some progress to count again.
        self.spent, self.since = min(self.total(now), STALLED_S + 1.0), None

    def total(self, now: float) -> float:
        return self.spent + (0.0 if self.since is None else now - self.since)

    def progress(self, data_s: float, now: float) -> None:
        self.end(now)
        self.spent = max(0.0, self.spent - data_s / LEAST_RATE)


class Consumers:
    """Consumers of a source, and their progress.

    Those it needs count from the beginning on. Others count once they have dealt with anything
    of it: what was published before they were there will never reach them, so to wait for
    them would be to wait for ever. The same holds for one that was started again; and one that
    is not heard for `SILENT_S`, or has kept the source waiting for `STALLED_S` beyond what its
    progress is worth at `LEAST_RATE`, does not count, needed or not, until it is heard or gets on
    again.

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
        self._waits: dict[str, _Wait] = defaultdict(_Wait)
        self._busy: set[str] = set()
        self._span = (0, 0)
        self._subscribers: dict[str, tuple[int, int]] = {}
        self._changed = time.monotonic()
        self._ready = False
        node.listen(SYNC, self._take, STREAM, HEADER)

    def ready(self) -> bool:
        """True if all have been there, and discovery has finished; once true it stays so."""
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
        return self._kept_waiting(STALLED_S)

    def waited_for(self) -> list[str]:
        """Names of consumers that the source waits for, and has for some time."""
        stalled = self.stalled()
        return [name for name in self._kept_waiting(WAITING_S) if name not in stalled]

    def _kept_waiting(self, least_s: float) -> list[str]:
        now = time.monotonic()
        return [
            name
            for name, wait in self._waits.items()
            if self._present(name) and wait.total(now) > least_s
        ]

    def begin(self, stamp: int) -> None:
        """Begin data time again at a stamp (ns): earlier reports do not count."""
        self._stamps = dict.fromkeys(self._names, stamp)
        self._waits.clear()
        self._span = (stamp, stamp)

    def sent(self, stamp: int) -> None:
        """Register the newest stamp that was published."""
        self._span = (self._span[0], stamp)
        self._node.real_time_factor.reached(stamp)

    def followed(self, stamp: int) -> bool:
        """True if all that count have come to a stamp (ns); asked when the source could go on."""
        now = time.monotonic()
        slowest = self.slowest()
        followed = slowest is None or slowest >= stamp
        for name, done in self._stamps.items():
            if not followed and done < stamp:
                self._waits[name].begin(now)
            elif name in self._waits:
                self._waits[name].end(now)
        return followed

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
        if name not in self._heard and name not in self._names:
            self._make_room()
        self._heard[name] = time.monotonic()
        (self._busy.add if busy else self._busy.discard)(name)
        first, latest = self._span
        # Progress outside of what was published since the beginning is from before it, and what
        # was dealt with once stays so.
        before = self._stamps.get(name, first)
        if first < stamp <= latest and stamp > before:
            self._stamps[name] = stamp
            if name in self._waits:
                self._waits[name].progress((stamp - before) / SECOND, time.monotonic())
        elif stamp == NOTHING and before > first:
            del self._stamps[name]
            self._waits.pop(name, None)

    def _make_room(self) -> None:
        """Forget the silent, and names of no node, where one more would be too many.

        Raises
        ------
        MessageError
            If there are too many even so.
        """
        if len(self._heard) < CONSUMERS.value:
            return
        nodes = {*self._node.get_node_names(), *self._names}
        for name in [one for one in self._heard if one not in nodes or not self._present(one)]:
            tables: tuple[MutableMapping[str, Any], ...] = self._heard, self._stamps, self._waits
            for table in tables:
                table.pop(name, None)
            self._busy.discard(name)
        if len(self._heard) >= CONSUMERS.value:
            raise MessageError(f'{SYNC}: one consumer more; expected at most {CONSUMERS}')
