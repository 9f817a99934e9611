"""Fields of samples, as logs and sentences have them: single numbers of one topic, and back.

Values are SI. A compass angle runs clockwise from north; a depth stands for the pressure there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from trawl_ros.core.compass import compass_yaw, course_velocity, speed_course
from trawl_ros.core.quantity import Quantity, check_quantity, check_unit, in_si
from trawl_ros.core.schema import Record
from trawl_ros.core.units import UNITS
from trawl_ros.records.samples import (
    AttitudeSample,
    FixSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.records.topics import RANGES
from trawl_ros.records.truth import SIDES

_RANGE = {'distance': 'length'}
_PRESSURE = {'pressure': 'pressure', 'depth': 'length'}
_ATTITUDE = {'pitch': 'angle', 'roll': 'angle'}

FIELDS: dict[str, dict[str, str]] = {
    'winch/joint_states': {
        'port_length': 'length',
        'starboard_length': 'length',
        'port_speed': 'speed',
        'starboard_speed': 'speed',
        'port_tension': 'force',
        'starboard_tension': 'force',
    },
    'door/port/pressure': _PRESSURE,
    'door/starboard/pressure': _PRESSURE,
    'sonar/pressure': _PRESSURE,
    'door/port/attitude': _ATTITUDE,
    'door/starboard/attitude': _ATTITUDE,
    **dict.fromkeys(RANGES.values(), _RANGE),
    'vessel/velocity_water': {'forward': 'speed', 'to_port': 'speed'},
    'vessel/velocity_ground': {'speed': 'speed', 'compass_course': 'angle'},
    'vessel/heading': {'compass_heading': 'angle'},
    'vessel/fix': {'latitude': 'angle', 'longitude': 'angle'},
}
"""Fields of each topic that a log or a sentence can give, with their quantities."""

STD_QUANTITIES = {
    'door/port/pressure': 'pressure',
    'door/starboard/pressure': 'pressure',
    'sonar/pressure': 'pressure',
    'door/port/attitude': 'angle',
    'door/starboard/attitude': 'angle',
    **dict.fromkeys(RANGES.values(), 'length'),
    'vessel/heading': 'angle',
    'vessel/fix': 'length',
}
"""Topics whose messages state their noise, with its quantity."""

RANGE_TOPICS = tuple(topic for topic, fields in FIELDS.items() if fields is _RANGE)

_WINCH_READINGS = ('length', 'speed', 'tension')
_QUANTITIES = {topic: quantity for quantity, topic in RANGES.items()}


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
    """Statement of a sensor about itself: its noise and, of a distance, its limits; SI."""

    std: float = 0.0
    min_range: float = 0.0
    max_range: float = 0.0


class StatedTopic(Record):
    """Noise and limits of a topic as a file states them; limits of distances only."""

    std: Quantity | None = None
    min_range: Quantity | None = None
    max_range: Quantity | None = None

    def si(self, topic: str, water: WaterColumn | None) -> Stated:
        """Give noise and limits in SI units; a depth gauge's noise in metres becomes pressure."""
        std = in_si(self.std)
        in_metres = self.std is not None and UNITS[self.std.unit].quantity == 'length'
        if water and in_metres and STD_QUANTITIES.get(topic) == 'pressure':
            std = water.depth_to_difference(std)
        return Stated(std, in_si(self.min_range), in_si(self.max_range))

    def check(self, topic: str, *, has_water: bool = True) -> None:
        """Refuse what does not fit a topic; noise of pressure may be in metres with a water.

        Raises
        ------
        ValueError
            Naming the key, what was found and what was expected.
        """
        where = f'topics.{topic}'
        self._check_std(where, STD_QUANTITIES.get(topic), has_water)
        for name, limit in (('min_range', self.min_range), ('max_range', self.max_range)):
            if limit is None and topic in RANGE_TOPICS and name == 'max_range':
                raise ValueError(f'{where}.{name}: missing, expected a length')
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
    missing = [math.isnan(value) for value in readings.values()]
    if all(missing) if topic == 'winch/joint_states' else any(missing):
        return None
    match topic.split('/'):
        case ['winch', _]:
            return WinchSample(stamp, *(_pair(readings, quantity) for quantity in _WINCH_READINGS))
        case [*_, place, 'pressure']:
            pressure = readings.get('pressure', math.nan)
            if water and 'depth' in readings:
                pressure = water.pressure(readings['depth'])
            return PressureSample(stamp, place, pressure, stated.std)
        case ['door', side, 'attitude']:
            return AttitudeSample(stamp, side, readings['pitch'], readings['roll'], stated.std)
        case ['vessel', quantity]:
            return _vessel_sample(quantity, stamp, readings, stated.std)
    limits = (stated.min_range, stated.max_range)
    return RangeSample(stamp, _QUANTITIES[topic], readings['distance'], stated.std, *limits)


def fields_of_sample(
    sample: Sample, water: WaterColumn | None = None
) -> tuple[str, dict[str, float]] | None:
    """Take a sample apart into its topic and fields: the reverse of `sample_of_fields`.

    Returns
    -------
    tuple or None
        Relative name and values by field, NaN where there is none; None for samples that are not
        numbers, as images.
    """
    match sample:
        case WinchSample():
            columns = zip(
                _WINCH_READINGS, (sample.lengths, sample.speeds, sample.tensions), strict=True
            )
            return 'winch/joint_states', {
                f'{side}_{quantity}': value
                for quantity, pair in columns
                for side, value in zip(SIDES, pair, strict=True)
            }
        case PressureSample():
            place = sample.place
            topic = 'sonar/pressure' if place == 'sonar' else f'door/{place}/pressure'
            fields = {'pressure': sample.pressure}
            return topic, fields | ({'depth': water.depth(sample.pressure)} if water else {})
        case AttitudeSample():
            return f'door/{sample.side}/attitude', {'pitch': sample.pitch, 'roll': sample.roll}
        case RangeSample():
            # REP-117: infinite is no echo.
            distance = sample.distance if math.isfinite(sample.distance) else math.nan
            return RANGES[sample.what], {'distance': distance}
        case VelocitySample(over='water'):
            forward, to_port = float(sample.velocity[0]), float(sample.velocity[1])
            return 'vessel/velocity_water', {'forward': forward, 'to_port': to_port}
        case VelocitySample():
            speed, course = speed_course(sample.velocity)
            return 'vessel/velocity_ground', {'speed': speed, 'compass_course': course}
        case HeadingSample():
            compass = compass_yaw(sample.heading) % (2 * math.pi)
            return 'vessel/heading', {'compass_heading': compass}
        case FixSample():
            return 'vessel/fix', {
                'latitude': math.radians(sample.latitude),
                'longitude': math.radians(sample.longitude),
            }
        case _:
            return None


def _vessel_sample(quantity: str, stamp: int, readings: Mapping[str, float], std: float) -> Sample:
    match quantity:
        case 'velocity_water':
            velocity = np.array([readings['forward'], readings.get('to_port', 0.0), 0.0])
            return VelocitySample(stamp, 'water', velocity, math.nan)
        case 'velocity_ground':
            velocity = course_velocity(readings['speed'], readings['compass_course'])
            return VelocitySample(stamp, 'ground', velocity, math.nan)
        case 'heading':
            return HeadingSample(stamp, compass_yaw(readings['compass_heading']), std)
    latitude, longitude = (math.degrees(readings[field]) for field in ('latitude', 'longitude'))
    return FixSample(stamp, latitude, longitude, std)


def _pair(readings: Mapping[str, float], quantity: str) -> tuple[float, float]:
    port, starboard = (readings.get(f'{side}_{quantity}', math.nan) for side in SIDES)
    return port, starboard
