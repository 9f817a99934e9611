# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the sea of a trial: heave, seabed and schools of fish."""

import math
import zlib
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.water import Water, build_water
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.simulation.heave import Heave, irregular_heave, regular_heave
from trawl_ros.simulation.sea import School, Sea
from trawl_ros.simulation.seabed import Seabed

Degrees = Annotated[float, Field(ge=-360, le=360)]
Place = Annotated[float, Field(ge=-500_000, le=500_000)]
Extent = Annotated[float, Field(gt=0, le=5000)]
Swimming = Annotated[float, Field(ge=-3, le=3)]


class HeaveRecord(Record):
    """Heave of the ship.

    For ``irregular``, ``height_m`` is the significant height of the heave (not of the waves) and
    ``period_s`` the peak period of its spectrum. For ``regular``, they are the height from trough
    to crest and the period of a sine. Periods are those of encounter.
    """

    kind: Literal['irregular', 'regular'] = 'irregular'
    height_m: Annotated[float, Field(gt=0, le=8)]
    period_s: Annotated[float, Field(ge=5, le=30)]
    begin_minutes: Annotated[float, Field(ge=0, le=10_000)] = 0.0
    growth_minutes: Annotated[float, Field(ge=0.25, le=10_000)] = 0.5


class DepthRecord(Record):
    """Depth of the seabed at a distance from the start of the ship."""

    distance_m: Place
    depth_m: Annotated[float, Field(ge=10, le=11_000)]


class SeabedRecord(Record):
    """Profile of the seabed along a direction of ``map`` (ENU yaw), level across it.

    Depth is interpolated linearly between points and constant beyond them.
    """

    direction_deg: Degrees = 0.0
    profile: Annotated[tuple[DepthRecord, ...], Field(min_length=1, max_length=1000)]

    @model_validator(mode='after')
    def _distances_rise(self) -> 'SeabedRecord':
        distances = [point.distance_m for point in self.profile]
        if any(b <= a for a, b in pairwise(distances)):
            raise ValueError(f'profile: found distances {distances}, expected increasing distances')
        return self


class SchoolRecord(Record):
    """School of fish, an ellipsoid with its centre at the start of the trial.

    It drifts with the current at its depth and swims through the water.
    """

    east_m: Place
    north_m: Place
    depth_m: Annotated[float, Field(gt=0, le=3000)]
    size_east_m: Extent
    size_north_m: Extent
    size_up_m: Extent
    density_per_m3: Annotated[float, Field(gt=0, le=1000)]
    swims_east_m_s: Swimming = 0.0
    swims_north_m_s: Swimming = 0.0

    @model_validator(mode='after')
    def _under_water(self) -> 'SchoolRecord':
        if 0.5 * self.size_up_m > self.depth_m:
            raise ValueError(
                f'depth_m: found {self.depth_m:g}, expected at least half of size_up_m '
                f'({self.size_up_m:g}), because fish stay in the water'
            )
        return self


class SeaRecord(Record):
    """Surroundings of the ship; by default a calm, bottomless and empty sea."""

    heave: HeaveRecord | None = None
    seabed: SeabedRecord | None = None
    schools: Annotated[tuple[SchoolRecord, ...], Field(max_length=100)] = ()


def build_sea(record: SeaRecord, water: Water, seed: int) -> Sea:
    """Build the sea of a record.

    Parameters
    ----------
    record
        Record of the scenario file.
    water
        Water, whose current moves the schools.
    seed
        Seed of the trial; waves use their own random generator.
    """
    return Sea(
        heave=_heave(record.heave, seed),
        seabed=_seabed(record.seabed),
        schools=tuple(_school(school, water) for school in record.schools),
    )


def _heave(record: HeaveRecord | None, seed: int) -> Heave:
    if record is None:
        return Heave()
    begin, growth = 60.0 * record.begin_minutes, 60.0 * record.growth_minutes
    if record.kind == 'regular':
        return regular_heave(record.height_m, record.period_s, begin=begin, growth=growth)
    key = zlib.crc32(b'sea/heave')
    draws = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(key,)))
    return irregular_heave(record.height_m, record.period_s, draws, begin=begin, growth=growth)


def _seabed(record: SeabedRecord | None) -> Seabed:
    if record is None:
        return Seabed()
    return Seabed(
        math.radians(record.direction_deg),
        np.array([point.distance_m for point in record.profile]),
        np.array([point.depth_m for point in record.profile]),
    )


def _school(record: SchoolRecord, water: Water) -> School:
    swimming = np.array([record.swims_east_m_s, record.swims_north_m_s, 0.0])
    return School(
        position=np.array([record.east_m, record.north_m, -record.depth_m]),
        size=np.array([record.size_east_m, record.size_north_m, record.size_up_m]),
        density=record.density_per_m3,
        velocity=water.current(np.array(-record.depth_m)) + swimming,
    )


def build_surroundings(gear: GearRecord) -> Surroundings:
    """Build the record of the water for the instruments."""
    return Surroundings(
        build_water(gear).pressure,
        tuple((level.depth_m, level.temperature_deg_c) for level in gear.water.temperature),
        gear.water.salinity_g_kg,
    )
