# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Check of the speed log against compass and GPS: logs that give speed over ground.

Over ground a ship moves as she does through the water and as the water does. What a true log
leaves of the velocity over ground is the current, the same on every heading. What a log over
ground leaves has no part along the heading, ever, only across it.
"""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, StampArray
from trawl_ros.estimation.windows.statistics import circular_median

Series = tuple[StampArray, FloatArray]
"""Stamps (n,) in ns and values (n,)."""

PAIRED_NS = 600_000_000
"""Readings of two instruments further apart (ns) are no pair."""

LEAST_PAIRS = 10

ALONG = 0.05
"""Speed (m/s) along the heading that errors of log and GPS make by themselves."""

SEEN_CURRENT_M_S = 0.10
"""Current (m/s) along the heading with which a log is proven to see the water."""

CURRENT_DIFFERENCE_M_S = 0.15
"""Difference (m/s) of two currents that is none of errors and leeway."""

COPY, SCATTER = 0.008, 0.015
"""A log that scatters by more than the second (m/s) and never leaves the GPS by more than the
first is the GPS: two instruments have errors of their own."""


@dataclass(frozen=True)
class GroundTrack:
    """Residual velocity over ground after subtraction of the log's speed, in one window.

    ``heading`` (ENU, rad); ``along`` it and ``across`` to port, m/s; ``copied``: whether the log
    follows the GPS speed reading by reading.
    """

    heading: float
    along: float
    across: float
    copied: bool

    @property
    def current(self) -> FloatArray:
        """Current (2,), east and north, m/s."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return np.array(
            [self.along * cos - self.across * sin, self.along * sin + self.across * cos]
        )


def ground_track(log: Series, east: Series, north: Series, heading: Series) -> GroundTrack | None:
    """Compare the log (m/s) with velocity over ground (m/s) and heading (rad); None without."""
    if min(len(east[0]), len(heading[0]), len(log[0])) < LEAST_PAIRS:
        return None
    if len(east[0]) != len(north[0]):
        return None
    nearest = np.clip(np.searchsorted(east[0], log[0]), 1, len(east[0]) - 1)
    before = log[0] - east[0][nearest - 1] < east[0][nearest] - log[0]
    nearest = np.where(before, nearest - 1, nearest)
    paired = np.abs(east[0][nearest] - log[0]) <= PAIRED_NS
    if np.count_nonzero(paired) < LEAST_PAIRS:
        return None
    speed = log[1][paired]
    ground = np.column_stack((east[1], north[1]))[nearest[paired]]
    ahead = circular_median(heading[1])
    mean, cos, sin = np.median(ground, axis=0), math.cos(ahead), math.sin(ahead)
    over_ground = np.hypot(*ground.T)
    scatter = float(np.std(np.diff(speed))) / math.sqrt(2.0)
    return GroundTrack(
        ahead,
        float(mean @ (cos, sin) - np.median(speed)),
        float(mean @ (-sin, cos)),
        scatter > SCATTER and float(np.percentile(np.abs(speed - over_ground), 90)) < COPY,
    )


class OverGround:
    """Collector of ground tracks tow by tow, until they decide whether the log is over ground."""

    def __init__(self) -> None:
        self._tow: int | None = None
        self._blind: list[GroundTrack] = []
        self._sees = False
        self._found: str | None = None

    def judge(self, tow: int, track: GroundTrack | None) -> str | None:
        """Add a window's track; return a sentence once the tow's log is known to be over ground."""
        if tow != self._tow:
            self._tow, self._blind, self._sees, self._found = tow, [], False, None
        if track is None:
            return self._found
        where = 'speed (vessel/velocity_water) is speed over ground'
        if track.copied:
            self._found = f'{where}: it follows vessel/velocity_ground reading by reading'
        elif abs(track.along) > SEEN_CURRENT_M_S:
            self._sees, self._found = True, None
        elif abs(track.along) < ALONG and not self._sees:
            for other in self._blind:
                apart = float(np.hypot(*(track.current - other.current)))
                if apart > CURRENT_DIFFERENCE_M_S:
                    self._found = (
                        f'{where}: on two headings it leaves no current along the ship, and '
                        f'across her {other.across:.2f} and {track.across:.2f} m/s'
                    )
            # Many windows of one heading tell no more than a few.
            self._blind = [*self._blind, track][-50:]
        return self._found
