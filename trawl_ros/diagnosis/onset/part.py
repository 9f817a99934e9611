# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Part of a tow that is watched: stretches as the estimator cuts them, while the tow goes on."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

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
"""Time for which readings of a stretch are waited for."""

RUNNING_M_S, CHANGED_M_S = 0.05, 0.04
"""Pay-out speed beyond which a warp runs; change of the mean speed that begins another state."""


@dataclass(frozen=True)
class LogErrors:
    """Errors of a log, which stay as they were first found so that covariances stay consistent.

    Attributes
    ----------
    std, slow_std
        Std (m/s) of a reading, and of an error that no averaging reduces.
    period_s
        Time between readings.
    """

    std: float
    slow_std: float
    period_s: float

    @classmethod
    def of(cls, log: Series) -> 'LogErrors':
        """Return the errors by a log's readings."""
        channel = CHANNELS['speed']
        slow = channel.state_std(channel.bias_std(float(np.median(log.values))), STATE_SHARE)
        return cls(log.noise, slow, float(np.median(np.diff(log.times))))

    @property
    def density(self) -> float:
        """Noise density, m/s/√Hz."""
        return self.std * float(np.sqrt(self.period_s))

    def knots(self, duration_s: float) -> Knots:
        """Return the knots of the errors along a tow."""
        return knots_of_log(
            np.arange(0.0, duration_s, self.period_s), self.std, duration_s, LIVE.knot_s,
            LIVE.memory_s, self.slow_std, ErrorTimes().state,
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
        Errors of the log; None before there are `FEWEST` stretches.
    """

    def __init__(self, pressure_to_depth: Callable[[float], float]) -> None:
        self._recorder = TowRecorder(pressure_to_depth)
        self.number = 0
        self.tow: MovingTow | None = None
        self.log: LogErrors | None = None

    def feed(self, sample: Sample) -> bool:
        """Take a sample; return True if another stretch has ended by it."""
        self._recorder.feed(sample)
        start = self._recorder.start_ns
        if start is None:
            return False
        ended = (self._recorder.newest_ns - round(LAG_S * SECOND) - start) // LENGTH_NS
        return ended > self.number

    def cut(self) -> MovingTow:
        """Return the tow up to the newest stretch that has ended.

        Raises
        ------
        TrawlError
            If an input is silent, or the part is too short.
        """
        start = self._recorder.start_ns
        assert start is not None
        lag = round(LAG_S * SECOND)
        self.number = (self._recorder.newest_ns - lag - start) // LENGTH_NS
        if self.number < FEWEST:
            raise TrawlError('the tow has just begun')
        read = self._recorder.readings('the tow', self.end_ns + lag)
        tow = _of_watched(moving_tow(read, 'the tow', LIVE))
        if self.log is None:
            self.log = LogErrors.of(read.series['speed'])
        knots = tuple(
            self.log.knots(tow.inputs.duration_s) if own.channel == 'speed' else own
            for own in tow.inputs.knots
        )
        self.tow = _continued(replace(tow, inputs=replace(tow.inputs, knots=knots)), self.tow)
        if len(self.tow) < self.number:
            raise TrawlError('counters, log or winches are silent')
        return self.tow

    @property
    def end_ns(self) -> int:
        """End (ns) of the newest stretch."""
        return self.begin_ns(self.number)

    def begin_ns(self, stretch: int) -> int:
        """Beginning (ns) of a stretch."""
        return (self._recorder.start_ns or 0) + stretch * LENGTH_NS


def _of_watched(tow: MovingTow) -> MovingTow:
    """Return a tow with all watched channels, NaN where there is no reading."""
    places = [tow.channels.index(one) if one in tow.channels else -1 for one in WATCHED]
    none = np.full((len(tow), 1), np.nan)
    plain = np.full((len(tow), 1, tow.steps + 1), 1.0 / (tow.steps + 1))
    means, noise = (np.hstack((own, none))[:, places] for own in (tow.means, tow.noise))
    means[:SETTLING] = np.nan
    counts = np.hstack((tow.counts, np.zeros((len(tow), 1), np.int64)))[:, places]
    weights = np.hstack((tow.weights, plain))[:, places]
    return replace(tow, channels=WATCHED, means=means, noise=noise, counts=counts, weights=weights)


def _continued(tow: MovingTow, before: MovingTow | None) -> MovingTow:
    """Return a tow whose first stretches are as they were before: they have been judged."""
    if before is None:
        return tow
    n = len(before)
    means, noise, held_s = (
        np.concatenate((old, new[n:]))
        for old, new in (
            (before.means, tow.means), (before.noise, tow.noise), (before.held_s, tow.held_s),
        )
    )  # fmt: skip
    return replace(tow, means=means, noise=noise, held_s=held_s)


def manoeuvres(tow: MovingTow) -> list[tuple[bool, bool]]:
    """Return for each stretch whether warps run, and whether the speed changes."""
    steps, held, found = round(tow.stretch_s / tow.inputs.grid_s), None, []
    for stretch in range(len(tow)):
        own = slice(stretch * steps, (stretch + 1) * steps + 1)
        runs = bool(np.max(np.abs(tow.inputs.rates[own, :2])) > RUNNING_M_S)
        speed = float(np.mean(tow.inputs.values[own, 2]))
        changes = held is not None and abs(speed - held) > CHANGED_M_S
        held = speed if changes or held is None else held
        found.append((runs, changes))
    return found


@cache
def counter_leap_shares(number: int) -> FloatArray:
    """Return the part (number,) of a counter's leap that its course has followed, by stretch.

    It leaps in the middle of the first. The level of the course is a mean of the minutes before.
    """
    end = LIVE.stretch_s
    times = np.arange(-COUNTER_REACH_S, end + LAG_S) + 0.5
    weights = level_weights(times - 0.5 * end)
    after = times >= (0.5 * end - end * np.arange(number))[:, None]
    return np.asarray((after * weights).sum(axis=1) / weights.sum(), np.float64)
