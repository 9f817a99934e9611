# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Autopilot: steers a heading, a course over ground, a track, or toward a school of fish."""

import math
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.control.dead_reckoning import (
    SENSOR_TIMEOUT_S,
    DeadReckoning,
    NavigationSample,
)
from trawl_ros.control.track import Track, Way
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.geodesy import Datum

HEADING_GAIN_PER_S = 0.05
"""Rate of turn per heading error: 0.15 deg/s at 3 degrees."""

BRAKING_RATIO = 0.5
"""Part of the turn acceleration that is used to stop a turn."""

TURN_DELAY_S = 15.0
"""Delay of a turn compared with one at the full rate: it begins and ends gently."""

FIRST_WAYPOINT_RADIUS_M = 100.0
"""A ship within this distance of the first waypoint of a track begins with the leg from there."""

SCHOOL_PASSED_M = 150.0
"""Distance of a school below which the ship keeps its course over it."""

SCHOOL_GAIN = 0.4
"""Filter gain of a school's position: the bearing of the fish sonar scatters by degrees."""

SAME_SCHOOL_M = 500.0
"""A school within this distance of the last target is the same school."""


@dataclass(frozen=True)
class AutopilotSettings:
    """Settings of an autopilot.

    ``max_turn`` is the fastest rate of turn (rad/s) that the gear can follow: in a faster turn it
    loses speed, so its doors lose lift and it sinks. ``turn_acceleration`` (rad/s²) is that of the
    ship, and ``look_ahead`` (m) the look-ahead distance on a track.
    """

    max_turn: float = math.radians(0.15)
    turn_acceleration: float = math.radians(0.05)
    look_ahead: float = 300.0


@dataclass(frozen=True)
class HoldHeading:
    """Target: heading by compass, ENU yaw, rad."""

    heading: float


@dataclass(frozen=True)
class HoldCourse:
    """Target: course over ground in any current, ENU yaw, rad."""

    course: float


@dataclass(frozen=True)
class FollowTrack:
    """Target: track over ``waypoints`` (n, 2), east and north in ``map``, m."""

    waypoints: FloatArray


@dataclass(frozen=True)
class ToSchool:
    """Target: nearest school ahead that the fish sonar detects, then straight on."""


Target = HoldHeading | HoldCourse | FollowTrack | ToSchool


@dataclass(frozen=True)
class AutopilotState:
    """Report of an autopilot at one instant.

    Angles are ENU yaw, rad; NaN means unknown or not applicable. ``wanted`` is the heading,
    ``course`` that over ground, ``across`` the distance to port of the leg and ``left`` that to its
    end, m. ``ended`` is True after the last waypoint.
    """

    wanted: float = math.nan
    course: float = math.nan
    turn_rate: float = 0.0
    leg: int = -1
    across: float = math.nan
    left: float = math.nan
    ended: bool = False
    problems: tuple[str, ...] = ()


class Autopilot:
    """Autopilot: rate of turn that steers the ship to its target.

    Parameters
    ----------
    settings
        Limits of the rate of turn, and the look-ahead distance.
    datum
        Origin of ``map``.

    Attributes
    ----------
    state : AutopilotState
        Report of the last call of `turn_rate`.
    """

    def __init__(self, settings: AutopilotSettings, datum: Datum) -> None:
        self.settings = settings
        self.state = AutopilotState()
        self._reckoning = DeadReckoning(datum)
        self._target: Target | None = None
        self._track: Track | None = None
        self._aim: FloatArray | None = None
        self._seen: FloatArray | None = None
        self._course = math.nan
        self._passed = False
        self._rate = 0.0

    def steer(self, target: Target) -> None:
        """Set a new target."""
        self._target = target
        self._track = None
        self._aim = None
        self._course = math.nan
        self._passed = False

    def take(self, sample: NavigationSample) -> None:
        """Update the dead reckoning by a sample."""
        self._reckoning.take(sample)

    def turn_rate(self, stamp: int) -> float:
        """Return the wanted rate of turn (rad/s, to port positive) at a stamp (ns)."""
        heading = self._reckoning.heading
        age = self._reckoning.age('heading', stamp)
        if heading is None or age > SENSOR_TIMEOUT_S:
            self._rate = 0.0
            self.state = AutopilotState(problems=('heading lost: the ship goes straight on',))
            return 0.0
        state = self._guide(stamp, heading)
        # The ship keeps turning between two samples.
        left = math.remainder(state.wanted - heading - self._rate * age, 2 * math.pi)
        self._rate = self._towards(left)
        self.state = replace(state, turn_rate=self._rate)
        return self._rate

    def _towards(self, angle: float) -> float:
        settings = self.settings
        # ω² = 2 a φ: the rate from which the ship can still stop within the angle left.
        braking = math.sqrt(2 * BRAKING_RATIO * settings.turn_acceleration * abs(angle))
        return math.copysign(
            min(settings.max_turn, HEADING_GAIN_PER_S * abs(angle), braking), angle
        )

    def _guide(self, stamp: int, heading: float) -> AutopilotState:
        if isinstance(self._target, HoldHeading):
            return AutopilotState(wanted=self._target.heading)
        if isinstance(self._target, HoldCourse):
            return self._against_current(self._target.course, stamp)
        position = self._reckoning.position(stamp)
        if position is None:
            return self._without_place(stamp, heading)
        if isinstance(self._target, FollowTrack):
            return self._along(self._target.waypoints, position, stamp)
        if isinstance(self._target, ToSchool):
            return self._to_school(position, heading, stamp)
        return AutopilotState(wanted=heading)

    def _against_current(
        self, course: float, stamp: int, problems: tuple[str, ...] = ()
    ) -> AutopilotState:
        """Return the state with the heading on which the ship makes good a course."""
        self._course = course
        for what, name in (('ground', 'velocity over ground'), ('water', 'speed log')):
            if self._reckoning.age(what, stamp) > SENSOR_TIMEOUT_S:
                problems += (f'{name} lost: the last current is used',)
        wanted = self._way.heading_on(course)
        return AutopilotState(wanted=wanted, course=course, problems=problems)

    @property
    def _way(self) -> Way:
        reckoning = self._reckoning
        return Way(reckoning.speed, reckoning.current, self.settings.max_turn)

    def _without_place(self, stamp: int, heading: float) -> AutopilotState:
        course = heading if math.isnan(self._course) else self._course
        return self._against_current(course, stamp, ('fix lost: the ship holds its course',))

    def _along(self, waypoints: FloatArray, position: FloatArray, stamp: int) -> AutopilotState:
        if self._track is None:
            begun = (
                len(waypoints) > 1
                and np.hypot(*(waypoints[0] - position)) < FIRST_WAYPOINT_RADIUS_M
            )
            points = waypoints if begun else np.vstack([position, waypoints])
            self._track = Track(points, look_ahead=self.settings.look_ahead)
        guidance = self._track.follow(position, self._way, TURN_DELAY_S)
        state = self._against_current(guidance.course, stamp, self._fix_problems(stamp))
        return replace(
            state,
            leg=guidance.leg,
            across=guidance.across,
            left=guidance.left,
            ended=guidance.ended,
        )

    def _to_school(self, position: FloatArray, heading: float, stamp: int) -> AutopilotState:
        aim = self._aim_at(position, heading)
        if aim is None:
            course = heading if math.isnan(self._course) else self._course
            return self._against_current(
                course, stamp, ('no school ahead: the ship holds its course',)
            )
        away = aim - position
        distance = float(np.hypot(*away))
        if distance > SCHOOL_PASSED_M and not self._passed:
            self._course = math.atan2(away[1], away[0])
        else:
            self._passed = True
        state = self._against_current(self._course, stamp, self._fix_problems(stamp))
        return replace(state, left=distance, ended=self._passed)

    def _aim_at(self, position: FloatArray, heading: float) -> FloatArray | None:
        """Return the position of the chosen school, or of the nearest ahead at first."""
        schools = self._reckoning.schools
        if self._aim is None:
            away = schools - position
            ahead = away @ np.array([math.cos(heading), math.sin(heading)]) > 0.0
            schools, near = schools[ahead], position
        else:
            near = self._aim
        if len(schools):
            distances = np.hypot(*(schools - near).T)
            nearest = schools[distances.argmin()]
            if self._aim is None:
                self._aim = nearest
            elif distances.min() < SAME_SCHOOL_M and self._reckoning.schools is not self._seen:
                self._aim = self._aim + SCHOOL_GAIN * (nearest - self._aim)
            self._seen = self._reckoning.schools
        return self._aim

    def _fix_problems(self, stamp: int) -> tuple[str, ...]:
        lost = self._reckoning.age('fix', stamp) > SENSOR_TIMEOUT_S
        return ('fix lost: the position is dead-reckoned',) if lost else ()
