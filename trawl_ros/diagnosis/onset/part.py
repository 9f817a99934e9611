# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Part of a tow that is watched: stretches as the estimator cuts them, while the tow goes on."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.estimation.bag_motion import STRETCHES
from trawl_ros.estimation.motion.processes import STATE_SHARE, ErrorTimes
from trawl_ros.estimation.motion.series import Series, TowRecorder
from trawl_ros.estimation.motion.stretches import (
    COUNTER_REACH_S,
    FEWEST,
    STEADY_ONLY,
    level_weights,
    moving_tow,
)
from trawl_ros.estimation.motion.towing.knots import Knots, knots_of_log
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.samples import Sample

LIVE = replace(STRETCHES, settling_s=0.0)
"""Options of the stretches; those at the beginning are left out here (`SETTLING`)."""

LENGTH_NS = round(LIVE.stretch_s * SECOND)

SETTLING = round(STRETCHES.settling_s / STRETCHES.stretch_s)
"""Stretches at the beginning that are not compared: what the gear did before is not known."""

LAG_S = 15.0
LAG_NS = round(LAG_S * SECOND)
"""Time for which readings of a stretch are waited for."""

NO_READINGS = Series(np.zeros(0), np.zeros(0))

RUNNING_M_S, CHANGED_M_S = 0.05, 0.04
"""Pay-out speed beyond which a warp runs; change of the mean speed that begins another state."""


def _log_knots(log: Series, duration_s: float) -> Knots:
    """Return the knots of a log's errors along a tow, as its readings have been so far."""
    channel = CHANNELS['speed']
    slow = channel.state_std(channel.bias_std(float(np.median(log.values))), STATE_SHARE)
    return knots_of_log(
        np.arange(0.0, duration_s, log.period_s), log.noise, duration_s, LIVE.knot_s,
        LIVE.memory_s, slow, ErrorTimes().state,
    )  # fmt: skip


class WatchedPart:
    """Part of a tow from a stamp on.

    Parameters
    ----------
    pressure_to_depth
        Depth (m) for an absolute pressure (Pa).

    Attributes
    ----------
    number
        Number of stretches that have ended.
    tow
        The stretches with a course of all inputs; None before there are `FEWEST`.
    log
        Readings of the log through the first `FEWEST` stretches, none before. Its errors stay as
        these show them, so that covariances stay consistent.
    """

    def __init__(self, pressure_to_depth: Callable[[float], float]) -> None:
        self._recorder = TowRecorder(pressure_to_depth)
        self.number = 0
        self.tow: MovingTow | None = None
        self.log = NO_READINGS

    def feed(self, sample: Sample) -> bool:
        """Take a sample; return True if another stretch has ended by it."""
        self._recorder.feed(sample)
        return self._recorder.start_ns is not None and self._ended > self.number

    @property
    def _ended(self) -> int:
        return (self._recorder.newest_ns - LAG_NS - self.begin_ns(0)) // LENGTH_NS

    def cut(self) -> MovingTow:
        """Return the tow up to the newest stretch that has ended, with all watched channels.

        Raises
        ------
        TrawlError
            If an input is silent, or the part is too short.
        """
        self.number = self._ended
        if self.number < FEWEST:
            raise TrawlError('the tow has just begun')
        read = self._recorder.readings('the tow', self.end_ns + LAG_NS)
        series = {name: own for name, own in read.series.items() if name not in STEADY_ONLY}
        unread = {name: NO_READINGS for name in WATCHED if name not in series}
        tow = moving_tow(replace(read, series=series | unread), 'the tow', LIVE)
        if len(tow) < self.number:
            raise TrawlError('counters, log or winches are silent')
        if self.log is NO_READINGS:
            self.log = read.series['speed']
        knots = (_log_knots(self.log, tow.inputs.duration_s), *tow.inputs.knots[1:])
        tow.means[:SETTLING] = np.nan
        if self.tow is not None:
            # Readings are smoothed again, but stretches that were judged stay as they are.
            for kept in ('means', 'noise', 'held_s'):
                getattr(tow, kept)[: len(self.tow)] = getattr(self.tow, kept)
        self.tow = replace(tow, inputs=replace(tow.inputs, knots=knots))
        return self.tow

    @property
    def log_density(self) -> float:
        """Noise density of the log, m/s/√Hz."""
        return self.log.noise * float(np.sqrt(self.log.period_s))

    @property
    def end_ns(self) -> int:
        """End (ns) of the newest stretch."""
        return self.begin_ns(self.number)

    def begin_ns(self, stretch: int) -> int:
        """Beginning (ns) of a stretch."""
        return (self._recorder.start_ns or 0) + stretch * LENGTH_NS


def manoeuvres(tow: MovingTow) -> list[bool]:
    """Return for each stretch whether warps run or the speed changes."""
    steps, found = round(tow.stretch_s / tow.inputs.grid_s), []
    held = float(np.mean(tow.inputs.values[: steps + 1, 2]))
    for first in range(0, steps * len(tow), steps):
        own = slice(first, first + steps + 1)
        speed = float(np.mean(tow.inputs.values[own, 2]))
        changes = abs(speed - held) > CHANGED_M_S
        held = speed if changes else held
        found.append(changes or bool(np.max(np.abs(tow.inputs.rates[own, :2])) > RUNNING_M_S))
    return found


def counter_leap_shares(number: int) -> FloatArray:
    """Return the part (number,) of a counter's leap that its course has followed, by stretch.

    It leaps in the middle of the first. The level of the course is a mean of the minutes before.
    """
    end = LIVE.stretch_s
    times = np.arange(-COUNTER_REACH_S, end + LAG_S) + 0.5
    weights = level_weights(times - 0.5 * end)
    after = times >= (0.5 * end - end * np.arange(number))[:, None]
    return np.asarray((after * weights).sum(axis=1) / weights.sum(), np.float64)
