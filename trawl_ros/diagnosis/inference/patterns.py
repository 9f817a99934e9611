# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Empirical patterns of a channel's residuals: a constant, or proportional to a variable.

They describe residuals without naming a cause, so that an unknown cause can be recognised.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.records.channels import MEASURED

VARIABLES = ('warp length', 'warp length²', 'speed', 'warp length × speed', 'time in tow', 'course')
"""Variables to which a channel's residuals may be proportional; `_variables` scales them."""

SHAPES = ('throughout', *VARIABLES)
"""All shapes of a pattern; ``throughout`` is the constant one."""

MIN_SPREAD = 1e-9
"""Std or range (m, m/s, h or no unit) up to which a variable counts as constant."""


@dataclass(frozen=True)
class ResidualPattern:
    """Residuals of one channel that follow one of `SHAPES`."""

    channel: str
    shape: str


def patterns(
    linearised: Sequence[Linearised],
) -> tuple[tuple[ResidualPattern, ...], list[FloatArray]]:
    """Return all patterns that are observable in the windows.

    A pattern is observable if its channel is measured and its variable differs between windows.

    Parameters
    ----------
    linearised
        Linearised windows of all tows.

    Returns
    -------
    tuple
        Patterns, ordered by channel and then by shape.
    list
        For each window an array (channels of the window, patterns): the change (SI) of each
        reading by a pattern of size 1. It is the variable times the std of the reading.
    """
    variables = _variables(linearised)
    varying = [i for i in range(len(SHAPES)) if i == 0 or np.ptp(variables[:, i]) > MIN_SPREAD]
    present = [name for name in MEASURED if any(name in linear.channels for linear in linearised)]
    observable = tuple(ResidualPattern(name, SHAPES[i]) for name in present for i in varying)
    columns = []
    for row, linear in enumerate(linearised):
        change = np.zeros((len(linear.channels), len(observable)))
        # Std of a reading if the window is the only one in its steady state.
        std = linear.std(1)
        for channel, name in enumerate(linear.channels):
            first = present.index(name) * len(varying)
            change[channel, first : first + len(varying)] = std[channel] * variables[row, varying]
        columns.append(change)
    return observable, columns


def _variables(linearised: Sequence[Linearised]) -> FloatArray:
    """Return the values (windows, shapes) of `SHAPES`, without unit.

    Length, its square, speed and time are centred and scaled to unit std. The course is ±1, the
    sense in which the track is towed.
    """
    # Mean of both warps.
    length = np.array([0.5 * linear.inputs[:2].sum() for linear in linearised])
    speed = np.array([linear.inputs[2] for linear in linearised])
    hours = np.array([linear.window.hours for linear in linearised])
    course = np.array([linear.window.sense for linear in linearised])
    length, speed, hours = (_standard(values) for values in (length, speed, hours))
    square = _standard(length**2)
    shapes = (np.ones(len(linearised)), length, square, speed, length * speed, hours, course)
    return np.column_stack(shapes)


def _standard(values: FloatArray) -> FloatArray:
    """Return values with mean 0 and std 1; all 0 if they are constant."""
    spread = float(values.std())
    return (values - values.mean()) / spread if spread > MIN_SPREAD else np.zeros(len(values))
