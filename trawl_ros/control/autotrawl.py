# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Autotrawl: holds set warp lengths, or equal tension in both warps, by wanted warp lengths.

A wanted length is the sum of four parts, each bounded:

- the *set length*, approached after a change at what the other parts leave of the winch's speed. A
  winch that lags behind its wanted length stops later than the other, and doors that slow down one
  after the other fall;
- the *counter's part*, which slowly brings the counters to the set lengths: in mode ``lengths``
  each winch on its own, in mode ``tension`` the mean of both;
- the *balance*, in mode ``tension``: an integral of the difference in tension, paid out on one side
  and hauled on the other, because the taut warp slackens when it is paid out. It is slow, because
  doors and net need a minute to settle;
- the *give*, in mode ``tension``: warp that is paid out at once when the tension rises above the
  held one, and hauled back slowly.

A part whose sensor is missing keeps its value.
"""

import math
from collections import deque
from statistics import median

from trawl_ros.control.autotrawl_records import (
    FAST_S,
    GIVE_LENGTH_M,
    AutotrawlOptions,
    AutotrawlSettings,
    AutotrawlState,
)
from trawl_ros.control.low_pass import LowPass
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import WinchSample
from trawl_ros.records.truth import SIDES

OPTIONS = AutotrawlOptions()

_SIGNS = (1.0, -1.0)


def _within(value: float, most: float) -> float:
    return min(max(value, -most), most)


def _beyond(value: float, dead_band: float) -> float:
    return math.copysign(max(abs(value) - dead_band, 0.0), value)


class SensorWatch:
    """Watchdog of one channel of a sensor, which passes valid readings.

    The value is the median of the last three readings, so a single outlier has no effect. A channel
    is *lost* if it gives no number for a while. It is *frozen* if its number stays exactly the same
    although a quantity that it must follow has changed.

    Parameters
    ----------
    name
        Name of the sensor in messages.
    lost_s
        Time without a number after which it is lost, s.
    frozen_after
        Change of the followed quantity after which a constant number is frozen.

    Attributes
    ----------
    value : float
        Valid reading; NaN while the channel has a fault.
    problem : str
        Description of its fault, '' without one.
    """

    def __init__(self, name: str, *, lost_s: float, frozen_after: float) -> None:
        self.name = name
        self.value = math.nan
        self.problem = ''
        self._timeout_ns = round(lost_s * SECOND)
        self._frozen_after = frozen_after
        self._recent: deque[float] = deque(maxlen=3)
        self._heard: int | None = None
        self._followed_at_change = 0.0
        self._frozen = False

    def take(self, reading: float, stamp: int, followed: float) -> bool:
        """Update by a reading.

        Parameters
        ----------
        reading
            Number of the sensor; NaN if it gives none.
        stamp
            Time of the reading, ns.
        followed
            Value of the quantity that the sensor must follow.

        Returns
        -------
        bool
            True if the reading differs from the one before.
        """
        if self._heard is None:
            self._heard = stamp
        silent = stamp - self._heard > self._timeout_ns
        if not math.isfinite(reading):
            if silent:
                self._give_up('lost')
            return False
        if silent:
            self._recent.clear()
        self._heard = stamp
        changed = not self._recent or reading != self._recent[-1]
        if changed:
            self._followed_at_change = followed
        self._recent.append(reading)
        if abs(followed - self._followed_at_change) > self._frozen_after:
            self._frozen = True
        self._frozen = self._frozen and not changed
        if self._frozen:
            self._give_up('frozen')
        else:
            self.problem = ''
            self.value = median(self._recent)
        return changed

    def _give_up(self, problem: str) -> None:
        self.problem = f'{self.name} {problem}'
        self.value = math.nan


class Autotrawl:
    """Autotrawl: controller of both winches.

    Parameters
    ----------
    settings
        Mode, gains and limits.
    lengths
        Wanted lengths (port, starboard) at the start, m.
    """

    def __init__(self, settings: AutotrawlSettings, lengths: tuple[float, float]) -> None:
        self.settings = settings
        self._target = lengths
        self._set = list(lengths)
        self._pace = 0.0
        self._wanted = lengths
        self._parts = [0.0, 0.0]
        self._balance = 0.0
        self._given = [0.0, 0.0]
        self._giving = [0.0, 0.0]
        self._stamp: int | None = None
        self._counters = [
            SensorWatch(
                f'{side} counter', lost_s=OPTIONS.lost_s, frozen_after=OPTIONS.frozen_counter_m
            )
            for side in SIDES
        ]
        self._cells = [
            SensorWatch(f'{side} load cell', lost_s=OPTIONS.lost_s, frozen_after=1.0)
            for side in SIDES
        ]
        self._changes = [0, 0]
        self._travel = 0.0
        self._smooth = [LowPass(OPTIONS.balance_filter_s) for _ in SIDES]
        self._means = [LowPass(OPTIONS.mean_filter_s) for _ in SIDES]
        self._at_rest_s = 0.0
        self._bounds: dict[str, bool] = {}

    @property
    def wanted(self) -> tuple[float, float]:
        """Wanted lengths (port, starboard), m."""
        return self._wanted

    def change(self, settings: AutotrawlSettings) -> None:
        """Change the settings, without a jump of the wanted lengths.

        In a new mode the warps go from their lengths to the set lengths at the winch's speed.
        """
        if settings.mode != self.settings.mode:
            for side in (0, 1):
                self._set[side] += _SIGNS[side] * self._balance + self._given[side]
            self._given, self._giving, self._balance = [0.0, 0.0], [0.0, 0.0], 0.0
        self.settings = settings

    def set_lengths(self, port: float, starboard: float) -> None:
        """Change the set lengths (m)."""
        self._target = (port, starboard)

    def update(self, sample: WinchSample) -> tuple[float, float]:
        """Update by a sample; return the wanted lengths (port, starboard), m."""
        dt = self._time_since(sample.stamp)
        self._bounds = {}
        self._look(sample, dt)
        before = self._wanted
        self._follow_counters(dt)
        if self.settings.mode == 'tension':
            self._balance_tensions(dt)
            self._give_way(dt)
        moved = max(abs(self._sum(side) - before[side]) for side in (0, 1))
        self._approach_set_lengths(dt, moved)
        self._wanted = self._sum(0), self._sum(1)
        self._travel += max(abs(a - b) for a, b in zip(self._wanted, before, strict=True))
        return self._wanted

    def state(self) -> AutotrawlState:
        """Return the controller's report."""
        watches = (*self._counters, *self._cells)
        return AutotrawlState(
            set_lengths=(self._set[0], self._set[1]),
            wanted=self._wanted,
            counter_parts=(self._parts[0], self._parts[1]),
            balance=self._balance,
            given=(self._given[0], self._given[1]),
            difference=self._difference(),
            saturated=tuple(name for name, reached in self._bounds.items() if reached),
            problems=tuple(watch.problem for watch in watches if watch.problem),
        )

    def _time_since(self, stamp: int) -> float:
        before, self._stamp = self._stamp, stamp
        return 0.0 if before is None else min((stamp - before) / SECOND, OPTIONS.max_gap_s)

    def _look(self, sample: WinchSample, dt: float) -> None:
        for side in (0, 1):
            counter, cell = self._counters[side], self._cells[side]
            length, tension = sample.lengths[side], sample.tensions[side]
            away = abs(length - self._wanted[side])
            believable = away <= 2 * OPTIONS.counter_max_error * self._wanted[side]
            counter.take(length if believable else math.nan, sample.stamp, self._wanted[side])
            followed = (
                self._changes[1 - side] / OPTIONS.frozen_cell_changes
                + self._travel / OPTIONS.frozen_cell_travel_m
            )
            # No warp is slack under tow, so a cell without tension is broken.
            cell_reading = tension if tension > 0.0 else math.nan
            self._changes[side] += cell.take(cell_reading, sample.stamp, followed)
            if math.isfinite(cell.value):
                self._smooth[side].take(cell.value, dt)
                if self._at_rest_s < OPTIONS.calm_s:
                    self._means[side] = LowPass(OPTIONS.mean_filter_s)
                self._means[side].take(self._smooth[side].value, dt)

    def _approach_set_lengths(self, dt: float, moved: float) -> None:
        """Move both set lengths so that they arrive together, as fast as both winches can follow.

        ``moved`` is how far the other parts have moved a wanted length in ``dt``, m.
        """
        left = [self._target[side] - self._set[side] for side in (0, 1)]
        furthest = max(map(abs, left))
        if not furthest:
            self._pace = 0.0
            self._at_rest_s += dt
            return
        self._at_rest_s = 0.0
        gain = self.settings.max_acceleration * dt
        braking = math.sqrt(2.0 * self.settings.max_acceleration * furthest)
        self._pace = min(self._pace + gain, self.settings.max_speed, braking)
        step = min(self._pace * dt, max(self.settings.max_speed * dt - moved, 0.0), furthest)
        for side in (0, 1):
            self._set[side] += left[side] * step / furthest

    def _follow_counters(self, dt: float) -> None:
        """Integrate the counters' deviation, only while the warps stand still."""
        errors = [self._set[k] - self._counters[k].value for k in (0, 1)]
        if self.settings.mode == 'tension':
            errors = [0.5 * sum(errors)] * 2
        for side, error in enumerate(errors):
            if self._at_rest_s < OPTIONS.standstill_s or not math.isfinite(error):
                continue
            rate = _within(
                _beyond(error, OPTIONS.counter_dead_band_m) / OPTIONS.counter_time_s,
                OPTIONS.counter_max_speed,
            )
            most = OPTIONS.counter_max_error * self._set[side]
            self._parts[side] = self._bounded(
                f'{SIDES[side]} counter', self._parts[side] + rate * dt, most
            )

    def _difference(self) -> float:
        if any(math.isnan(cell.value) for cell in self._cells):
            return math.nan
        port, starboard = (float(smooth.value) for smooth in self._smooth)
        return (port - starboard) / (port + starboard)

    def _balance_tensions(self, dt: float) -> None:
        difference = self._difference()
        if math.isnan(difference):
            return
        rate = self.settings.balance_gain * _beyond(difference, self.settings.balance_dead_band)
        # Half of the winch's speed is left for the set lengths.
        rate = _within(rate, min(OPTIONS.balance_max_speed, 0.5 * self.settings.max_speed))
        most = 0.5 * self.settings.max_difference * 0.5 * sum(self._set)
        self._balance = self._bounded('balance', self._balance + rate * dt, most)

    def _give_way(self, dt: float) -> None:
        """Update the give within the winches' limits, so that a winch can follow it."""
        settings = self.settings
        share = min(1.0, FAST_S / dt) if dt > 0.0 else 0.0
        for side in (0, 1):
            tension = self._cells[side].value
            scale = share * self._set[side] / GIVE_LENGTH_M
            wanted = -self._given[side] / settings.haul_back_s
            if math.isfinite(tension) and self._at_rest_s >= OPTIONS.calm_s:
                held = settings.tension if settings.tension > 0.0 else self._means[side].value
                excess = _beyond(tension / held - 1.0, settings.give_dead_band)
                gain = settings.give_gain if excess > 0.0 else settings.haul_gain
                wanted += scale * gain * excess
            wanted = _within(wanted, settings.max_speed)
            most = settings.max_acceleration * dt
            self._giving[side] += _within(wanted - self._giving[side], most)
            given = self._given[side] + self._giving[side] * dt
            self._given[side] = self._bounded(f'{SIDES[side]} give', given, settings.max_give_m)
            if abs(self._given[side]) < abs(given):
                self._giving[side] = 0.0

    def _sum(self, side: int) -> float:
        speed = self._giving[side]
        # Lead of the wanted length: braking distance v² / 2a plus the latency.
        ahead = speed * (abs(speed) / (2 * self.settings.max_acceleration) + OPTIONS.latency_s)
        balance = _SIGNS[side] * self._balance
        return self._set[side] + self._parts[side] + balance + self._given[side] + ahead

    def _bounded(self, name: str, value: float, most: float) -> float:
        self._bounds[name] = abs(value) >= most
        return _within(value, most)
