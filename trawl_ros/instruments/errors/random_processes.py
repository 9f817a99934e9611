# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Random processes of errors: noise, bursts of trouble, and false echoes, each with a generator.

Each generator follows from one seed and a name. So one process draws the same numbers whatever
others there are.
"""

import math
import zlib
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.time import SECOND

SECONDS_PER_HOUR = 3600.0


def generator(seed: int, name: str, number: int = 0) -> np.random.Generator:
    """Return the generator of a seed, a name, and a number among several of that name."""
    key = zlib.crc32(name.encode())
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(key, number)))


@dataclass(frozen=True)
class NoiseModel:
    """Model of noise that is independent in each sample.

    Attributes
    ----------
    std
        Standard deviation at a reading of zero, in the channel's unit.
    of_reading
        Part of the quantity that is added to it as the root of the sum of squares.
    tail_dof
        Degrees of freedom, more than 2, of a Student's t distribution with the same standard
        deviation; fewer mean heavier tails. Infinite for a normal distribution.
    """

    std: float = 0.0
    of_reading: float = 0.0
    tail_dof: float = math.inf


NO_NOISE = NoiseModel()


class Noise:
    """Noise of a channel.

    Parameters
    ----------
    model
        Size and tails.
    generator
        Generator of random numbers.
    """

    def __init__(self, model: NoiseModel, generator: np.random.Generator) -> None:
        self._model = model
        self._generator = generator

    def draw(self, value: float) -> float:
        """Draw the noise of a reading of ``value``."""
        model = self._model
        std = math.hypot(model.std, model.of_reading * value) if model.of_reading else model.std
        if math.isinf(model.tail_dof):
            return std * float(self._generator.standard_normal())
        # Student's t has the variance ν / (ν - 2).
        scale = math.sqrt((model.tail_dof - 2.0) / model.tail_dof)
        return std * scale * float(self._generator.standard_t(model.tail_dof))


@dataclass(frozen=True)
class BurstModel:
    """Statistics of bursts: rate and mean length.

    ``per_hour`` is the rate between them and ``mean_s`` their mean length; there are none if
    either is 0. Times between bursts and their lengths are exponentially distributed. If
    ``log_std`` is given, lengths are log-normal with this standard deviation of the logarithm.
    """

    per_hour: float = 0.0
    mean_s: float = 0.0
    log_std: float = 0.0


NO_BURSTS = BurstModel()


class Bursts:
    """Random process of bursts in time, independent of the number of samples.

    Parameters
    ----------
    model
        Rate and length of bursts.
    generator
        Generator of random numbers.
    """

    def __init__(self, model: BurstModel, generator: np.random.Generator) -> None:
        self._model = model
        self._generator = generator
        self._on = False
        self._until: int | None = None

    def on(self, stamp: int) -> bool:
        """Return True during a burst at a stamp (ns); stamps must not decrease."""
        model = self._model
        if model.per_hour == 0.0 or model.mean_s == 0.0:
            return False
        if self._until is None:
            self._until = stamp + self._wait(SECONDS_PER_HOUR / model.per_hour)
        while stamp >= self._until:
            self._on = not self._on
            self._until += (
                self._length() if self._on else self._wait(SECONDS_PER_HOUR / model.per_hour)
            )
        return self._on

    def _length(self) -> int:
        mean_s, log_std = self._model.mean_s, self._model.log_std
        if log_std == 0.0:
            return self._wait(mean_s)
        # The mean of a log-normal distribution is exp(µ + σ² / 2).
        drawn = math.exp(log_std * self._generator.standard_normal() - 0.5 * log_std**2)
        return max(1, round(mean_s * drawn * SECOND))

    def _wait(self, mean_s: float) -> int:
        # At least a nanosecond, so that the loop in `on` ends.
        return max(1, round(mean_s * self._generator.standard_exponential() * SECOND))


@dataclass(frozen=True)
class FalseEchoModel:
    """Share and size of readings that are too long, in runs.

    Attributes
    ----------
    share
        Share of the readings.
    longer
        Excess of the reading, in the channel's unit: the mean of an exponential distribution for
        a reflection, constant for an ambiguous range.
    ambiguous
        True for an ambiguous range, which is too long by a whole period of the ranging.
    multiple
        Factor on the quantity: 2 for sound that travelled there and back twice, else 1.
    run
        Mean number of readings in a row; at least 1 / (1 - share), the value of independent
        readings.
    """

    share: float = 0.0
    longer: float = 0.0
    ambiguous: bool = False
    multiple: float = 1.0
    run: float = 1.0


class FalseEchoes:
    """Random process of false echoes: a Markov chain of two states over the readings.

    Parameters
    ----------
    model
        Share and size.
    generator
        Generator of random numbers.
    """

    def __init__(self, model: FalseEchoModel, generator: np.random.Generator) -> None:
        self._model = model
        self._generator = generator
        self._on = False
        if 0.0 < model.share < 1.0:
            self._goes_on = max(1.0 - 1.0 / max(model.run, 1.0), model.share)
            # In the stationary state as many runs begin as end.
            self._begins = model.share * (1.0 - self._goes_on) / (1.0 - model.share)
        else:
            self._goes_on = self._begins = model.share

    def draw(self, value: float) -> float:
        """Draw the excess of the next reading of ``value``; 0 for a true echo."""
        if self._model.share == 0.0:
            return 0.0
        self._on = self._generator.random() < (self._goes_on if self._on else self._begins)
        size = 1.0 if self._model.ambiguous else float(self._generator.standard_exponential())
        longer = self._model.longer * size + (self._model.multiple - 1.0) * value
        return longer if self._on else 0.0
