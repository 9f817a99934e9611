"""Bounds of what instruments of a ship can report; a value beyond them is no reading."""

import math
from collections.abc import Iterator, Mapping

from trawl_ros.records.samples import (
    AttitudeSample,
    FixSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)

DEEPEST_M = 12_000.0
FASTEST_M_S = 60.0
LEAST_PA = 5e3
"""Absolute pressure is more even in thin air; gauge pressure begins at 0."""
MOST_PA = 1.3e8
LEAST_N = -5e4
"""Zero error of a load cell."""
MOST_N = 1e7
COMPASS_DEG = (-180.0, 360.0)
"""Loggers write compass angles from 0 to 360 or from -180 to 180."""

COMPASS_SLACK_DEG = 1e-9
"""Rounding of an angle that was converted to radians."""


def impossible(sample: Sample) -> str | None:
    """Say what a sample has that cannot be, with the bounds; None where all can be.

    NaN stands for no reading, and passes.
    """
    for quantity, value, low, high, unit in _bounded(sample):
        if value < low or value > high:
            return f'{quantity} beyond {low:g} to {high:g} {unit}'
    return None


def impossible_fields(fields: Mapping[str, float]) -> str | None:
    """Say that a compass angle (rad) among the fields of a topic cannot be; None where all can."""
    low, high = COMPASS_DEG
    # A sample keeps its angle within one turn, so only the field shows it.
    for name, value in fields.items():
        degrees = math.degrees(value)
        if (
            name.startswith('compass_')
            and not math.isnan(degrees)
            and not (low - COMPASS_SLACK_DEG <= degrees <= high + COMPASS_SLACK_DEG)
        ):
            return f'compass angle beyond {low:g} to {high:g} degrees'
    return None


def _bounded(sample: Sample) -> Iterator[tuple[str, float, float, float, str]]:
    match sample:
        case FixSample():
            yield 'latitude', sample.latitude, -90.0, 90.0, 'degrees'
            yield 'longitude', sample.longitude, -180.0, 180.0, 'degrees'
        case VelocitySample():
            # One by one: a norm with an unknown part is unknown, whatever the others are.
            for component in sample.velocity:
                yield 'speed', abs(float(component)), 0.0, FASTEST_M_S, 'm/s'
        case RangeSample():
            least = -100.0 if sample.what == 'depth' else 0.0
            yield 'distance', sample.distance, least, DEEPEST_M, 'm'
        case PressureSample():
            yield 'absolute pressure', sample.pressure, LEAST_PA, MOST_PA, 'Pa'
        case AttitudeSample():
            yield 'pitch', math.degrees(sample.pitch), -90.0, 90.0, 'degrees'
            yield 'roll', math.degrees(sample.roll), -180.0, 180.0, 'degrees'
        case WinchSample():
            for length in sample.lengths:
                yield 'warp length', length, -100.0, DEEPEST_M, 'm'
            for tension in sample.tensions:
                yield 'tension', tension, LEAST_N, MOST_N, 'N'
