# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fields of samples for logs and sentences: conversion between samples and single numbers.

Values are SI. A compass angle is clockwise from north; a depth stands for the pressure there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from trawl_ros.core.quantity import Quantity, check_quantity, check_unit, in_si
from trawl_ros.core.schema import Record
from trawl_ros.core.units import UNITS
from trawl_ros.records.registry import Sensor, changed, with_numbers
from trawl_ros.records.samples import Sample
from trawl_ros.records.sensors import INSTRUMENTS, SENSORS

_COMPASS: dict[str, dict[str, str]] = {
    'vessel/velocity_ground': {'speed': 'speed', 'compass_course': 'angle'},
    'vessel/heading': {'compass_heading': 'angle'},
    'vessel/fix': {'latitude': 'angle', 'longitude': 'angle'},
}
"""Fields of topics whose samples hold other numbers than logs and sentences."""


def _fields(row: Sensor[Sample]) -> dict[str, str]:
    own = {field.name: field.quantity for field in row.fields if field.quantity}
    depth = {'depth': 'length'} if any(field.is_pressure for field in row.fields) else {}
    return _COMPASS.get(row.name, own | depth)


FIELDS = {row.name: fields for row in INSTRUMENTS if (fields := _fields(row))}
"""Fields of each topic that a log or a sentence can provide, with their quantities."""

_NOISE = {'vessel/fix': 'length', 'vessel/heading': 'angle'}

STD_QUANTITIES = {
    name: _NOISE.get(name) or next(iter(fields.values()))
    for name, fields in FIELDS.items()
    if SENSORS[name].states_noise
}
"""Topics whose messages state their noise, with its quantity."""

RANGE_TOPICS = tuple(name for name in FIELDS if SENSORS[name].is_range)


class WaterColumn(Record):
    """Conversion of depths into absolute pressures: surface + density x gravity x depth."""

    density_kg_m3: Annotated[float, Field(gt=900, lt=1100)]
    gravity_m_s2: Annotated[float, Field(gt=9.7, lt=9.9)] = 9.80665
    surface_pressure_pa: Annotated[float, Field(gt=8e4, lt=1.2e5)] = 101_325.0

    def pressure(self, depth: float) -> float:
        """Convert a depth (m) into an absolute pressure (Pa)."""
        return self.surface_pressure_pa + self.depth_to_difference(depth)

    def depth(self, pressure: float) -> float:
        """Convert an absolute pressure (Pa) into a depth (m)."""
        return (pressure - self.surface_pressure_pa) / (self.density_kg_m3 * self.gravity_m_s2)

    def depth_to_difference(self, depth: float) -> float:
        """Convert a difference in depth (m) into one in pressure (Pa)."""
        return self.density_kg_m3 * self.gravity_m_s2 * depth


@dataclass(frozen=True)
class Stated:
    """Noise that a sensor states, and, for a distance, its limits; SI."""

    std: float = 0.0
    min_range: float = 0.0
    max_range: float = 0.0


class StatedTopic(Record):
    """Noise and limits of a topic as a file states them; only distances have limits."""

    std: Quantity | None = None
    min_range: Quantity | None = None
    max_range: Quantity | None = None

    def si(self, topic: str, water: WaterColumn | None) -> Stated:
        """Return noise and limits in SI units; a depth gauge's noise in metres becomes pressure."""
        std = in_si(self.std)
        in_metres = self.std is not None and UNITS[self.std.unit].quantity == 'length'
        if water and in_metres and STD_QUANTITIES.get(topic) == 'pressure':
            std = water.depth_to_difference(std)
        high = in_si(self.max_range)
        if self.max_range is None and topic in RANGE_TOPICS:
            # Without a stated limit all readings are used that any instrument can report.
            high = SENSORS[topic].fields[0].high
        return Stated(std, in_si(self.min_range), high)

    def check(self, topic: str, *, has_water: bool = True) -> None:
        """Reject settings that do not suit a topic; with water, pressure noise may be in metres.

        Raises
        ------
        ValueError
            Naming the key, what was found and what was expected.
        """
        where = f'topics.{topic}'
        self._check_std(where, STD_QUANTITIES.get(topic), has_water)
        for name, limit in (('min_range', self.min_range), ('max_range', self.max_range)):
            if limit is not None and topic not in RANGE_TOPICS:
                raise ValueError(f'{where}.{name}: given, expected none: it measures no distance')
            if limit is not None:
                check_quantity(f'{where}.{name}', limit, 'length')
        low, high = self.min_range, self.max_range
        if low and high and low.si() >= high.si():
            raise ValueError(
                f'{where}.max_range: found {high.value:g} {high.unit}, '
                f'expected more than min_range ({low.value:g} {low.unit})'
            )

    def _check_std(self, where: str, quantity: str | None, has_water: bool) -> None:
        if self.std is None:
            return
        if quantity is None:
            raise ValueError(f'{where}.std: given, expected none: its messages cannot state it')
        if self.std.value <= 0:
            raise ValueError(f'{where}.std.value: found {self.std.value:g}, expected more than 0')
        # A depth gauge is specified in metres as often as in pascals.
        in_metres = UNITS.get(self.std.unit, ('',))[0] == 'length'
        if not (quantity == 'pressure' and has_water and in_metres):
            check_unit(f'{where}.std.unit', self.std.unit, quantity)


def sample_of_fields(
    topic: str,
    stamp: int,
    readings: Mapping[str, float],
    stated: Stated,
    water: WaterColumn | None,
) -> Sample | None:
    """Assemble the sample of a topic from its fields.

    Parameters
    ----------
    topic
        Relative name, one of `FIELDS`.
    stamp
        Time of sampling, ns.
    readings
        Values by field; NaN, or no entry, is a missing one.
    stated
        Noise and limits for the message.
    water
        Needed where a field is a depth.

    Returns
    -------
    Sample or None
        None if there is no reading for it. A winch sample with some of its readings has NaN for
        the others.
    """
    row = SENSORS[topic]
    missing = [math.isnan(value) for value in readings.values()]
    if all(missing) if row.partial else any(missing):
        return None
    own = _own_numbers(topic, readings)
    if water and 'depth' in readings:
        own['pressure'] = water.pressure(readings['depth'])
    numbers = {field: own[field.name] for field in row.fields if field.name in own}
    sample = changed(with_numbers(row.blank, numbers), stamp=stamp)
    said = {name: value for name, value in vars(stated).items() if hasattr(sample, name)}
    return changed(sample, **said)


def fields_of_sample(
    sample: Sample, water: WaterColumn | None = None
) -> tuple[str, dict[str, float]] | None:
    """Split a sample into its topic and fields: the reverse of `sample_of_fields`.

    Returns
    -------
    tuple or None
        Relative name and values by field, NaN where there is none; None for samples that are not
        numbers, as images.
    """
    topic = sample.topic
    if topic not in FIELDS:
        return None
    row = SENSORS[topic]
    own = {field.name: field.get(sample) for field in row.fields}
    if row.is_range and not math.isfinite(own['distance']):
        # REP-117: infinite is no echo.
        own['distance'] = math.nan
    if water and 'pressure' in own:
        own['depth'] = water.depth(own['pressure'])
    logged = _logged_numbers(topic, own)
    return topic, {name: logged[name] for name in FIELDS[topic] if name in logged}


def _own_numbers(topic: str, logged: Mapping[str, float]) -> dict[str, float]:
    """Convert the numbers of a log into those of the sample."""
    match topic:
        case 'vessel/velocity_ground':
            speed, course = logged['speed'], logged['compass_course']
            return {'east': speed * math.sin(course), 'north': speed * math.cos(course)}
        case 'vessel/heading':
            # From clockwise from north to counter-clockwise from east, -π to π.
            yaw = math.remainder(0.5 * math.pi - logged['compass_heading'], 2.0 * math.pi)
            return {'heading': yaw}
        case 'vessel/fix':
            return {name: math.degrees(value) for name, value in logged.items()}
    return dict(logged)


def _logged_numbers(topic: str, own: Mapping[str, float]) -> Mapping[str, float]:
    """Convert the numbers of a sample into those of a log."""
    match topic:
        case 'vessel/velocity_ground':
            course = math.atan2(own['east'], own['north']) % (2.0 * math.pi)
            return {'speed': math.hypot(own['east'], own['north']), 'compass_course': course}
        case 'vessel/heading':
            return {'compass_heading': (0.5 * math.pi - own['heading']) % (2.0 * math.pi)}
        case 'vessel/fix':
            return {name: math.radians(value) for name, value in own.items()}
    return own
