"""Distances: what spread sensors and a sonar's operator report."""

import math

from trawl_ros.instruments.instrument import Draws, Instrument
from trawl_ros.instruments.parameters import RangeParameters
from trawl_ros.instruments.samples import RangeSample


class RangeInstrument(Instrument[float, RangeSample]):
    """Sees a distance (m) and reports it; out of its limits it reports ±infinity (REP-117)."""

    def __init__(self, name: str, what: str, parameters: RangeParameters, draws: Draws) -> None:
        super().__init__(name, parameters.rate_hz, {'distance': parameters.model()}, draws)
        self._what = what
        self._limits = parameters.min_range_m, parameters.max_range_m

    def _read(self, part: float, stamp: int) -> RangeSample:
        low, high = self._limits
        distance = self._measure('distance', part, stamp)
        if distance > high:
            distance = math.inf
        elif distance < low:
            distance = -math.inf
        return RangeSample(stamp, self._what, distance, self._stated_std('distance'), low, high)
