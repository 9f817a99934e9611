# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Detection of two sources on one topic, and of clocks that only look like two sources.

The channels or stamps of two sources differ, or their readings alternate. A clock that stands still
or was set back can look like two sources.

A publisher leaves no name in a bag. A topic has two sources if its readings do what one source
cannot do: alternate between two channels, give two readings for one time, go back in time
repeatedly, jump between two courses at every reading, or give readings on a second course in
addition to those that the rate asks for.
"""

from array import array
from collections.abc import Sequence
from statistics import median
from typing import NamedTuple

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, StampArray
from trawl_ros.core.stamps import CONFIRMING_READINGS, lasting, when
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import Sample
from trawl_ros.records.sensors import SENSORS

JUDGED_READINGS = 60
"""Number of readings that are judged together; rare oddities are faults and no second source."""

MIN_ALTERNATIONS = 3
"""Number of returns of a channel after another one from which on the channels alternate."""

MIN_ODD_SHARE = 0.25
"""Share of a block with stamps that one source does not give."""

MIN_STEP_RATIO = 2.0
"""Smallest ratio of the step to the next reading to the step to the one after that.

Waves have moved on after two steps.
"""

LONGEST_STEP = 1_500_000_000
"""Longest interval (ns) between readings that are judged by jumps.

Slower readings may alternate because the swell has twice their interval.
"""

ALTERNATING = 0.9
"""Share of the steps in a block that turn back."""

KEPT_READINGS = 4 * JUDGED_READINGS
"""Number of readings that are searched for those of a slower source."""

VISITS = 6
"""Number of readings on a second course that make it a source."""

SPREAD = 0.3
"""Largest relative deviation of what readings of one source have in common.

These are their distance from the other source's readings, and the time between them.
"""

FIRST_COURSE_QUANTILE = 0.9
"""Share of the readings on the first course that deviate by less than the second course does."""

ONE_PERIOD = 1.5
"""Largest ratio of the intervals around a reading of the second course to the other intervals.

A wrong reading replaces a right one, and so makes the interval twice as long.
"""


BACK_NS = 10 * SECOND
"""Stamps that go back by more than this (ns) are those of a clock that was set back."""

RECENT_READINGS = 2 * CONFIRMING_READINGS - 1
"""Number of readings whose median stamp is trusted."""

SETTLED_READINGS = 10
"""Number of readings after a step back that show a set clock and no false stamp."""


class Doubt(NamedTuple):
    """Reason not to use a topic: ``source`` or ``stamp``, and what was found and expected."""

    kind: str
    text: str


class SourceWatch:
    """Detector of a second source, or of a clock that stands still, in the readings of a topic."""

    def __init__(self) -> None:
        # Numbers side by side, for there are as many of these as messages.
        self._channels, self._stamps, self._values = array('q'), array('q'), array('d')
        self._sequences = array('q')
        self._count = 0
        self._step: tuple[int, int, int] | None = None
        self._doubt: Doubt | None = None

    def take(self, channel: int, sample: Sample, sequence: int = 0) -> Doubt | None:
        """Take a reading; return the doubt of the last judgement, None without one.

        Parameters
        ----------
        channel
            Number of the channel by which it came.
        sample
            Reading of the message.
        sequence
            Number of the message in the order of arrival; 0 throughout where it is not known.
        """
        values = _values(sample)
        if values is None:
            return None
        self._watch_steps(sample.stamp)
        self._channels.append(channel)
        self._stamps.append(sample.stamp)
        self._sequences.append(sequence)
        self._values.extend(values)
        self._count += 1
        if self._count % (JUDGED_READINGS // 2) == 0:
            for numbers in (self._channels, self._stamps, self._sequences):
                del numbers[:-KEPT_READINGS]
            del self._values[: -KEPT_READINGS * len(values)]
            self._doubt = self._judge()
        return self._doubt

    def _watch_steps(self, stamp: int) -> None:
        """Store the last step back: its count, and the stamps before and after it."""
        if not self._stamps:
            return
        before = self._stamps[-1]
        if stamp < before - BACK_NS:
            # After a false stamp far ahead, readings go on from those before it.
            recent = sorted(self._stamps[-RECENT_READINGS:])
            if stamp < recent[len(recent) // 2] - BACK_NS:
                self._step = self._count, before, stamp
        elif self._step and stamp > self._step[1]:
            # A stamp was false, another source speaks, or all is past.
            self._step = None

    def _judge(self) -> Doubt | None:
        stamps, channels = np.array(self._stamps), self._channels[-JUDGED_READINGS:]
        if (doubt := _still(stamps) or self._set_back()) is not None:
            return doubt
        why = self._second_source(stamps, channels)
        if not why:
            return None
        # Sorted by its stamps, a bag does not tell these two apart.
        known = any(self._sequences) or channels.count(channels[0]) < len(channels)
        also = '' if known else ' (or one, whose clock was set back)'
        return Doubt('source', f'has two sources{also}: {why}; expected one instrument')

    def _set_back(self) -> Doubt | None:
        if self._step is not None and self._count - self._step[0] >= SETTLED_READINGS:
            _, before, after = self._step
            return _clock_set_back(f'at {when(before)}, by {lasting(before - after)}')
        # Sorted by their stamps, readings of before and after stand between each other.
        order = np.diff(np.array(self._sequences[-JUDGED_READINGS:]))
        ahead = order[order > JUDGED_READINGS // 2]
        if (
            len(ahead) < SETTLED_READINGS
            or np.count_nonzero(order < -(JUDGED_READINGS // 2)) < SETTLED_READINGS
        ):
            return None
        return _clock_set_back(
            f'after {when(self._stamps[-1])} or so: readings that came '
            f'{int(np.median(ahead))} later have the same stamps'
        )

    def _second_source(self, stamps: StampArray, channels: Sequence[int]) -> str:
        readings = np.array(self._values).reshape(len(stamps), -1)
        if channels.count(channels[0]) < len(channels) and (why := _by_turns(channels)):
            return why
        steps, values = np.diff(stamps[-JUDGED_READINGS:]), readings[-JUDGED_READINGS:]
        number = len(values)
        if (least := steps.min()) <= 0:
            again = ~np.all((values[1:] == values[:-1]) | np.isnan(values[1:]), axis=1)
            twice = int(np.count_nonzero((steps == 0) & again))
            if twice >= MIN_ODD_SHARE * JUDGED_READINGS:
                return f'{twice} of {number} stamps come twice, with two readings'
            back = int(np.count_nonzero(steps < 0))
            if back >= MIN_ODD_SHARE * JUDGED_READINGS:
                return f'{back} of {number} stamps go back in time'
        near = least <= LONGEST_STEP and median(steps.tolist()) <= LONGEST_STEP
        if near and number == JUDGED_READINGS and _alternates(values):
            return f'{number} readings jump back and forth between two courses'
        if visits := _visits(stamps, readings):
            return f'{visits} of {len(readings)} readings lie on a second course'
        return ''


def _still(stamps: StampArray) -> Doubt | None:
    """Describe stamps (n,) that stand still."""
    last = int(stamps[-1])
    if np.any(stamps[-JUDGED_READINGS // 2 :] != last):
        return None
    found = 'never stamps' if last == 0 else f'has a clock that stands still ({when(last)})'
    same = JUDGED_READINGS // 2
    return Doubt('stamp', f'{found}: all of {same} stamps are {last}; expected the time of '
                 'each reading')  # fmt: skip


def _clock_set_back(where: str) -> Doubt:
    return Doubt('stamp', f'has a clock that was set back {where}; expected one that '
                 'runs on (split the bag there)')  # fmt: skip


def _by_turns(channels: Sequence[int]) -> str:
    """Describe readings that alternate between channels (n,); '' if they do not."""
    met: set[int] = set()
    returns = 0
    for before, channel in zip((None, *channels), channels, strict=False):
        returns += channel != before and channel in met
        met.add(channel)
    return f'it alternates between {len(met)} channels' if returns >= MIN_ALTERNATIONS else ''


def _alternates(values: FloatArray) -> bool:
    """True if any course of the values (n, k) jumps back and forth."""
    with np.errstate(over='ignore', invalid='ignore'):
        steps = np.diff(values, axis=0)
        turns = np.count_nonzero(steps[1:] * steps[:-1] < 0.0, axis=0)
        for course in np.flatnonzero(turns >= ALTERNATING * (len(steps) - 1)):
            beyond = abs(values[2:, course] - values[:-2, course])
            if median(abs(steps[:, course]).tolist()) > MIN_STEP_RATIO * median(beyond.tolist()):
                return True
    return False


def _visits(stamps: StampArray, readings: FloatArray) -> int:
    """Count the readings of a slower source between those of a faster one; 0 without one."""
    if np.any(stamps[1:] < stamps[:-1]):
        order = np.argsort(stamps, kind='stable')
        stamps, readings = stamps[order], readings[order]
    times = (stamps - stamps[0]).astype(float)
    # Values beyond any instrument are refused elsewhere.
    with np.errstate(over='ignore', invalid='ignore'):
        finite = np.isfinite(readings)
        if finite.all():
            return _beside(times, readings)
        courses = zip(readings.T, finite.T, strict=True)
        return max(_beside(times[there], one[there, None]) for one, there in courses)


def _beside(times: FloatArray, values: FloatArray) -> int:
    """Count the readings that stand out from a course and form a source of their own, else 0.

    ``values`` (n, k) hold k courses. Readings stand out upward or downward.
    """
    if len(values) < 2 * VISITS:
        return 0
    out = _departures(values)
    waves = abs(values[2:] - values[:-2])
    ordered = np.sort(out, axis=0)
    up = out > np.maximum(waves, ordered[-VISITS] / 2.0)
    down = -out > np.maximum(waves, -ordered[VISITS - 1] / 2.0)
    most = 0
    for sign, every in ((1.0, up), (-1.0, down)):
        for course in np.flatnonzero(np.count_nonzero(every, axis=0) >= VISITS):
            most = max(most, _on_second(times, sign * values[:, course], every[:, course]))
    return most


def _on_second(times: FloatArray, values: FloatArray, chosen: BoolArray) -> int:
    """Count the ``chosen`` (n - 2,) of the inner ``values`` if they form a source, else 0."""
    # Values that stand out of noise come at any time.
    if not _alike(np.diff(times[1:-1][chosen])):
        return 0
    out = _departures(values)
    if not _alike(out[chosen]):
        return 0
    # Of the others, each with the number of chosen ones before it.
    others = np.concatenate(([True], ~chosen, [True]))
    if np.median(out[chosen]) < MIN_STEP_RATIO * np.quantile(
        abs(_departures(values[others])), FIRST_COURSE_QUANTILE
    ):
        return 0
    gaps, between = np.diff(times[others]), np.diff(np.cumsum(~others)[others]) > 0
    if np.count_nonzero(~between) < VISITS:
        return 0
    if np.median(gaps[between]) > ONE_PERIOD * np.median(gaps[~between]):
        return 0
    return int(np.count_nonzero(chosen))


def _departures(values: FloatArray) -> FloatArray:
    """Return the differences of values (n, ...) from the mean of their neighbours, (n - 2, ...)."""
    return values[1:-1] - (values[:-2] + values[2:]) / 2.0


def _alike(sizes: FloatArray) -> bool:
    """True if most of the sizes (n,) deviate little."""
    # Of some ten numbers, which arrays take longer to sort.
    each = sizes.tolist()
    middle = float(median(each))
    return middle > 0.0 and median([abs(size - middle) for size in each]) <= SPREAD * middle


def _values(sample: Sample) -> tuple[float, ...] | None:
    """Return the numbers of an instrument's reading; None if none of them follows a course."""
    fields = SENSORS[sample.topic].fields
    return tuple(field.get(sample) for field in fields if field.on_course) or None
