"""Readings waiting for their window: screened, sorted by stamp, bounded in memory."""

import math
from bisect import bisect_left
from collections import Counter

import numpy as np

from trawl_ros.identification.channels import Channel, Reading

CAPACITY = 50_000
"""Readings kept per channel at most, whatever the stamps say: a minute at more than 500 Hz."""


class ChannelBuffer:
    """The readings of one channel, in order of their stamps.

    Parameters
    ----------
    channel
        The channel's row of the table.
    reorder_ns
        Lateness (ns) up to which a reading is sorted in.
    rejected
        Where refused readings are counted by reason.

    Attributes
    ----------
    first, newest
        Oldest and newest stamp (ns) accepted, None before any.
    decided
        Stamp (ns) up to which windows are decided: nothing older is taken any more.
    """

    def __init__(self, channel: Channel, reorder_ns: int, rejected: Counter[str]) -> None:
        self.channel = channel
        self.first: int | None = None
        self.newest: int | None = None
        self.decided: int | None = None
        self._reorder_ns = reorder_ns
        self._rejected = rejected
        self._stamps: list[int] = []
        self._values: list[float] = []
        self._stds: list[float] = []

    def add(self, reading: Reading) -> bool:
        """Take a reading, or count the reason why not and return False."""
        reason = self._refusal(reading)
        if reason is not None:
            self._rejected[reason] += 1
            return False
        place = bisect_left(self._stamps, reading.stamp)
        if place < len(self._stamps) and self._stamps[place] == reading.stamp:
            self._rejected['out of order'] += 1
            return False
        self._stamps.insert(place, reading.stamp)
        self._values.insert(place, reading.value)
        stated = reading.std if math.isfinite(reading.std) and reading.std > 0.0 else 0.0
        self._stds.insert(place, stated or self.channel.noise)
        self.first = reading.stamp if self.first is None else min(self.first, reading.stamp)
        self.newest = reading.stamp if self.newest is None else max(self.newest, reading.stamp)
        if len(self._stamps) > CAPACITY:
            self.drop_before(self._stamps[CAPACITY // 10])
        return True

    def _refusal(self, reading: Reading) -> str | None:
        if not math.isfinite(reading.value):
            return 'not finite'
        low = max(self.channel.low, reading.low if math.isfinite(reading.low) else -math.inf)
        high = min(self.channel.high, reading.high if math.isfinite(reading.high) else math.inf)
        if not low <= reading.value <= high:
            return 'out of range'
        late = self.newest is not None and reading.stamp < self.newest - self._reorder_ns
        if late or (self.decided is not None and reading.stamp < self.decided):
            return 'out of order'
        return None

    def between(self, start_ns: int, end_ns: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Stamps (n,) in ns, values (n,) and stated std (n,) with start ≤ stamp < end."""
        first = bisect_left(self._stamps, start_ns)
        last = bisect_left(self._stamps, end_ns)
        return (
            np.array(self._stamps[first:last], dtype=np.int64),
            np.array(self._values[first:last]),
            np.array(self._stds[first:last]),
        )

    def drop_before(self, stamp_ns: int) -> None:
        """Forget what no later window can use."""
        first = bisect_left(self._stamps, stamp_ns)
        del self._stamps[:first], self._values[:first], self._stds[:first]
