# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Measurement channel: one quantity with its errors.

    reading = quantised(limited((1 + scale) truth + offset + drift + bias + noise
                                [+ outlier] [+ longer way of a false echo]))

and the previous reading while the sensor hangs. Each kind of error of each channel has its own
generator, which follows from the seed and the channel's name. So the random numbers of an error
do not depend on other sensors or on other kinds of error.
"""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.faults import Fault
from trawl_ros.instruments.errors.random_processes import (
    NO_BURSTS,
    NO_NOISE,
    SECONDS_PER_HOUR,
    BurstModel,
    Bursts,
    FalseEchoes,
    FalseEchoModel,
    Noise,
    NoiseModel,
    generator,
)

FAULT_OUTLIER_STD_FRACTION = 1.0
"""Standard deviation of the outliers of a fault, as a fraction of the reading."""


@dataclass(frozen=True)
class ErrorModel:
    """Error model of a channel, in the channel's unit.

    Attributes
    ----------
    white
        Noise that is independent in each sample.
    correlated_std, correlation_time
        Standard deviation of a first-order process, and its time constant (s).
    bias_std
        Standard deviation of a constant that is drawn again for each state of the tow.
    resolution
        Step of quantised readings; 0 for none.
    stated_std
        Standard deviation of the noise as the sensor's maker states it.
    scale, offset, drift
        Relative excess of the readings, constant error, and error per hour since the first reading.
    outlier_share, outlier_std
        Share of readings with an additional normal error, and its standard deviation.
    lowest, highest
        Bounds of the readings.
    freezes, repeated
        Bursts in which the previous reading is repeated, and share of single repeated readings.
    false_echoes
        Echoes over a longer path.
    """

    white: NoiseModel = NO_NOISE
    correlated_std: float = 0.0
    correlation_time: float = 0.0
    bias_std: float = 0.0
    resolution: float = 0.0
    stated_std: float = 0.0
    scale: float = 0.0
    offset: float = 0.0
    drift: float = 0.0
    outlier_share: float = 0.0
    outlier_std: float = 0.0
    lowest: float = -math.inf
    highest: float = math.inf
    freezes: BurstModel = NO_BURSTS
    repeated: float = 0.0
    false_echoes: tuple[FalseEchoModel, ...] = ()


class ErrorChannel:
    """Measurement channel of one quantity.

    Parameters
    ----------
    name
        Name that is unique among all channels; by convention topic and quantity.
    errors
        Errors added to the truth.
    seed
        Seed that all channels share; not negative.
    """

    def __init__(self, name: str, errors: ErrorModel, seed: int) -> None:
        self.name = name
        self.errors = errors
        self._seed = seed
        self._faults: dict[str, float] = {}
        self._drift_began: int | None = None
        self.restart()

    @property
    def stated_std(self) -> float:
        """Stated standard deviation of the sensor's noise, in the channel's unit."""
        return self.errors.stated_std

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Active faults."""
        return tuple(Fault(kind, size) for kind, size in self._faults.items())

    def put(self, fault: Fault) -> None:
        """Activate a fault; one of the same kind is replaced."""
        self._faults[fault.kind] = fault.size
        if fault.kind == 'drift':
            self._drift_began = None

    def take_off(self, kind: str) -> None:
        """Deactivate one kind of fault."""
        self._faults.pop(kind, None)

    def clear(self) -> None:
        """Deactivate all faults."""
        self._faults.clear()

    def restart(self) -> None:
        """Reset everything except faults, so that readings are those of a new channel."""
        self._white = Noise(self.errors.white, self._generator('white'))
        self._driving = self._generator('correlated')
        self._wild = self._generator('outliers')
        self._faulty = self._generator('fault')
        self._false_echoes = [
            FalseEchoes(model, self._generator('false echoes', number))
            for number, model in enumerate(self.errors.false_echoes)
        ]
        self._freezes = Bursts(self.errors.freezes, self._generator('freezes'))
        self._repeats = self._generator('repeats')
        self._correlated: tuple[int, float] | None = None
        self._bias: tuple[int, float] | None = None
        self._first: int | None = None
        self._drift_began = None
        self._latest = math.nan

    def measure(self, value: float, stamp: int, state: int = 0) -> float:
        """Return the reading of a value.

        Parameters
        ----------
        value
            True value, in the channel's unit.
        stamp
            Time (ns); it must not decrease.
        state
            Number of the tow's state, which determines the bias.
        """
        errors = self.errors
        # Each error is drawn even if it has no effect: a fault changes no reading after its end.
        reading = value * (1.0 + errors.scale) + errors.offset + self._drift_at(stamp)
        reading += self._bias_of(state) + self._correlated_at(stamp)
        reading += self._white.draw(value) + self._outlier()
        reading += sum(echoes.draw(value) for echoes in self._false_echoes)
        reading = self._with_faults(reading, stamp)
        reading = min(max(reading, errors.lowest), errors.highest)
        if errors.resolution > 0 and math.isfinite(reading):
            reading = round(reading / errors.resolution) * errors.resolution
        repeats = errors.repeated > 0.0 and self._repeats.random() < errors.repeated
        hangs = self._freezes.on(stamp) or repeats or 'frozen' in self._faults
        if hangs and not math.isnan(self._latest):
            reading = self._latest
        self._latest = float(reading)
        return math.nan if 'lost' in self._faults else self._latest

    def _with_faults(self, reading: float, stamp: int) -> float:
        faults = self._faults
        if not faults:
            return reading
        reading = reading * faults.get('scale', 1.0) + faults.get('offset', 0.0)
        if 'drift' in faults:
            if self._drift_began is None:
                self._drift_began = stamp
            reading += faults['drift'] * (stamp - self._drift_began) / SECOND / SECONDS_PER_HOUR
        if 'noise' in faults:
            reading += faults['noise'] * self._faulty.standard_normal()
        if 'outliers' in faults and self._faulty.random() < faults['outliers']:
            reading += FAULT_OUTLIER_STD_FRACTION * abs(reading) * self._faulty.standard_normal()
        return min(reading, faults.get('saturated', math.inf))

    def _drift_at(self, stamp: int) -> float:
        if self._first is None:
            self._first = stamp
        return self.errors.drift * (stamp - self._first) / SECOND / SECONDS_PER_HOUR

    def _outlier(self) -> float:
        if self.errors.outlier_share == 0.0:
            return 0.0
        size = self.errors.outlier_std * self._wild.standard_normal()
        return float(size) if self._wild.random() < self.errors.outlier_share else 0.0

    def _bias_of(self, state: int) -> float:
        # Drawn by the number of the state: a state without a sample does not change the others.
        if self._bias is None or self._bias[0] != state:
            drawn = self._generator('bias', state).standard_normal()
            self._bias = state, self.errors.bias_std * drawn
        return self._bias[1]

    def _correlated_at(self, stamp: int) -> float:
        if self.errors.correlated_std == 0:
            return 0.0
        drawn = self.errors.correlated_std * self._driving.standard_normal()
        if self._correlated is not None:
            before, last = self._correlated
            kept = math.exp(-(stamp - before) / SECOND / self.errors.correlation_time)
            drawn = kept * last + math.sqrt(1 - kept**2) * drawn
        self._correlated = stamp, drawn
        return drawn

    def _generator(self, kind: str, number: int = 0) -> np.random.Generator:
        return generator(self._seed, f'{self.name}/{kind}', number)
