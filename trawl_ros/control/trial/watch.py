# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checks of a trial's readings: stale and frozen sensors, and reached limits."""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from trawl_ros.control.trial.records import TrialSettings, TrialTarget
from trawl_ros.core.time import SECOND
from trawl_ros.records.channels import Reading, readings
from trawl_ros.records.samples import RangeSample, Sample

NEEDED = ('port_length', 'starboard_length', 'port_tension', 'starboard_tension', 'speed')
"""Channels that a trial needs to begin."""

WATCHED = (*NEEDED, 'port_door_depth', 'starboard_door_depth', 'net_depth', 'heading')
"""Channels that can be stale; those beyond `NEEDED` only after their first reading."""

DEPTHS = ('port_door_depth', 'starboard_door_depth', 'net_depth')
SCATTERING = ('port_tension', 'starboard_tension', 'speed')
"""Channels whose readings always scatter, so that equal ones mean a frozen sensor."""


@dataclass(frozen=True)
class WatchOptions:
    """Options of the checks.

    Attributes
    ----------
    frozen_readings
        Number of exactly equal readings of a frozen sensor.
    late_periods
        Age of a stale reading in usual periods.
    max_echo_age_s
        Age after which an echo of the seabed is not used; shorter losses are common.
    max_counter_lag_m, max_counter_error
        Lag and relative error of a counter that still follows.
    period_readings, median_readings
        Number of readings for the usual period, and for the median that is the value.
    """

    frozen_readings: int = 12
    late_periods: float = 1.5
    max_echo_age_s: float = 60.0
    max_counter_lag_m: float = 5.0
    max_counter_error: float = 0.05
    period_readings: int = 15
    median_readings: int = 3


OPTIONS = WatchOptions()


@dataclass
class _Channel:
    """Recent readings of a channel: values, stamps and delays (s)."""

    values: deque[float]
    stamps: deque[int]
    lags: deque[float]
    same: int = 1

    @classmethod
    def empty(cls) -> '_Channel':
        recent, usual = OPTIONS.median_readings, OPTIONS.period_readings
        return cls(deque(maxlen=recent), deque(maxlen=usual), deque(maxlen=usual))

    def take(self, value: float, stamp: int, now: int) -> None:
        self.same = self.same + 1 if self.values and value == self.values[-1] else 1
        self.values.append(value)
        self.stamps.append(stamp)
        self.lags.append((now - stamp) / SECOND)

    @property
    def value(self) -> float:
        """Median of the last few readings, robust against an outlier; NaN before any."""
        return median(self.values) if self.values else math.nan

    def age(self, now: int) -> float:
        """Return the time (s) since the last reading, minus its usual delay."""
        return (now - self.stamps[-1]) / SECOND - max(median(self.lags), 0.0)

    @property
    def period(self) -> float:
        """Usual time (s) between two readings."""
        steps = [(later - earlier) / SECOND for earlier, later in pairwise(self.stamps)]
        return median(steps) if steps else 0.0


class TrialWatch:
    """Checks of the readings of a trial.

    Parameters
    ----------
    settings
        Limits, and the age of stale readings.
    pressure_to_depth
        Function that converts an absolute pressure (Pa) to a depth (m).
    """

    def __init__(
        self, settings: TrialSettings, pressure_to_depth: Callable[[float], float]
    ) -> None:
        self.settings = settings
        self._pressure_to_depth = pressure_to_depth
        self._channels: dict[str, _Channel] = {}

    def take(self, sample: Sample, now: int) -> None:
        """Take a sample that arrived at a time (ns)."""
        if isinstance(sample, RangeSample):
            self._take(Reading(sample.what, sample.stamp, sample.distance, 0.0), now)
        for reading in readings(sample, self._pressure_to_depth):
            self._take(reading, now)

    def _take(self, reading: Reading, now: int) -> None:
        if math.isfinite(reading.value):
            channel = self._channels.setdefault(reading.channel, _Channel.empty())
            channel.take(reading.value, reading.stamp, now)

    def value(self, name: str) -> float:
        """Return the recent value of a channel, NaN without one."""
        channel = self._channels.get(name)
        return math.nan if channel is None else channel.value

    def missing(self) -> tuple[str, ...]:
        """Return the needed channels without a reading."""
        return tuple(name for name in NEEDED if name not in self._channels)

    def here(self) -> TrialTarget:
        """Return the present state by counters and log; only if nothing is `missing`."""
        return TrialTarget(
            port=round(self.value('port_length'), 1),
            starboard=round(self.value('starboard_length'), 1),
            speed=round(self.value('speed'), 2),
        )

    def stale(self, now: int) -> tuple[str, ...]:
        """Return stale and frozen readings at a time (ns), in sentences."""
        found = []
        for name in WATCHED:
            channel = self._channels.get(name)
            if channel is None:
                continue
            age = channel.age(now)
            if age > max(self.settings.stale, OPTIONS.late_periods * channel.period):
                found.append(f'{name} is stale')
            elif name in SCATTERING and channel.same >= OPTIONS.frozen_readings:
                found.append(f'{name} is frozen')
        return tuple(found)

    def not_following(self, wanted: TrialTarget) -> tuple[str, ...]:
        """Return the winches that do not follow their commands, in sentences."""
        lengths = (('port', wanted.port), ('starboard', wanted.starboard))
        lag, error = OPTIONS.max_counter_lag_m, OPTIONS.max_counter_error
        return tuple(
            f'{side} winch does not follow'
            for side, length in lengths
            if abs(self.value(f'{side}_length') - length) > lag + error * length
        )

    def water_depth(self, now: int) -> float:
        """Return the depth (m) of the water by echo sounder or setting; infinite without."""
        echo = self._echo('depth', now)
        return self.settings.seabed if math.isnan(echo) else min(echo, self.settings.seabed)

    def limits(self, now: int) -> tuple[str, ...]:
        """Return the reached limits, in sentences."""
        settings, found = self.settings, []
        for side in ('port', 'starboard'):
            if self.value(f'{side}_tension') > settings.max_tension:
                found.append(f'tension of the {side} warp above {settings.max_tension / 1e3:g} kN')
        depths = [self.value(name) for name in DEPTHS if name in self._channels]
        deepest = max(depths, default=0.0)
        if deepest > settings.max_depth:
            found.append(f'gear below {settings.max_depth:g} m')
        opening = self.value('opening_height')
        above = self._echo('bottom', now) - (0.0 if math.isnan(opening) else opening)
        distance = min((self.water_depth(now) - deepest, above), key=_nan_last)
        if distance < settings.clearance:
            found.append(f'gear less than {settings.clearance:g} m above the seabed')
        # In a faster turn than commanded the gear is not straight behind the ship.
        if abs(self.value('yaw_rate')) > 2.0 * settings.max_turn:
            found.append(f'ship turns faster than {math.degrees(2 * settings.max_turn):.2f} deg/s')
        return tuple(found)

    def haul_share(self) -> float:
        """Return the fraction of the winches' speed for hauling, less near the largest tension."""
        most = self.settings.max_tension
        if math.isinf(most):
            return 1.0
        tension = max(self.value('port_tension'), self.value('starboard_tension'))
        return min(max(10.0 * (1.0 - tension / most), 0.1), 1.0)

    def _echo(self, name: str, now: int) -> float:
        channel = self._channels.get(name)
        if channel is None or channel.age(now) > OPTIONS.max_echo_age_s:
            return math.nan
        return channel.value


def _nan_last(value: float) -> float:
    return math.inf if math.isnan(value) else value
