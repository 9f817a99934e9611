# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Range sensors: distances and their limits."""

import math
from typing import TypeVar

from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.parameters import OpeningParameters, RangeParameters
from trawl_ros.records.samples import RangeSample

PartT = TypeVar('PartT')


def within_limits(distance: float, low: float, high: float) -> float:
    """Return a distance (m), or ±infinity if it is beyond the sensor's limits (REP-117)."""
    if distance > high:
        return math.inf
    return -math.inf if distance < low else distance


class RangeSensor(Instrument[PartT, RangeSample]):
    """Sensor of a distance that a subclass finds in its part of the truth.

    ``name`` is the topic, ``what`` the distance it is of.
    """

    def __init__(
        self,
        name: str,
        what: str,
        parameters: RangeParameters | OpeningParameters,
        draws: SeedPlan,
    ) -> None:
        super().__init__(name, parameters.timing(), {'distance': parameters.model()}, draws)
        self._what = what
        self._limits = parameters.min_range_m, parameters.max_range_m

    def _measured(self, distance: float, stamp: int) -> RangeSample:
        """Return the reading of a true distance, m."""
        low, high = self._limits
        distance = within_limits(self._measure('distance', distance, stamp), low, high)
        return RangeSample(stamp, self._what, distance, self._stated_std('distance'), low, high)


class RangeInstrument(RangeSensor[float]):
    """Range sensor; it observes a distance (m) and reports it."""

    def _read(self, part: float, stamp: int) -> RangeSample:
        return self._measured(part, stamp)
