# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drifts of instruments: what goes with time may be an instrument as well as the gear."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation
from trawl_ros.effects.empirical import usual_error
from trawl_ros.records.channels import CHANNELS, MEASURED

MAX_USUAL_SIZES = 20.0
"""Largest possible drift, in usual ones."""

SIDES = ('port', 'starboard')


@dataclass(frozen=True, kw_only=True)
class Drift(Effect):
    """Drift of an instrument through each tow, from an error that it begins with.

    Attributes
    ----------
    instrument_in_words
        Of which it is.
    channels
        Measured channels that drift together.
    inputs
        Drift of both warp lengths (m) and the speed (m/s) per unit of the size.
    """

    instrument_in_words: str
    channels: tuple[str, ...] = ()
    inputs: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Inputs without what the instruments show too much."""
        true: FloatArray = inputs - _error(values, at) * np.array(self.inputs)
        return true

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Readings with what the channels show too much."""
        error = _error(values, at)
        return readings | {name: readings[name] + error for name in self.channels}


def _error(values: FloatArray, at: Situation) -> float:
    rate, first = values
    error: float = rate * at.hours + first
    return error


def drifts() -> Iterator[Drift]:
    """Yield drifts of each measured channel, of both sides together, of counters and log."""
    paired = [name for name in MEASURED if name.startswith(SIDES[0])]
    for name in MEASURED:
        yield _of_channels(name, f'readings of {name.replace("_", " ")}', (name,))
    for name in paired:
        quantity = name.removeprefix(f'{SIDES[0]}_')
        both = tuple(f'{side}_{quantity}' for side in SIDES)
        words = quantity.replace('_', ' ')
        yield _of_channels(f'both_{quantity}', f'readings of {words} on both sides', both)
    yield _drift('counters', 'winch counters', 'm', 5.0, inputs=(1.0, 1.0, 0.0))
    yield _drift('log', 'readings of the log', 'm/s', 0.05, inputs=(0, 0, 1.0))


def _of_channels(name: str, words: str, channels: tuple[str, ...]) -> Drift:
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
    far = MAX_USUAL_SIZES * usual
    return Drift(
        name=f'{name}_drift',
        sentence=f'{words.capitalize()} drift through each tow.',
        parameters=(
            Parameter('rate', f'{unit} per h', 0.0, -far, far, usual),
            Parameter('first', unit, 0.0, -far, far, usual),
        ),
        excited_by='time in the tow',
        direct='Tow one state at the beginning of a tow and again at its end: what drifts then '
        'reads otherwise, and the gear does not.',
        instrument_in_words=words,
        channels=channels,
        inputs=inputs,
    )
