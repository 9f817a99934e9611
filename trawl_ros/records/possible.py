"""Bounds of what instruments of a ship can report; a value beyond them is no reading."""

from trawl_ros.records.samples import SENSORS, Sample

COMPASS_DEG = (-180.0, 360.0)
"""Loggers write compass angles from 0 to 360 or from -180 to 180."""


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


def impossible_compass(degrees: float) -> str | None:
    """Say that a compass angle (degrees) cannot be; None where it can."""
    low, high = COMPASS_DEG
    return None if low <= degrees <= high else f'compass angle beyond {low:g} to {high:g} degrees'
