"""Samples of instruments from the readings in a row of a table."""

import math

import numpy as np

from trawl_ros.bags.logs.compass import compass_yaw, course_velocity
from trawl_ros.bags.logs.mapping import LogWater, TopicMapping
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

_WINCH_READINGS = ('length', 'speed', 'tension')
_QUANTITIES = {topic: quantity for quantity, topic in RANGES.items()}


def table_sample(
    topic: str,
    stamp: int,
    readings: dict[str, float],
    entry: TopicMapping,
    water: LogWater | None,
) -> Sample | None:
    """Assemble the sample of a topic; None if there is no reading for it."""
    missing = [math.isnan(value) for value in readings.values()]
    std = 0.0 if entry.std is None else entry.std.si()
    if all(missing) if topic == 'winch/joint_states' else any(missing):
        return None
    match topic.split('/'):
        case ['winch', _]:
            return WinchSample(stamp, *(_pair(readings, quantity) for quantity in _WINCH_READINGS))
        case [*_, place, 'pressure']:
            if water and entry.std and UNITS[entry.std.unit].quantity == 'length':
                std = water.depth_to_difference(std)
            if water and 'depth' in readings:
                return PressureSample(stamp, place, water.pressure(readings['depth']), std)
            return PressureSample(stamp, place, readings['pressure'], std)
        case ['door', side, 'attitude']:
            return AttitudeSample(stamp, side, readings['pitch'], readings['roll'], std)
        case ['vessel', quantity]:
            return _vessel_sample(quantity, stamp, readings, std)
    limits = [limit.si() for limit in (entry.min_range, entry.max_range) if limit]
    return RangeSample(stamp, _QUANTITIES[topic], readings['distance'], std, *limits)


def _vessel_sample(quantity: str, stamp: int, readings: dict[str, float], std: float) -> Sample:
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


def _pair(readings: dict[str, float], quantity: str) -> tuple[float, float]:
    port, starboard = (readings.get(f'{side}_{quantity}', math.nan) for side in SIDES)
    return port, starboard
