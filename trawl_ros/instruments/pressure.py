# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pressure sensors of doors and trawl sonar."""

from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.parameters import PressureParameters
from trawl_ros.records.samples import PressureSample
from trawl_ros.records.surroundings import PressureAt


class PressureInstrument(Instrument[float, PressureSample]):
    """Pressure sensor; it observes its depth (m, positive down) and reports absolute pressure.

    Above the surface it reports the pressure at the surface.
    """

    def __init__(
        self,
        name: str,
        place: str,
        parameters: PressureParameters,
        pressure_at: PressureAt,
        draws: SeedPlan,
    ) -> None:
        super().__init__(name, parameters.timing(), {'pressure': parameters.model()}, draws)
        self._place = place
        self._pressure_at = pressure_at

    def _read(self, part: float, stamp: int) -> PressureSample:
        # This comparison keeps NaN: an unknown depth must not become a reading at the surface.
        depth = 0.0 if part < 0.0 else part
        pressure = self._measure('pressure', float(self._pressure_at(depth)), stamp)
        return PressureSample(stamp, self._place, pressure, self._stated_std('pressure'))
