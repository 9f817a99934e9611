# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Track over ground, followed by line-of-sight guidance in a current."""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import ScenarioError

MIN_LEG_M = 1.0

MIN_CORNER_SINE = 0.05
"""Sine of the angle between two legs below which no turn begins before the waypoint, because the
legs are nearly one line."""

MAX_CROSS_CURRENT_RATIO = 0.8
"""Largest part of the ship's speed that compensates a cross current."""


@dataclass(frozen=True)
class Way:
    """Motion of a ship.

    ``speed`` is through the water (m/s), ``current`` (2,) to the east and north (m/s), and ``turn``
    the rate of turn (rad/s).
    """

    speed: float
    current: FloatArray
    turn: float

    def heading_on(self, course: float) -> float:
        """Return the heading on which the ship makes good a course; both ENU yaw, rad."""
        if self.speed <= 0.0:
            return course
        east, north = self.current
        # The current across the course must equal the ship's own speed across it.
        across = (north * math.cos(course) - east * math.sin(course)) / self.speed
        return course - math.asin(
            min(max(across, -MAX_CROSS_CURRENT_RATIO), MAX_CROSS_CURRENT_RATIO)
        )

    def turned(self, before: float, after: float, response: float) -> FloatArray:
        """Return the displacement (2,) over ground, east and north, m, in a turn.

        Parameters
        ----------
        before, after
            Headings, ENU yaw, rad; the ship turns the shorter way.
        response
            Delay before the ship begins to turn, s.
        """
        angle = math.remainder(after - before, 2 * math.pi)
        rate = math.copysign(self.turn, angle)
        radius = self.speed / rate
        arc = radius * np.array(
            [math.sin(after) - math.sin(before), math.cos(before) - math.cos(after)]
        )
        straight = self.speed * response * np.array([math.cos(before), math.sin(before)])
        return arc + straight + self.current * (angle / rate + response)


@dataclass(frozen=True)
class OnTrack:
    """Position of a ship relative to a track.

    ``leg`` counts from 0. ``across`` is the distance to port of the leg and ``left`` the distance
    to its end, m. ``course`` is the wanted course over ground (ENU yaw, rad). ``ended`` is True
    after the last waypoint.
    """

    leg: int
    across: float
    left: float
    course: float
    ended: bool


class Track:
    """Track of straight legs from waypoint to waypoint.

    The course aims at a point on the leg, a look-ahead distance ahead of the ship (Fossen, Handbook
    of Marine Craft Hydrodynamics and Motion Control, 2021, section 12.4). A leg ends before its
    waypoint, so that a turn at the steady rate leads into the next one. After the last waypoint
    the ship continues along the last leg.

    Parameters
    ----------
    waypoints : (n, 2) array
        East and north in ``map``, m; the first leg ends at the second of them.
    look_ahead
        Look-ahead distance, m.

    Raises
    ------
    ScenarioError
        If there are fewer than two waypoints, or two in a row are the same.
    """

    def __init__(self, waypoints: FloatArray, *, look_ahead: float) -> None:
        self._points = np.asarray(waypoints, dtype=float)
        if len(self._points) < 2:
            raise ScenarioError(
                f'found a track of {len(self._points)} waypoints, expected at least two'
            )
        legs = np.diff(self._points, axis=0)
        self._lengths = np.hypot(legs[:, 0], legs[:, 1])
        if (short := np.flatnonzero(self._lengths < MIN_LEG_M)).size:
            raise ScenarioError(
                f'found a leg of {self._lengths[short[0]]:.1f} m at waypoint {short[0]} of a '
                f'track, expected at least {MIN_LEG_M:g} m'
            )
        self._courses = np.arctan2(legs[:, 1], legs[:, 0])
        self._look_ahead = look_ahead
        self._leg = 0
        self._ended = False

    @property
    def courses(self) -> tuple[float, ...]:
        """Course of each leg, ENU yaw, rad."""
        return tuple(self._courses.tolist())

    def follow(self, position: FloatArray, way: Way, response: float) -> OnTrack:
        """Return the course and the position relative to the track.

        Parameters
        ----------
        position : (2,) array
            East and north of the ship, m.
        way
            Motion of the ship.
        response
            Delay before a turn takes effect, s.
        """
        last = len(self._lengths) - 1
        along, across = self._place(position)
        while self._leg < last and self._lengths[self._leg] - along <= self._early(way, response):
            self._leg += 1
            along, across = self._place(position)
        left = float(self._lengths[self._leg] - along)
        self._ended = self._ended or (self._leg == last and left <= 0.0)
        # With a shorter look-ahead a slowly turning ship would overshoot the leg.
        ahead = max(self._look_ahead, 0.5 * way.speed / way.turn)
        course = self._courses[self._leg] - math.atan2(across, ahead)
        return OnTrack(self._leg, across, left, math.remainder(course, 2 * math.pi), self._ended)

    def _place(self, position: FloatArray) -> tuple[float, float]:
        """Return the distance along a leg and the cross-track distance to port of it, m."""
        east, north = position - self._points[self._leg]
        course = self._courses[self._leg]
        cos, sin = math.cos(course), math.sin(course)
        return float(east * cos + north * sin), float(north * cos - east * sin)

    def _early(self, way: Way, response: float) -> float:
        """Return the distance (m) before a leg's end at which to turn into the next leg."""
        before, after = self._courses[self._leg], self._courses[self._leg + 1]
        apart = math.sin(after - before)
        if abs(apart) < MIN_CORNER_SINE:
            return 0.0
        # Displacement of the turn in the basis of both courses: its part along the old leg.
        come = way.turned(way.heading_on(before), way.heading_on(after), response)
        early = float(come[0] * math.sin(after) - come[1] * math.cos(after)) / apart
        return min(max(early, 0.0), 0.5 * float(self._lengths[self._leg + 1]))
