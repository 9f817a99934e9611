"""Autopilot: steers a heading, a course over ground, a track, or toward a school of fish."""

import math
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.control.bearings import LOST_S, Bearings, NavigationSample
from trawl_ros.control.drift import Way
from trawl_ros.control.track import Track
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.geodesy import Datum

GAIN_PER_S = 0.05
"""Rate of turn per angle that is left: 0.15 deg/s at 3 degrees."""

BRAKING = 0.5
"""Share of the greatest turn acceleration used to end a turn."""

RESPONSE_S = 15.0
"""Delay of a turn into a leg against its full rate: to begin, and to end gently."""

BEGUN_M = 100.0
"""A ship this near to the first waypoint of a track begins with the leg from there."""

PASSED_M = 150.0
"""A school as near as this is not aimed at any more: the ship goes on over it."""

SEEN_SHARE = 0.4
"""Filter gain of a sweep's position: the fish sonar's bearing wavers by degrees."""

SAME_SCHOOL_M = 500.0
"""A school seen this near to where one was aimed at is the same."""


@dataclass(frozen=True)
class AutopilotSettings:
    """Settings of an autopilot.

    ``max_turn`` is the fastest rate of turn (rad/s), which the gear must be able to follow: in a
    faster turn it loses speed, so that its doors lose their lift and it sinks;
    ``turn_acceleration`` how fast the ship takes it up (rad/s²); ``look_ahead`` how far ahead on a
    track is aimed (m).
    """

    max_turn: float = math.radians(0.15)
    turn_acceleration: float = math.radians(0.05)
    look_ahead: float = 300.0


@dataclass(frozen=True)
class HoldHeading:
    """Target: a heading by compass, ENU yaw, rad."""

    heading: float


@dataclass(frozen=True)
class HoldCourse:
    """Target: a course over ground, whatever the current, ENU yaw, rad."""

    course: float


@dataclass(frozen=True)
class FollowTrack:
    """Target: a track over ``waypoints`` (n, 2), east and north in ``map``, m."""

    waypoints: FloatArray


@dataclass(frozen=True)
class ToSchool:
    """Target: the nearest school ahead that the fish sonar sees, and straight on from there."""


Target = HoldHeading | HoldCourse | FollowTrack | ToSchool


@dataclass(frozen=True)
class AutopilotState:
    """Report of an autopilot at one instant.

    Angles in rad, ENU yaw; NaN where something is not known or not meant: ``wanted`` heading,
    ``course`` wanted over ground, ``across`` (m to port of the leg), ``left`` (m of it);
    ``ended`` says that the last waypoint lies astern.
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
    """Autopilot: computes the rate of turn that steers the ship to its target.

    Parameters
    ----------
    settings
        Limits of the rate of turn, and the look-ahead.
    datum
        Origin of ``map``, from which fixes are counted.

    Attributes
    ----------
    state : AutopilotState
        As of the last call of `turn_rate`.
    """

    def __init__(self, settings: AutopilotSettings, datum: Datum) -> None:
        self.settings = settings
        self.state = AutopilotState()
        self._bearings = Bearings(datum)
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
        """Update the bearings by a sensor's sample."""
        self._bearings.take(sample)

    def turn_rate(self, stamp: int) -> float:
        """Return the wanted rate of turn (rad/s, to port positive) at a stamp (ns)."""
        heading = self._bearings.heading
        age = self._bearings.age('heading', stamp)
        if heading is None or age > LOST_S:
            self._rate = 0.0
            self.state = AutopilotState(problems=('heading lost: goes straight on',))
            return 0.0
        state = self._guide(stamp, heading)
        # Between two samples the ship turns on.
        left = math.remainder(state.wanted - heading - self._rate * age, 2 * math.pi)
        self._rate = self._towards(left)
        self.state = replace(state, turn_rate=self._rate)
        return self._rate

    def _towards(self, angle: float) -> float:
        settings = self.settings
        braking = math.sqrt(2 * BRAKING * settings.turn_acceleration * abs(angle))
        return math.copysign(min(settings.max_turn, GAIN_PER_S * abs(angle), braking), angle)

    def _guide(self, stamp: int, heading: float) -> AutopilotState:
        if isinstance(self._target, HoldHeading):
            return AutopilotState(wanted=self._target.heading)
        if isinstance(self._target, HoldCourse):
            return self._against_current(self._target.course, stamp)
        position = self._bearings.position(stamp)
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
        """State with the heading on which the ship makes good a course in the current."""
        self._course = course
        for what, name in (('ground', 'velocity over ground'), ('water', 'speed log')):
            if self._bearings.age(what, stamp) > LOST_S:
                problems += (f'{name} lost: the current is taken as it was',)
        wanted = self._way.heading_on(course)
        return AutopilotState(wanted=wanted, course=course, problems=problems)

    @property
    def _way(self) -> Way:
        bearings = self._bearings
        return Way(bearings.speed, bearings.current, self.settings.max_turn)

    def _without_place(self, stamp: int, heading: float) -> AutopilotState:
        course = heading if math.isnan(self._course) else self._course
        return self._against_current(course, stamp, ('fix lost: holds the course',))

    def _along(self, waypoints: FloatArray, position: FloatArray, stamp: int) -> AutopilotState:
        if self._track is None:
            begun = len(waypoints) > 1 and np.hypot(*(waypoints[0] - position)) < BEGUN_M
            points = waypoints if begun else np.vstack([position, waypoints])
            self._track = Track(points, look_ahead=self.settings.look_ahead)
        guidance = self._track.follow(position, self._way, RESPONSE_S)
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
            return self._against_current(course, stamp, ('no school ahead: holds the course',))
        away = aim - position
        distance = float(np.hypot(*away))
        if distance > PASSED_M and not self._passed:
            self._course = math.atan2(away[1], away[0])
        else:
            self._passed = True
        state = self._against_current(self._course, stamp, self._fix_problems(stamp))
        return replace(state, left=distance, ended=self._passed)

    def _aim_at(self, position: FloatArray, heading: float) -> FloatArray | None:
        """Place of the chosen school, or of the nearest ahead if none is chosen yet."""
        schools = self._bearings.schools
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
            elif distances.min() < SAME_SCHOOL_M and self._bearings.schools is not self._seen:
                self._aim = self._aim + SEEN_SHARE * (nearest - self._aim)
            self._seen = self._bearings.schools
        return self._aim

    def _fix_problems(self, stamp: int) -> tuple[str, ...]:
        lost = self._bearings.age('fix', stamp) > LOST_S
        return ('fix lost: the place is reckoned',) if lost else ()
