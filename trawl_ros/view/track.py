"""Track of the ship from above, in so many points at most."""

import numpy as np

from trawl_ros.core.arrays import FloatArray

MOST_POINTS = 400
LEAST_SPACING_M = 3.0


class Track:
    """Track thinned out as it becomes long: a day at sea takes no more points than an hour."""

    def __init__(self) -> None:
        self._points: list[FloatArray] = []
        self._spacing = LEAST_SPACING_M

    def take(self, point: FloatArray) -> FloatArray | None:
        """Take a place (2,); return the track (n, 2) where it has become longer, else None."""
        if self._points and np.hypot(*(point - self._points[-1])) < self._spacing:
            return None
        self._points.append(point)
        if len(self._points) > MOST_POINTS:
            del self._points[1::2]
            self._spacing *= 2.0
        return np.array(self._points)
