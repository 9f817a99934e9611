# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Range sensors: distances and their limits."""

import math

from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.parameters import RangeParameters
from trawl_ros.records.samples import RangeSample


def within_limits(distance: float, low: float, high: float) -> float:
    """Return a distance (m), or ±infinity if it is beyond the sensor's limits (REP-117)."""
    if distance > high:
        return math.inf
    return -math.inf if distance < low else distance


class RangeInstrument(Instrument[float, RangeSample]):
    """Range sensor; it observes a distance (m) and reports it."""

    def __init__(self, name: str, what: str, parameters: RangeParameters, draws: SeedPlan) -> None:
        super().__init__(name, parameters.timing(), {'distance': parameters.model()}, draws)
        self._what = what
        self._limits = parameters.min_range_m, parameters.max_range_m

    def _read(self, part: float, stamp: int) -> RangeSample:
        low, high = self._limits
        distance = within_limits(self._measure('distance', part, stamp), low, high)
        return RangeSample(stamp, self._what, distance, self._stated_std('distance'), low, high)
