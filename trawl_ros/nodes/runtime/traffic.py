# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Statistics of a node: counts, rates and ages of messages by topic, and its real-time factor."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from trawl_ros.core.time import SECOND


class RealTimeFactor:
    """Rate of the stamps that a node publishes or has used, against wall time.

    Parameters
    ----------
    clock
        Gives wall time in s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._latest: int | None = None
        self._gone = 0
        self._reported_at = clock()

    def reached(self, stamp: int) -> None:
        """Register a stamp (ns). One earlier than the last begins a new run and counts nothing."""
        if self._latest is not None:
            self._gone += max(0, stamp - self._latest)
        self._latest = stamp

    def report(self) -> dict[str, str]:
        """Return key and value for diagnostics, with the factor since the last report.

        Nothing where no stamp was ever reached: such a node is not driven by stamps.
        """
        if self._latest is None:
            return {}
        now = self._clock()
        factor = self._gone / SECOND / max(now - self._reported_at, 1e-9)
        self._gone, self._reported_at = 0, now
        return {'data time': f'{self._latest / SECOND:.1f}', 'real-time factor': f'{factor:.2f}'}


@dataclass
class _Count:
    total: int = 0
    latest: float = field(default_factory=time.monotonic)
    reported: int = 0
    reported_at: float = field(default_factory=time.monotonic)


class Traffic:
    """Counter of messages by direction ('published', 'received', ...) and full topic name.

    Counting is all that happens per message; rates and ages follow when they are asked for.
    """

    def __init__(self) -> None:
        self._counts: dict[tuple[str, str], _Count] = {}
        self._lost: dict[str, int] = {}

    def expect(self, direction: str, topic: str) -> None:
        """Register a topic before its first message."""
        self._counts.setdefault((direction, topic), _Count())

    def count(self, direction: str, topic: str) -> None:
        """Count one message."""
        entry = self._counts.setdefault((direction, topic), _Count())
        entry.total += 1
        entry.latest = time.monotonic()

    def lost(self, topic: str, total: int) -> None:
        """Register the total number of a topic's messages that were lost on the way."""
        if total:
            self._lost[topic] = total

    def counts(self, direction: str) -> dict[str, int]:
        """Return the number of messages by full topic name."""
        return {topic: entry.total for (way, topic), entry in self._entries() if way == direction}

    def total(self, direction: str) -> int:
        """Return the number of messages of all topics."""
        return sum(entry.total for (way, _), entry in self._entries() if way == direction)

    def _entries(self) -> list[tuple[tuple[str, str], _Count]]:
        # Of one instant, since threads count meanwhile.
        return list(self._counts.items())

    @property
    def dropped(self) -> int:
        """Number of messages that were lost on the way to this node."""
        return sum(self._lost.values())

    def report(self) -> dict[str, str]:
        """Return key and value for diagnostics: counts, rates since the last report, ages."""
        now = time.monotonic()
        values = {
            'published': str(self.total('published')),
            'received': str(self.total('received')),
            'refused': str(self.total('refused')),
            'dropped': str(self.dropped),
        }
        for topic, total in self._lost.items():
            values[f'dropped {topic}'] = str(total)
        for (direction, topic), entry in self._entries():
            values[f'{direction} {topic}'] = str(entry.total)
            span = now - entry.reported_at
            if span > 0.0:
                values[f'rate {direction} {topic}'] = f'{(entry.total - entry.reported) / span:.2f}'
            if entry.total:
                values[f'age {direction} {topic}'] = f'{now - entry.latest:.2f}'
            entry.reported, entry.reported_at = entry.total, now
        return values
