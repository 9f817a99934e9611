# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pose of the ship, from truth or from fixes and compass, and her track from above."""

import math

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.geodesy import Datum, to_east_north
from trawl_ros.core.rotations import about_z
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import FixSample
from trawl_ros.view.records import Fix, ShipPose

TRUTH_HOLDS_S = 10.0
"""Silence of truth after which readings move the ship."""

MOST_POINTS = 400
LEAST_SPACING_M = 3.0


class ShipFollower:
    """Newest pose of the ship.

    The first fix is placed where she was then, or at the origin: readings do not say where ``map``
    is on Earth.
    """

    def __init__(self) -> None:
        self.pose = ShipPose(0, np.zeros(3), 0.0)
        self._heading = 0.0
        self._true_stamp: int | None = None
        self._datum: tuple[Datum, FloatArray] | None = None

    def truth(self, stamp: int, position: FloatArray, heading: float) -> ShipPose:
        """Take her true pose."""
        self._true_stamp = stamp
        self.pose = ShipPose(stamp, position, heading)
        return self.pose

    def heading(self, heading: float) -> None:
        """Take the compass (ENU yaw, rad)."""
        if math.isfinite(heading):
            self._heading = heading

    def fix(self, sample: FixSample) -> tuple[Fix, ShipPose | None] | None:
        """Take a fix; return its place, and the pose if there is no truth."""
        if not (math.isfinite(sample.latitude) and math.isfinite(sample.longitude)):
            return None
        if self._datum is None:
            self._datum = Datum(sample.latitude, sample.longitude), self.pose.position
        datum, origin = self._datum
        latitudes, longitudes = np.array([sample.latitude]), np.array([sample.longitude])
        (east,), (north,) = to_east_north(latitudes, longitudes, datum)
        position = origin * [1.0, 1.0, 0.0] + [float(east), float(north), 0.0]
        fix = Fix(sample.stamp, position)
        known = self._true_stamp
        if known is not None and abs(sample.stamp - known) <= TRUTH_HOLDS_S * SECOND:
            return fix, None
        self.pose = ShipPose(sample.stamp, position, self._heading)
        return fix, self.pose

    def in_map(self, points: FloatArray) -> FloatArray:
        """Convert points (n, 3) in frame ``vessel`` to ``map``."""
        turned: FloatArray = points @ about_z(self.pose.heading).T + self.pose.position
        return turned


class Track:
    """Track that is thinned out as it grows: a day at sea takes no more points than an hour."""

    def __init__(self) -> None:
        self._points: list[FloatArray] = []
        self._spacing = LEAST_SPACING_M

    def take(self, point: FloatArray) -> FloatArray | None:
        """Take a place (2,); return the track (n, 2) if it has grown, else None."""
        if self._points and np.hypot(*(point - self._points[-1])) < self._spacing:
            return None
        self._points.append(point)
        if len(self._points) > MOST_POINTS:
            del self._points[1::2]
            self._spacing *= 2.0
        return np.array(self._points)
