# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the sea water: density, current and temperature by depth."""

from itertools import pairwise
from typing import Annotated

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.numbers import NotNegative


class CurrentAt(Record):
    """Current at a depth, to the east and the north."""

    depth_m: NotNegative
    """Depth."""
    east_m_s: Annotated[float, Field(ge=-3, le=3)]
    """Current to the east."""
    north_m_s: Annotated[float, Field(ge=-3, le=3)]
    """Current to the north."""


class TemperatureAt(Record):
    """Temperature of the water at a depth."""

    depth_m: NotNegative
    """Depth."""
    temperature_deg_c: Annotated[float, Field(ge=-2, le=35)]
    """Temperature."""


class WaterRecord(Record):
    """Sea water; its density rises linearly with depth.

    Current and temperature are given at depths. Temperature and salinity determine the speed of
    sound, but not the density.
    """

    density_kg_m3: Annotated[float, Field(ge=990, le=1060)]
    """Density at the surface."""
    density_gradient_kg_m4: Annotated[float, Field(ge=0, le=0.1)] = 0.0
    """Increase of the density per metre of depth."""
    gravity_m_s2: Annotated[float, Field(ge=9.7, le=9.9)] = 9.80665
    """Gravity."""
    current: tuple[CurrentAt, ...] = ()
    """Current at depths from the surface down."""
    temperature: Annotated[tuple[TemperatureAt, ...], Field(min_length=1)] = (
        TemperatureAt(depth_m=0.0, temperature_deg_c=8.0),
    )
    """Temperature at depths, for the speed of sound alone."""
    salinity_g_kg: Annotated[float, Field(ge=0, le=42)] = 35.0
    """Absolute salinity, for the speed of sound alone."""

    @model_validator(mode='after')
    def _depths_rise(self) -> 'WaterRecord':
        for key, levels in (('current', self.current), ('temperature', self.temperature)):
            depths = [level.depth_m for level in levels]
            if any(b <= a for a, b in pairwise(depths)):
                raise ValueError(f'{key}: depths must rise, found {depths}')
        return self
