"""Drift of a ship in a current, and the heading that compensates it."""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray

MOST_DRIFT = 0.8
"""Greatest part of the ship's speed that is spent against the current."""


@dataclass(frozen=True)
class Way:
    """Motion of a ship: ``speed`` through the water (m/s), ``current`` (2,) to the east and north
    (m/s), and the rate (rad/s) at which she turns.
    """

    speed: float
    current: FloatArray
    turn: float

    def heading_on(self, course: float) -> float:
        """Heading on which the ship makes good a course; both ENU yaw, rad."""
        if self.speed <= 0.0:
            return course
        east, north = self.current
        across = (north * math.cos(course) - east * math.sin(course)) / self.speed
        return course - math.asin(min(max(across, -MOST_DRIFT), MOST_DRIFT))

    def turned(self, before: float, after: float, response: float) -> FloatArray:
        """Displacement (2,), east and north over ground, m, during a turn between two headings.

        Parameters
        ----------
        before, after
            Headings, ENU yaw, rad; she turns the shorter way.
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
