"""Bounds of what instruments of a ship can report; a value beyond them is no reading."""

import math
from collections.abc import Mapping

from trawl_ros.records.samples import SENSORS, Sample

COMPASS_DEG = (-180.0, 360.0)
"""Loggers write compass angles from 0 to 360 or from -180 to 180."""

COMPASS_SLACK_DEG = 1e-9
"""Rounding of an angle that was converted to radians."""


def impossible(sample: Sample) -> str | None:
    """Say what a sample has that cannot be, with the bounds; None where all can be.

    NaN stands for no reading, and passes.
    """
    # One by one: a norm with an unknown part is unknown, whatever the others are.
    for field in SENSORS[sample.topic].fields:
        value = field.get(sample) / field.scale
        if value < field.low or value > field.high:
            return f'{field.name} beyond {field.low:g} to {field.high:g} {field.unit}'
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
