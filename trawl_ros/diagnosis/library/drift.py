# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drifts of instruments, the alternative to a gear that changes with time.

The error of a drifting instrument, measured minus true, is e(t) = rate · t + first, with t in hours
since the tow began.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation
from trawl_ros.effects.empirical import usual_error
from trawl_ros.records.channels import CHANNELS, MEASURED

MAX_USUAL_SIZES = 20.0
"""Bound of rate (per h) and initial error, as a multiple of the instrument's usual error."""

SIDES = ('port', 'starboard')

USUAL_COUNTER_ERROR_M = 5.0
"""Usual drift of the winch counters in an hour, m; assumed."""

USUAL_LOG_ERROR_M_S = 0.05
"""Usual drift of the log in an hour, m/s; assumed."""


@dataclass(frozen=True, kw_only=True)
class Drift(Effect):
    """Linear drift of an instrument through each tow, from an initial error.

    The values of its two parameters are the ``rate`` (unit per h) and the ``first`` error (unit).

    Attributes
    ----------
    instrument_in_words
        Instrument, in words of a report.
    channels
        Measured channels with this error, all of the same unit.
    inputs
        Error of port and starboard warp length (m) and of the speed (m/s), per unit of e(t).
    """

    instrument_in_words: str
    channels: tuple[str, ...] = ()
    inputs: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return true inputs (3,): the measured ones minus the error."""
        true: FloatArray = inputs - _error(values, at) * np.array(self.inputs)
        return true

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Return readings with the error added to those of ``channels``."""
        error = _error(values, at)
        return readings | {name: readings[name] + error for name in self.channels}


def _error(values: FloatArray, at: Situation) -> float:
    """Return the error e(t) for the values (2,), rate and first."""
    rate, first = values
    error: float = rate * at.hours + first
    return error


def drifts() -> Iterator[Drift]:
    """Yield drifts of each measured channel, of each pair of sides, of the counters and the log."""
    paired = [name for name in MEASURED if name.startswith(SIDES[0])]
    for name in MEASURED:
        yield _of_channels(name, f'readings of {name.replace("_", " ")}', (name,))
    for name in paired:
        quantity = name.removeprefix(f'{SIDES[0]}_')
        both = tuple(f'{side}_{quantity}' for side in SIDES)
        words = quantity.replace('_', ' ')
        yield _of_channels(f'both_{quantity}', f'readings of {words} on both sides', both)
    yield _drift('counters', 'winch counters', 'm', USUAL_COUNTER_ERROR_M, inputs=(1.0, 1.0, 0.0))
    yield _drift('log', 'readings of the log', 'm/s', USUAL_LOG_ERROR_M_S, inputs=(0, 0, 1.0))


def _of_channels(name: str, words: str, channels: tuple[str, ...]) -> Drift:
    """Return the common drift of channels of the same quantity."""
    first = channels[0]
    unit = CHANNELS[first].unit
    return _drift(name, words, unit, usual_error(first), channels=channels)


def _drift(
    name: str,
    words: str,
    unit: str,
    usual: float,
    *,
    channels: tuple[str, ...] = (),
    inputs: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Drift:
    """Return a drift whose rate (``unit`` per h) and initial error have the prior std ``usual``."""
    bound = MAX_USUAL_SIZES * usual
    return Drift(
        name=f'{name}_drift',
        sentence=f'{words.capitalize()} drift through each tow.',
        parameters=(
            Parameter('rate', f'{unit} per h', 0.0, -bound, bound, usual),
            Parameter('first', unit, 0.0, -bound, bound, usual, strength=False),
        ),
        excited_by='time in the tow',
        direct='Tow one state at the beginning of a tow and again at its end: a sensor that '
        'drifts then reads differently, and the gear is the same.',
        instrument_in_words=words,
        channels=channels,
        inputs=inputs,
    )
