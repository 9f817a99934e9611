"""Gates of the estimation, run on measured readings, beside what the survey's editors rejected."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from studies.instruments.statistics import towing
from studies.instruments.survey import KEPT, Series
from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.windows.buffers import ChannelBuffer
from trawl_ros.estimation.windows.channel_means import (
    ChannelMean,
    channel_mean,
    excluded_readings,
)
from trawl_ros.estimation.windows.records import Rejections, WindowOptions
from trawl_ros.estimation.windows.timestamp_check import TimestampCheck
from trawl_ros.estimation.windows.watermark import Watermark
from trawl_ros.records.channels import CHANNELS, Reading

WORST = 10
"""Readings of a haul on which gates and editors may differ without a row in the report."""

PERIOD_M = 100.0
"""Readings that are too long by more (m) are of another period of the ranging."""

MULTIPLE_WITHIN = 0.35
"""Readings are taken for a multiple of the distance up to this part of it above."""

RUN = 3
"""Readings in a row that make another level."""

CLASSES: Mapping[str, str] = {
    'second': 'one of two readings in a second, of which the editors rejected the other or none',
    'period': 'too long by more than 100 m: heard in the next period of the ranging',
    'multiple': 'two or three times the distance, and up to 0.35 of it more: there and back again',
    'level': 'three or more in a row off to the same side: another echo for a while, or the net '
    'rises or settles within the window',
    'long': 'too long, one or two in a row: a reflection',
    'short': 'too short, one or two in a row: something in between, or noise',
}
"""Classes of disagreements and their explanation; each reading has the first that fits."""


@dataclass(frozen=True)
class HaulDisagreement:
    """Disagreements of a haul: its number, readings, and class of `CLASSES` → readings."""

    number: int
    readings: int
    counts: Mapping[str, int]

    @property
    def total(self) -> int:
        """Readings on which gates and editors differ."""
        return sum(self.counts.values())

    @property
    def main(self) -> str:
        """Class of most of them."""
        return max(CLASSES, key=lambda kind: self.counts.get(kind, 0))


def classified(values: FloatArray, rejected: BoolArray) -> Counter[str]:
    """Count the rejected readings of a window by their class.

    Parameters
    ----------
    values
        All readings (n,) of the window, m, in the order of time.
    rejected
        Mask (n,) of those that the gates rejected and the editors kept.
    """
    counts = Counter[str]()
    if not rejected.any() or rejected.all():
        return counts
    level = float(np.median(values[~rejected]))
    side = np.where(rejected, np.sign(values - level), 0.0)
    ends = np.concatenate(([0], np.flatnonzero(np.diff(side) != 0.0) + 1, [len(side)]))
    for first, last in pairwise(ends):
        for value in values[first:last] if side[first] else ():
            counts[_class(float(value), level, int(last - first))] += 1
    return counts


def _class(value: float, level: float, run: int) -> str:
    if value - level > PERIOD_M:
        return 'period'
    over = value / level - 1.0
    if any(-0.1 < over - more < MULTIPLE_WITHIN for more in (1.0, 2.0)):
        return 'multiple'
    if run >= RUN:
        return 'level'
    return 'long' if value > level else 'short'


@dataclass(frozen=True)
class GateCounts:
    """Counts of one or more hauls.

    Attributes
    ----------
    readings, by_editors
        Readings, and those that the editors rejected.
    stamps, both
        Readings that the timestamp check rejected, and those of them that the editors did too.
    towed, off, off_kept
        Readings while towing, those that were rejected as false echoes or outliers, and those of
        them that the editors kept.
    windows, used
        Windows of a minute while towing, and those with a mean that can be used.
    """

    readings: int = 0
    by_editors: int = 0
    stamps: int = 0
    both: int = 0
    towed: int = 0
    off: int = 0
    off_kept: int = 0
    windows: int = 0
    used: int = 0

    def __add__(self, other: 'GateCounts') -> 'GateCounts':
        return GateCounts(*(getattr(self, f) + getattr(other, f) for f in self.__annotations__))

    def agreement(self, *, with_outliers: bool) -> float:
        """F1 of the gates' rejections beside the editors'; NaN where neither rejects any."""
        extra = self.off if with_outliers else 0
        both = self.both + (self.off - self.off_kept if with_outliers else 0)
        total = self.stamps + extra + self.by_editors
        return 2.0 * both / total if total else np.nan


@dataclass(frozen=True)
class GateFindings:
    """Findings of the gates on a haul: counts, reason → windows that have no mean for it, and
    class of `CLASSES` → readings on which gates and editors differ.
    """

    counts: GateCounts
    reasons: Mapping[str, int]
    differing: Mapping[str, int]


def gate(series: Series, channel: str, stated: float) -> GateFindings:
    """Run the gates on a haul.

    Parameters
    ----------
    series
        All readings, in the order of time; within a second as they came.
    channel
        The channel of the table whose limits hold.
    stated
        Stated noise of the sensor, m.

    Returns
    -------
    GateFindings
        Counts, by reason and by class.
    """
    options, rejections = WindowOptions(), Rejections()
    of = CHANNELS[channel]
    check = TimestampCheck(of, options, Watermark(), rejections)
    buffer = ChannelBuffer(of, check, rejections)
    begin, end = towing(series.kept())
    span = round(options.window_s * SECOND)
    next_end = round(begin) * SECOND + span
    stamps = both = off = off_kept = towed = windows = used = 0
    reasons, differing = Counter[str](), Counter[str]()
    # Of the readings that are in the buffer, by their stamps: none has a stamp twice.
    code_at: dict[int, int] = {}
    for time, value, code in zip(series.time, series.value, series.code, strict=True):
        stamp = round(time) * SECOND
        while stamp >= next_end and next_end <= end * SECOND:
            windows += 1
            mean = channel_mean(buffer, next_end - span, next_end, options)
            if isinstance(mean, ChannelMean):
                used += 1
            else:
                reasons[mean.reason] += 1
            at, values, stds = buffer.window(next_end - span, next_end)
            if len(values):
                echoes, wild = excluded_readings(values, float(np.median(stds)), of, options)
                wild |= echoes
                kept = wild & np.array([code_at[int(k)] == KEPT for k in at])
                towed, off = towed + len(values), off + int(np.count_nonzero(wild))
                off_kept += int(np.count_nonzero(kept))
                differing += classified(values, kept)
            next_end += span
        before = rejections.counts['duplicate stamp']
        buffer.add(Reading(channel, stamp, float(value), stated))
        if rejections.counts['duplicate stamp'] > before:
            stamps += 1
            both += int(code) != KEPT
        else:
            code_at[stamp] = int(code)
    counts = GateCounts(
        readings=len(series.time),
        by_editors=int(np.count_nonzero(series.code != KEPT)),
        stamps=stamps,
        both=both,
        towed=towed,
        off=off,
        off_kept=off_kept,
        windows=windows,
        used=used,
    )
    differing['second'] = counts.stamps + counts.by_editors - 2 * counts.both
    return GateFindings(counts, reasons, differing)
