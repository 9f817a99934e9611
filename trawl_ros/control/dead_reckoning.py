"""State estimate of the ship for the autopilot: heading, position, current from samples."""

import math

import numpy as np

from trawl_ros.control.low_pass import LowPass
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.geodesy import Datum, to_east_north
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import FixSample, HeadingSample, SchoolsSample, VelocitySample

NavigationSample = HeadingSample | FixSample | VelocitySample | SchoolsSample

LOST_S = 5.0
"""A sensor that is silent for longer is lost."""

DEAD_RECKONED_S = 120.0
"""So long a place can be carried on by velocity over ground alone."""

FIX_SHARE = 0.2
"""Filter gain of a fix's deviation from dead reckoning."""

CURRENT_S = 60.0
SPEED_S = 10.0


class Bearings:
    """Dead reckoning of heading, position, speed and current.

    The place is reckoned by the velocity over ground and drawn to each fix. The current is what
    velocity over ground has more than heading and speed log, so an error of the compass across
    the ship's way counts as current too, and is made up for like one.

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
        self._current = (LowPass(CURRENT_S), LowPass(CURRENT_S))
        self._speed = LowPass(SPEED_S)
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
        """Position (2,), east and north, m, at a stamp (ns); None where it is out of date."""
        if self._position is None or self.age('fix', stamp) > DEAD_RECKONED_S:
            return None
        if self._ground is None:
            return self._position
        return self._position + self._ground * (stamp - self._reckoned_at) / SECOND

    def age(self, what: str, stamp: int) -> float:
        """Age (s) of the last sample: 'heading', 'fix', 'water', 'ground' or 'schools'."""
        heard = self._heard.get(what)
        return math.inf if heard is None else (stamp - heard) / SECOND

    def take(self, sample: NavigationSample) -> None:
        """Update by a sample; one with NaN is ignored."""
        if isinstance(sample, HeadingSample):
            if math.isfinite(sample.heading):
                self._heading = sample.heading
                self._heard['heading'] = sample.stamp
        elif isinstance(sample, FixSample):
            self._take_fix(sample)
        elif isinstance(sample, VelocitySample):
            if np.isfinite(sample.velocity[:2]).all():
                self._take_velocity(sample)
        else:
            self._take_schools(sample)

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
            self._position = reckoned + FIX_SHARE * (fix - reckoned)
        self._reckoned_at = sample.stamp
        self._heard['fix'] = sample.stamp

    def _take_velocity(self, sample: VelocitySample) -> None:
        since = min(self.age(sample.over, sample.stamp), LOST_S)
        self._heard[sample.over] = sample.stamp
        if sample.over == 'water':
            self._speed.take(float(np.hypot(*sample.velocity[:2])), since)
            self._water = sample.velocity[:2]
            return
        if (reckoned := self.position(sample.stamp)) is not None:
            self._position, self._reckoned_at = reckoned, sample.stamp
        self._ground = sample.velocity[:2]
        if self._heading is None or self.age('water', sample.stamp) > LOST_S:
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
