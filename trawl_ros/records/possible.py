# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bounds of what a ship's instruments can report; values beyond them are not readings."""

import math
from collections.abc import Mapping

from trawl_ros.records.samples import Sample
from trawl_ros.records.sensors import SENSORS

COMPASS_DEG = (-180.0, 360.0)
"""Range of compass angles: loggers write 0 to 360 or -180 to 180."""

COMPASS_SLACK_DEG = 1e-9
"""Allowance for the rounding of an angle that was converted to radians."""


def impossible(sample: Sample) -> str | None:
    """Return which value of a sample is impossible, with its bounds; None if all are possible.

    NaN means no reading and is accepted.
    """
    # One by one: a norm with an unknown part is unknown, whatever the others are.
    for field in SENSORS[sample.topic].fields:
        value = field.get(sample) / field.scale
        if value < field.low or value > field.high:
            return f'{field.name} beyond {field.low:g} to {field.high:g} {field.unit}'
    return None


def impossible_fields(fields: Mapping[str, float]) -> str | None:
    """Return why a compass angle (rad) of a topic is impossible; None if all are possible."""
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
