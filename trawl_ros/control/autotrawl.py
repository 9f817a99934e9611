"""Autotrawl: holds set warp lengths, or equal tension in both warps, by wanted warp lengths.

A wanted length is the sum of four parts, each bounded:

- the *set length*, approached at the winch's speed when it is changed;
- the *counter's part*, which brings what the counters say to the set lengths, slowly: in mode
  ``lengths`` each winch for itself, in mode ``tension`` the mean of both;
- the *balance*, in mode ``tension``: as much to the one side as from the other, an integral of
  the difference in tension, for the taut warp becomes slack when it is paid out. It is slow, since
  doors and net take a minute to come to rest again;
- the *give*, in mode ``tension``: warp paid out at once when the tension rises above what is to
  be held, and hauled back slowly.

What cannot be computed for want of a sensor stays as it is.
"""

import math

from trawl_ros.control.autotrawl_records import (
    FAST_S,
    GIVE_LENGTH_M,
    AutotrawlSettings,
    AutotrawlState,
)
from trawl_ros.control.low_pass import LowPass
from trawl_ros.control.watch import Watch
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import WinchSample
from trawl_ros.records.truth import SIDES

LONGEST_GAP_S = 2.0
"""Integrals grow by no more than this for one sample: what happened in a gap is not known."""

BALANCE_S, MEAN_S = 10.0, 120.0
"""Time constants of the tension that is balanced, and of the one from which a peak rises."""

LOST_S = 3.0
"""Time without a reading after which a sensor is lost."""

FREEZE_M = 2.0
"""A counter that does not change while so much is wanted of its winch is frozen."""

FREEZE_CHANGES, FREEZE_TRAVEL_M = 20, 1.0
"""A load cell that does not change is frozen when its fellow has changed so many times, or the
wanted lengths have gone up and down by so much."""

COUNTER_S, COUNTER_SPEED, COUNTER_DEAD_BAND_M = 30.0, 0.1, 0.2
SETTLING_S, CALM_S = 10.0, 60.0
"""Times after the set length is reached: until a winch stands still, and until the tension is no
more that of hauling or veering, to which nothing is to be given."""

COUNTER_SHARE = 0.05
"""A counter is believed within this share of the length; its part is bounded by it."""

BALANCE_SPEED = 0.05
"""The gear takes its time to follow, however large the difference in tension."""

LEAD_S = 0.3
"""Latency of a sample and a command together."""

_SIGNS = (1.0, -1.0)


def _within(value: float, most: float) -> float:
    return min(max(value, -most), most)


def _beyond(value: float, dead_band: float) -> float:
    return math.copysign(max(abs(value) - dead_band, 0.0), value)


class Autotrawl:
    """Autotrawl: controller of both winches.

    Parameters
    ----------
    settings
        Mode, gains and limits.
    lengths
        Wanted lengths (port, starboard) as they stand when it takes over, m.
    """

    def __init__(self, settings: AutotrawlSettings, lengths: tuple[float, float]) -> None:
        self.settings = settings
        self._target = lengths
        self._set = list(lengths)
        self._wanted = lengths
        self._parts = [0.0, 0.0]
        self._balance = 0.0
        self._given = [0.0, 0.0]
        self._giving = [0.0, 0.0]
        self._stamp: int | None = None
        self._counters = [
            Watch(f'{side} counter', lost_s=LOST_S, frozen_after=FREEZE_M) for side in SIDES
        ]
        self._cells = [
            Watch(f'{side} load cell', lost_s=LOST_S, frozen_after=1.0) for side in SIDES
        ]
        self._changes = [0, 0]
        self._travel = 0.0
        self._smooth = [LowPass(BALANCE_S) for _ in SIDES]
        self._means = [LowPass(MEAN_S) for _ in SIDES]
        self._at_rest_s = 0.0
        self._bounds: dict[str, bool] = {}

    @property
    def wanted(self) -> tuple[float, float]:
        """Wanted lengths (port, starboard), m."""
        return self._wanted

    def change(self, settings: AutotrawlSettings) -> None:
        """Change the settings, without a jump of the wanted lengths.

        In a new mode the warps go from where they are to the set lengths at the winch's speed.
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
        self._approach_set_lengths(dt)
        self._follow_counters(dt)
        if self.settings.mode == 'tension':
            self._balance_tensions(dt)
            self._give_way(dt)
        before = self._wanted
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
        return 0.0 if before is None else min((stamp - before) / SECOND, LONGEST_GAP_S)

    def _look(self, sample: WinchSample, dt: float) -> None:
        for side in (0, 1):
            counter, cell = self._counters[side], self._cells[side]
            length, tension = sample.lengths[side], sample.tensions[side]
            away = abs(length - self._wanted[side])
            believable = away <= 2 * COUNTER_SHARE * self._wanted[side]
            counter.take(length if believable else math.nan, sample.stamp, self._wanted[side])
            followed = self._changes[1 - side] / FREEZE_CHANGES + self._travel / FREEZE_TRAVEL_M
            # Under tow no warp is slack: a cell that says so is broken.
            cell_reading = tension if tension > 0.0 else math.nan
            self._changes[side] += cell.take(cell_reading, sample.stamp, followed)
            if math.isfinite(cell.value):
                self._smooth[side].take(cell.value, dt)
                if self._at_rest_s < CALM_S:
                    self._means[side] = LowPass(MEAN_S)
                self._means[side].take(self._smooth[side].value, dt)

    def _approach_set_lengths(self, dt: float) -> None:
        most = self.settings.max_speed * dt
        for side in (0, 1):
            self._set[side] += _within(self._target[side] - self._set[side], most)
        if self._set != list(self._target):
            self._at_rest_s = 0.0
        else:
            self._at_rest_s += dt

    def _follow_counters(self, dt: float) -> None:
        """Integrate the counters' deviation; only while the warps should be at rest."""
        errors = [self._set[k] - self._counters[k].value for k in (0, 1)]
        if self.settings.mode == 'tension':
            errors = [0.5 * sum(errors)] * 2
        for side, error in enumerate(errors):
            if self._at_rest_s < SETTLING_S or not math.isfinite(error):
                continue
            rate = _within(_beyond(error, COUNTER_DEAD_BAND_M) / COUNTER_S, COUNTER_SPEED)
            most = COUNTER_SHARE * self._set[side]
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
        rate = _within(rate, BALANCE_SPEED)
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
            if math.isfinite(tension) and self._at_rest_s >= CALM_S:
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
        # A winch moves at a speed while it is wanted as far away as it needs to stop from it.
        ahead = speed * (abs(speed) / (2 * self.settings.max_acceleration) + LEAD_S)
        balance = _SIGNS[side] * self._balance
        return self._set[side] + self._parts[side] + balance + self._given[side] + ahead

    def _bounded(self, name: str, value: float, most: float) -> float:
        self._bounds[name] = abs(value) >= most
        return _within(value, most)
