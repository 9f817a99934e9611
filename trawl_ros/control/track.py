"""Track over ground, followed by line-of-sight guidance."""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.control.drift import Way
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import ScenarioError

SHORTEST_LEG_M = 1.0

LEAST_CORNER = 0.05
"""Sine of the angle between two legs below which no turn is begun before the waypoint: they are
as good as one line, there or back."""


@dataclass(frozen=True)
class OnTrack:
    """Position of a ship relative to a track.

    ``leg`` counts from 0; ``across`` is how far she is to port of the leg and ``left`` how far it
    still goes, in m; ``course`` is the one to be steered over ground (ENU yaw, rad); ``ended``
    says that the last waypoint lies astern.
    """

    leg: int
    across: float
    left: float
    course: float
    ended: bool


class Track:
    """Track of straight legs from waypoint to waypoint.

    The course aims at a point on the leg a look-ahead before the ship (Fossen, Handbook of Marine
    Craft Hydrodynamics and Motion Control, 2021, section 12.4). A leg ends a little before its
    waypoint, so that a turn at the steady rate leads into the next one; after the last waypoint
    the ship goes on along the last leg.

    Parameters
    ----------
    waypoints : (n, 2) array
        East and north in ``map``, m; the first leg ends at the second of them.
    look_ahead
        In m.

    Raises
    ------
    ScenarioError
        If there are fewer than two waypoints, or two in a row are the same.
    """

    def __init__(self, waypoints: FloatArray, *, look_ahead: float) -> None:
        self._points = np.asarray(waypoints, dtype=float)
        if len(self._points) < 2:
            raise ScenarioError(f'a track of {len(self._points)} waypoints, expected at least two')
        legs = np.diff(self._points, axis=0)
        self._lengths = np.hypot(legs[:, 0], legs[:, 1])
        if (short := np.flatnonzero(self._lengths < SHORTEST_LEG_M)).size:
            raise ScenarioError(
                f'a leg of {self._lengths[short[0]]:.1f} m at waypoint {short[0]} of a track, '
                f'expected at least {SHORTEST_LEG_M:g} m'
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
        # Nearer than this a ship that turns slowly would not begin her turn at its full rate.
        ahead = max(self._look_ahead, 0.5 * way.speed / way.turn)
        course = self._courses[self._leg] - math.atan2(across, ahead)
        return OnTrack(self._leg, across, left, math.remainder(course, 2 * math.pi), self._ended)

    def _place(self, position: FloatArray) -> tuple[float, float]:
        """Distance along a leg and cross-track distance to port of it, m."""
        east, north = position - self._points[self._leg]
        course = self._courses[self._leg]
        cos, sin = math.cos(course), math.sin(course)
        return float(east * cos + north * sin), float(north * cos - east * sin)

    def _early(self, way: Way, response: float) -> float:
        """Distance (m) before a leg's end at which to turn, so that the turn ends on the next."""
        before, after = self._courses[self._leg], self._courses[self._leg + 1]
        apart = math.sin(after - before)
        if abs(apart) < LEAST_CORNER:
            return 0.0
        come = way.turned(way.heading_on(before), way.heading_on(after), response)
        early = float(come[0] * math.sin(after) - come[1] * math.cos(after)) / apart
        return min(max(early, 0.0), 0.5 * float(self._lengths[self._leg + 1]))
