# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Buffers of readings that wait for their window: checked, sorted by stamp, bounded in memory."""

import math
from bisect import bisect_left

import numpy as np

from trawl_ros.core.arrays import FloatArray, StampArray
from trawl_ros.estimation.windows.records import Rejections, WindowOptions
from trawl_ros.estimation.windows.timestamp_check import TimestampCheck
from trawl_ros.estimation.windows.watermark import NANO, Watermark
from trawl_ros.records.channels import CHANNELS, Channel, Reading

CAPACITY = 50_000
"""Readings usually kept per channel at most: a minute at more than 500 Hz."""


class ChannelBuffer:
    """Buffer of one channel's readings, in order of their stamps.

    Parameters
    ----------
    channel
        The channel's row of the table.
    order
        Judge of the stamps.
    rejections
        Counts of refused readings by reason.
    capacity
        Readings that are kept.

    Attributes
    ----------
    first
        Oldest stamp (ns) accepted, None before any.
    delay
        By how much (ns) a window's readings of this channel lie before the window.
    """

    def __init__(
        self,
        channel: Channel,
        order: TimestampCheck,
        rejections: Rejections,
        capacity: int = CAPACITY,
    ) -> None:
        self._capacity = capacity
        self.channel = channel
        self.order = order
        self.first: int | None = None
        self.delay = round(channel.delay * NANO)
        self._decided: int | None = None
        self._rejections = rejections
        self._where = f'{channel.name} ({channel.topic})'
        self._stamps: list[int] = []
        self._values: list[float] = []
        self._stds: list[float] = []
        self._outside: list[tuple[int, float]] = []

    @property
    def newest(self) -> int | None:
        """Newest accepted stamp (ns), None before any."""
        return self.order.newest

    def add(self, reading: Reading) -> int:
        """Add a reading; return how many were accepted with it, for some wait for others.

        Each one refused is counted by its reason.
        """
        # Stamps first: a sensor that says nonsense in time is not silent.
        count = 0
        for accepted in self.order.judge(reading):
            count += self._plausible(accepted) and self._insert(accepted)
        return count

    def _plausible(self, reading: Reading) -> bool:
        value, channel = reading.value, self.channel
        if channel.low <= value <= channel.high and reading.low <= value <= reading.high:
            return True
        if not math.isfinite(reading.value):
            self._rejections.add('not finite', f'{self._where} reads {reading.value}')
            return False
        low = max(self.channel.low, reading.low if math.isfinite(reading.low) else -math.inf)
        high = min(self.channel.high, reading.high if math.isfinite(reading.high) else math.inf)
        if not low <= reading.value <= high:
            expected = f'expected {low:g} to {high:g} {self.channel.unit}'
            sentence = f'{self._where} reads {reading.value:g} {self.channel.unit}, {expected}'
            self._rejections.add('out of range', sentence)
            self._outside.append((reading.stamp, reading.value))
            del self._outside[: -self._capacity]
            return False
        return True

    def _insert(self, reading: Reading) -> bool:
        stamp, stamps = reading.stamp, self._stamps
        newest = not stamps or stamp > stamps[-1]
        place = len(stamps) if newest else bisect_left(stamps, stamp)
        if not newest and stamps[place] == stamp:
            self._rejections.add('duplicate stamp', f'{self._where} has a stamp twice')
            return False
        if self._decided is not None and stamp < self._decided:
            late = (self._decided - stamp) / NANO
            self._rejections.add('late', f'{self._where} came {late:.1f} s too late for its window')
            return False
        stamps.insert(place, stamp)
        self._values.insert(place, reading.value)
        self._stds.insert(
            place, reading.std if 0.0 < reading.std < math.inf else self.channel.noise
        )
        if self.first is None or stamp < self.first:
            self.first = stamp
        if len(stamps) > self._capacity:
            self._drop_before(self._stamps[self._capacity // 10])
        return True

    def window(self, start_ns: int, end_ns: int) -> tuple[StampArray, FloatArray, FloatArray]:
        """Stamps (n,) in ns, values (n,) and stated std (n,) for a window's start and end (ns)."""
        first = bisect_left(self._stamps, start_ns - self.delay)
        last = bisect_left(self._stamps, end_ns - self.delay)
        return (
            np.array(self._stamps[first:last], dtype=np.int64),
            np.array(self._values[first:last]),
            np.array(self._stds[first:last]),
        )

    def all_readings(self) -> tuple[StampArray, FloatArray, FloatArray]:
        """Stamps (n,) in ns, values (n,) and stated std (n,) of all that are kept."""
        return (
            np.array(self._stamps, dtype=np.int64),
            np.array(self._values),
            np.array(self._stds),
        )

    def heard(self, end_ns: int) -> bool:
        """True if the channel had reported before a window's end (ns).

        By stamps, not by what has arrived: the verdict must not depend on arrival.
        """
        return self.first is not None and self.first < end_ns - self.delay

    def outside(self, start_ns: int, end_ns: int) -> FloatArray:
        """Values (n,) that a window would have if they were not out of range."""
        start_ns, end_ns = start_ns - self.delay, end_ns - self.delay
        return np.array([value for stamp, value in self._outside if start_ns <= stamp < end_ns])

    def decide(self, end_ns: int, needed_ns: int) -> None:
        """Note that windows are decided up to ``end_ns``; none will begin before ``needed_ns``."""
        self._decided = end_ns - self.delay
        self._drop_before(needed_ns - self.delay)

    def _drop_before(self, stamp_ns: int) -> None:
        first = bisect_left(self._stamps, stamp_ns)
        del self._stamps[:first], self._values[:first], self._stds[:first]
        if self._outside:
            self._outside = [row for row in self._outside if row[0] >= stamp_ns]


def channel_buffers(
    options: WindowOptions,
    winch_watermark: Watermark,
    rejections: Rejections,
    capacity: int = CAPACITY,
) -> dict[str, ChannelBuffer]:
    """Return a buffer for each channel; all count what they refuse together."""
    return {
        name: ChannelBuffer(
            channel,
            TimestampCheck(channel, options, winch_watermark, rejections),
            rejections,
            capacity,
        )
        for name, channel in CHANNELS.items()
    }
