# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reading of a log for a comparison: all steady minutes, and the course of every channel."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

import numpy as np

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.tows import FoundWindows
from trawl_ros.estimation.windows.finder import SteadyWindowFinder
from trawl_ros.estimation.windows.records import SteadyWindow, WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.water import build_water
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED, READ_TOPICS, Reading, readings
from trawl_ros.records.samples import Sample

MINUTE_NS = 60 * SECOND
PROGRESS_EVERY = 500
"""Samples between two calls that tell of progress."""

ALL_MINUTES = WindowOptions(max_windows_per_state=1_000_000)
"""Options that keep every steady minute of a long state."""


@dataclass(frozen=True)
class Course:
    """Course of a log: medians of each minute.

    Attributes
    ----------
    start_ns
        Start of the first minute.
    values
        Channel → medians (n,) in SI, NaN in a minute without a reading.
    scatter
        Channel → standard error (n,) of these.
    """

    start_ns: int
    values: Mapping[str, FloatArray]
    scatter: Mapping[str, FloatArray]

    @property
    def minutes(self) -> int:
        """Number of minutes."""
        return len(next(iter(self.values.values()), np.zeros(0)))

    def rate(self, channel: str, end_ns: int, minutes: int = 4) -> float:
        """Return the rate of change (SI per s) of a channel over some minutes up to a time."""
        last = (end_ns - self.start_ns) // MINUTE_NS
        own = self.values[channel][max(0, last - minutes) : last]
        read = np.flatnonzero(np.isfinite(own))
        if len(read) < 2:
            return 0.0
        return float(np.polyfit(read, own[read], 1)[0]) / 60.0


@dataclass(frozen=True)
class ReadLog:
    """Log that was read: its steady windows, minute by minute, and the course of its channels."""

    found: FoundWindows
    course: Course


def read_log(
    path: Path, gear: GearRecord, namespace: str, on_progress: OnProgress = ignore
) -> ReadLog:
    """Read a bag once, for its steady minutes and the course of its channels.

    Parameters
    ----------
    path, namespace
        The bag and the namespace of its topics.
    gear
        Gear whose water turns pressures into depths.
    on_progress
        Called with the time that is read, s.

    Raises
    ------
    BagError
        If the bag cannot be read.
    """
    depth = build_water(gear).depth
    finder, minutes = SteadyWindowFinder(depth, ALL_MINUTES, required=INPUTS), _Minutes(depth)
    stream = SampleStream([path], namespace, topics=READ_TOPICS)
    decided = []
    for number, (_, sample) in enumerate(stream):
        decided += finder.feed(sample)
        minutes.add(sample)
        if number % PROGRESS_EVERY == 0:
            on_progress(WorkProgress('reading', minutes.seconds, None, 's', path.name))
    decided += finder.finish()
    windows = _joined(item for item in decided if isinstance(item, SteadyWindow))
    found = FoundWindows(
        name=path.name,
        windows=windows,
        arrived=finder.arrived,
        readings=finder.readings,
        rejections=finder.rejections,
        why_not=None if windows else _why_not(finder),
        problems=tuple(stream.problems),
    )
    return ReadLog(found, minutes.course())


def _joined(windows: Iterable[SteadyWindow]) -> tuple[SteadyWindow, ...]:
    """Number states again, so that a state goes on after a gust if warps and speed are the same.

    The finder begins another one then. Errors that belong to a state would count as independent.
    """
    joined: list[SteadyWindow] = []
    tolerance = dict.fromkeys(INPUTS, ALL_MINUTES.length_tolerance)
    tolerance['speed'] = ALL_MINUTES.speed_tolerance
    state, first = -1, None
    for window in windows:
        if first is None or any(
            abs(window.means[name] - first.means[name]) > most for name, most in tolerance.items()
        ):
            state, first = state + 1, window
        joined.append(replace(window, state=state))
    return tuple(joined)


def _why_not(finder: SteadyWindowFinder) -> str:
    """Return the reason in a sentence why a log has no steady state."""
    lacking = dict.fromkeys(CHANNELS[name].topic for name in INPUTS if not finder.readings[name])
    if lacking:
        return (
            f'no usable readings on {", ".join(lacking)}, expected warp lengths and speed; '
            '`trawl bag check` says what is wrong with them'
        )
    counts = ', '.join(f'{reason} {count}' for reason, count in finder.rejected.items())
    return (
        'no steady state: expected warp lengths, speed and heading held for up to '
        f'{finder.settle_s:.0f} s and then for {ALL_MINUTES.window_s:g} s of steady readings '
        f'(rejected: {counts or "none"})'
    )


class _Minutes:
    """Readings by channel and minute, without those that cannot be."""

    def __init__(self, pressure_to_depth: Callable[[float], float]) -> None:
        self._depth = pressure_to_depth
        self._readings: dict[str, dict[int, list[float]]] = {
            name: {} for name in (*MEASURED, *INPUTS)
        }

    @property
    def seconds(self) -> float:
        """Duration of what was read."""
        return 60.0 * len(self._readings[INPUTS[0]])

    def add(self, sample: Sample) -> None:
        for reading in readings(sample, self._depth):
            if reading.channel in self._readings and _possible(reading):
                of_channel = self._readings[reading.channel]
                of_channel.setdefault(reading.stamp // MINUTE_NS, []).append(reading.value)

    def course(self) -> Course:
        times = [minute for one in self._readings.values() for minute in one]
        first, last = min(times, default=0), max(times, default=-1)
        values: dict[str, FloatArray] = {}
        scatter: dict[str, FloatArray] = {}
        for name, by_minute in self._readings.items():
            if by_minute:
                values[name], scatter[name] = np.full((2, last - first + 1), np.nan)
                for minute, own in by_minute.items():
                    values[name][minute - first] = median(own)
                    error = max(float(np.std(own)), CHANNELS[name].noise) / np.sqrt(len(own))
                    scatter[name][minute - first] = error
        return Course(first * MINUTE_NS, values, scatter)


def _possible(reading: Reading) -> bool:
    channel = CHANNELS[reading.channel]
    low, high = max(channel.low, reading.low), min(channel.high, reading.high)
    return low <= reading.value <= high


def hours_of(log: ReadLog) -> Iterator[float]:
    """Yield the hours from the start of a log to the middle of each of its windows."""
    for window in log.found.windows:
        middle = 0.5 * (window.start_ns + window.end_ns)
        yield (middle - log.course.start_ns) / (3600 * SECOND)
