"""Patterns of a channel's residuals, whatever their cause: a few simple shapes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.records.channels import MEASURED

VARIABLES = ('warp length', 'warp length²', 'speed', 'warp length × speed', 'time in tow', 'course')
"""Variables that a channel's residuals may follow, beside a constant."""

SHAPES = ('throughout', *VARIABLES)


@dataclass(frozen=True)
class ResidualPattern:
    """Pattern: residuals of one channel that follow one of `SHAPES`."""

    channel: str
    shape: str


def patterns(parts: Sequence[Linearised]) -> tuple[tuple[ResidualPattern, ...], list[FloatArray]]:
    """All patterns that are observable in the windows.

    Returns
    -------
    tuple
        The patterns; those of one channel stand together.
    list
        For each window an array (channels of the window, patterns), each column of size 1 in std
        of the readings.
    """
    variables = _variables(parts)
    varying = [i for i in range(len(SHAPES)) if i == 0 or np.ptp(variables[:, i]) > 1e-9]
    present = [name for name in MEASURED if any(name in part.channels for part in parts)]
    found = tuple(ResidualPattern(name, SHAPES[i]) for name in present for i in varying)
    columns = []
    for row, part in enumerate(parts):
        own = np.zeros((len(part.channels), len(found)))
        std = part.std(1)
        for channel, name in enumerate(part.channels):
            first = present.index(name) * len(varying)
            own[channel, first : first + len(varying)] = std[channel] * variables[row, varying]
        columns.append(own)
    return found, columns


def _variables(parts: Sequence[Linearised]) -> FloatArray:
    """Shapes (windows, shapes), centred and scaled."""
    length = np.array([0.5 * part.inputs[:2].sum() for part in parts])
    speed = np.array([part.inputs[2] for part in parts])
    hours = np.array([part.window.hours for part in parts])
    course = np.array([part.window.sense for part in parts])
    length, speed, hours = (_standard(values) for values in (length, speed, hours))
    square = _standard(length**2)
    shapes = (np.ones(len(parts)), length, square, speed, length * speed, hours, course)
    return np.column_stack(shapes)


def _standard(values: FloatArray) -> FloatArray:
    spread = float(values.std())
    return (values - values.mean()) / spread if spread > 1e-9 else np.zeros(len(values))
