# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Statistics of each part of a tow: scatter and dominant period of tensions, depths and rolls.

They are no data for the coefficients. They tell a ship that heaves, netting that strums and a load
cell that sticks from one another.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.series import Series, TowReadings, about_line
from trawl_ros.estimation.motion.towing.records import MovingTow, Oscillation, PartStatistics

CHANNELS_OF_STATISTICS = (
    'port_tension', 'starboard_tension', 'port_door_depth', 'starboard_door_depth', 'net_depth',
    'port_roll', 'starboard_roll',
)  # fmt: skip
"""Channels whose statistics are kept."""

FEWEST_READINGS = 30
"""Fewest readings of a part from which statistics are computed."""

LONGEST_PERIOD_S = 30.0
"""Longest period (s) that is looked for: that of a long swell, met from behind, is about 20 s."""

FALSE_ALARM = 0.001
"""Probability with which white noise has a dominant period."""


def part_statistics(read: TowReadings, tow: MovingTow) -> tuple[PartStatistics, ...]:
    """Compute the statistics of each steady and each moving part of a tow.

    Parameters
    ----------
    read
        Readings of the tow.
    tow
        The tow in stretches.
    """
    found = []
    for first, last in _parts(tow):
        begin, end = first * tow.stretch_s, last * tow.stretch_s
        channels = {}
        for name in CHANNELS_OF_STATISTICS:
            if name in read.series:
                own = oscillation(read.series[name], begin, end, tow.stretch_s)
                if own is not None:
                    channels[name] = own
        found.append(PartStatistics(begin, end, bool(tow.steady[first]), channels))
    return tuple(found)


def _parts(tow: MovingTow) -> Iterator[tuple[int, int]]:
    """First stretch of each part, and the first behind it."""
    edges = np.flatnonzero(np.diff(tow.steady.astype(int))) + 1
    bounds = [0, *edges.tolist(), len(tow)]
    yield from pairwise(bounds)


def oscillation(series: Series, begin: float, end: float, stretch_s: float) -> Oscillation | None:
    """Oscillation of a channel's readings between two times (s); None if these are too few.

    Parameters
    ----------
    series
        Readings.
    begin, end
        Times.
    stretch_s
        Length of the stretches in which a line is taken out.
    """
    inside = (series.times >= begin) & (series.times < end)
    times, values = series.times[inside], series.values[inside]
    if len(times) < FEWEST_READINGS:
        return None
    left = _about_lines(times, values, stretch_s)
    std = float(left.std())
    return Oscillation(std, dominant_period(times, left) if std > 0.0 else float('nan'))


def _about_lines(times: FloatArray, values: FloatArray, stretch_s: float) -> FloatArray:
    """Readings (n,) less the line through those of each stretch."""
    left = np.empty(len(values))
    number = ((times - times[0]) / stretch_s).astype(int)
    for stretch in np.unique(number):
        own = number == stretch
        left[own] = about_line(times[own], values[own])
    return left


def dominant_period(times: FloatArray, values: FloatArray) -> float:
    """Period (s) of the largest peak of the Lomb-Scargle periodogram; NaN if noise explains it.

    Parameters
    ----------
    times, values : (n,) arrays
        Readings about a mean of 0.
    """
    # Imported here: it takes a node's start long, and no node needs it before the end of a tow.
    from scipy.signal import lombscargle

    interval, duration = float(np.median(np.diff(times))), float(np.ptp(times))
    lowest, highest = 1.0 / LONGEST_PERIOD_S, 0.5 / interval
    if highest <= lowest:
        return float('nan')
    frequencies = np.arange(lowest, highest, 0.5 / duration)
    power = lombscargle(times, values, 2.0 * np.pi * frequencies) / values.var()
    # Of white noise the power is exponential, so of m independent frequencies the largest is
    # beyond z with a probability of about m exp(-z) (Scargle 1982, eq. 14).
    limit = np.log(max(0.5 * len(frequencies), 1.0) / FALSE_ALARM)
    peak = int(np.argmax(power))
    return float(1.0 / frequencies[peak]) if power[peak] > limit else float('nan')
