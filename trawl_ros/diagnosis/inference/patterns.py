# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Patterns of a channel's residuals, whatever their cause: a few simple shapes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.records.channels import MEASURED

VARIABLES = ('warp length', 'warp length²', 'speed', 'warp length × speed', 'time in tow', 'course')
"""Variables that a channel's residuals may follow, as well as a constant."""

SHAPES = ('throughout', *VARIABLES)


@dataclass(frozen=True)
class ResidualPattern:
    """Pattern: residuals of one channel that follow one of `SHAPES`."""

    channel: str
    shape: str


def patterns(
    linearised: Sequence[Linearised],
) -> tuple[tuple[ResidualPattern, ...], list[FloatArray]]:
    """All patterns that are observable in the windows.

    Returns
    -------
    tuple
        The patterns; those of one channel stand together.
    list
        For each window an array (channels of the window, patterns), each column of size 1 in std
        of the readings.
    """
    variables = _variables(linearised)
    varying = [i for i in range(len(SHAPES)) if i == 0 or np.ptp(variables[:, i]) > 1e-9]
    present = [name for name in MEASURED if any(name in linear.channels for linear in linearised)]
    observable = tuple(ResidualPattern(name, SHAPES[i]) for name in present for i in varying)
    columns = []
    for row, linear in enumerate(linearised):
        own = np.zeros((len(linear.channels), len(observable)))
        std = linear.std(1)
        for channel, name in enumerate(linear.channels):
            first = present.index(name) * len(varying)
            own[channel, first : first + len(varying)] = std[channel] * variables[row, varying]
        columns.append(own)
    return observable, columns


def _variables(linearised: Sequence[Linearised]) -> FloatArray:
    """Shapes (windows, shapes), centred and scaled."""
    length = np.array([0.5 * linear.inputs[:2].sum() for linear in linearised])
    speed = np.array([linear.inputs[2] for linear in linearised])
    hours = np.array([linear.window.hours for linear in linearised])
    course = np.array([linear.window.sense for linear in linearised])
    length, speed, hours = (_standard(values) for values in (length, speed, hours))
    square = _standard(length**2)
    shapes = (np.ones(len(linearised)), length, square, speed, length * speed, hours, course)
    return np.column_stack(shapes)


def _standard(values: FloatArray) -> FloatArray:
    spread = float(values.std())
    return (values - values.mean()) / spread if spread > 1e-9 else np.zeros(len(values))
