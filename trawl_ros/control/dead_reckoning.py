# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Dead reckoning of the ship for the autopilot: heading, position and current from samples."""

import math
from typing import assert_never

import numpy as np

from trawl_ros.control.low_pass import LowPass
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.geodesy import Datum, to_east_north
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import FixSample, HeadingSample, SchoolsSample, VelocitySample

NavigationSample = HeadingSample | FixSample | VelocitySample | SchoolsSample

SENSOR_TIMEOUT_S = 5.0
"""A sensor that is silent for longer is lost."""

MAX_DEAD_RECKONING_S = 120.0
"""Longest time for which a position is extrapolated by velocity over ground."""

FIX_GAIN = 0.2
"""Filter gain of a fix's deviation from dead reckoning."""

CURRENT_TIME_CONSTANT_S, SPEED_TIME_CONSTANT_S = 60.0, 10.0
"""Time constants of the low-pass filters of current and speed."""


class DeadReckoning:
    """Dead reckoning of heading, position, speed and current.

    The position is extrapolated by the velocity over ground and corrected by each fix. The current
    is the velocity over ground minus that through the water by heading and log. An error of the
    compass therefore appears as a cross current, and is compensated like one.

    Parameters
    ----------
    datum
        Origin of ``map``.
    """

    def __init__(self, datum: Datum) -> None:
        self._datum = datum
        self._heading: float | None = None
        self._position: FloatArray | None = None
        self._ground: FloatArray | None = None
        self._water = np.zeros(2)
        self._current = (LowPass(CURRENT_TIME_CONSTANT_S), LowPass(CURRENT_TIME_CONSTANT_S))
        self._speed = LowPass(SPEED_TIME_CONSTANT_S)
        self._heard: dict[str, int] = {}
        self._reckoned_at = 0
        self.schools = np.zeros((0, 2))

    @property
    def heading(self) -> float | None:
        """Heading, ENU yaw, rad; None before the first."""
        return self._heading

    @property
    def speed(self) -> float:
        """Speed through the water, m/s; 0 before it is known."""
        return self._speed.value if math.isfinite(self._speed.value) else 0.0

    @property
    def current(self) -> FloatArray:
        """Velocity (2,) of the water, east and north, m/s; 0 before it is known."""
        velocity = np.array([component.value for component in self._current])
        return velocity if np.isfinite(velocity).all() else np.zeros(2)

    def position(self, stamp: int) -> FloatArray | None:
        """Return the position (2,), east and north, m, at a stamp (ns); None if out of date."""
        if self._position is None or self.age('fix', stamp) > MAX_DEAD_RECKONING_S:
            return None
        if self._ground is None:
            return self._position
        return self._position + self._ground * (stamp - self._reckoned_at) / SECOND

    def age(self, what: str, stamp: int) -> float:
        """Return the age (s) of the last heading, fix, water, ground or schools sample."""
        heard = self._heard.get(what)
        return math.inf if heard is None else (stamp - heard) / SECOND

    def take(self, sample: NavigationSample) -> None:
        """Update by a sample; one with NaN is ignored."""
        match sample:
            case HeadingSample():
                if math.isfinite(sample.heading):
                    self._heading = sample.heading
                    self._heard['heading'] = sample.stamp
            case FixSample():
                self._take_fix(sample)
            case VelocitySample():
                if np.isfinite(sample.velocity[:2]).all():
                    self._take_velocity(sample)
            case SchoolsSample():
                self._take_schools(sample)
            case _:
                assert_never(sample)

    def _take_fix(self, sample: FixSample) -> None:
        if not (math.isfinite(sample.latitude) and math.isfinite(sample.longitude)):
            return
        east, north = to_east_north(
            np.array([sample.latitude]), np.array([sample.longitude]), self._datum
        )
        fix = np.array([east[0], north[0]])
        reckoned = self.position(sample.stamp)
        if reckoned is None:
            self._position = fix
        else:
            self._position = reckoned + FIX_GAIN * (fix - reckoned)
        self._reckoned_at = sample.stamp
        self._heard['fix'] = sample.stamp

    def _take_velocity(self, sample: VelocitySample) -> None:
        since = min(self.age(sample.over, sample.stamp), SENSOR_TIMEOUT_S)
        self._heard[sample.over] = sample.stamp
        if sample.over == 'water':
            self._speed.take(float(np.hypot(*sample.velocity[:2])), since)
            self._water = sample.velocity[:2]
            return
        if (reckoned := self.position(sample.stamp)) is not None:
            self._position, self._reckoned_at = reckoned, sample.stamp
        self._ground = sample.velocity[:2]
        if self._heading is None or self.age('water', sample.stamp) > SENSOR_TIMEOUT_S:
            return
        cos, sin = math.cos(self._heading), math.sin(self._heading)
        ahead, port = self._water
        self._current[0].take(float(self._ground[0] - ahead * cos + port * sin), since)
        self._current[1].take(float(self._ground[1] - ahead * sin - port * cos), since)

    def _take_schools(self, sample: SchoolsSample) -> None:
        position = self.position(sample.stamp)
        if position is None or self._heading is None:
            return
        cos, sin = math.cos(self._heading), math.sin(self._heading)
        turn = np.array([[cos, -sin], [sin, cos]])
        self.schools = position + sample.positions[:, :2] @ turn.T
        self._heard['schools'] = sample.stamp
