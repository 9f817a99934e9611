"""Random bursts of trouble, such as dropouts of a link or a hanging sensor."""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.time import SECOND

HOUR = 3600.0


@dataclass(frozen=True)
class BurstModel:
    """Statistics of bursts: rate and mean length.

    ``per_hour`` counts from the end of the last one, ``mean_s`` is their mean length; 0: there
    are none. Times between them are exponentially distributed, and so are lengths, unless
    ``log_std`` is given, the standard deviation of the logarithm of lengths that are log-normal.
    """

    per_hour: float = 0.0
    mean_s: float = 0.0
    log_std: float = 0.0


NO_BURSTS = BurstModel()


class Bursts:
    """Random process of bursts; it goes by time, not by the number of samples.

    Parameters
    ----------
    model
        Frequency and duration of spells.
    generator
        Generator of random numbers for spells.
    """

    def __init__(self, model: BurstModel, generator: np.random.Generator) -> None:
        self._model = model
        self._generator = generator
        self._on = False
        self._until: int | None = None

    def on(self, stamp: int) -> bool:
        """True during a burst at a stamp (ns), not before the last one asked about."""
        model = self._model
        if model.per_hour == 0.0 or model.mean_s == 0.0:
            return False
        if self._until is None:
            self._until = stamp + self._wait(HOUR / model.per_hour)
        while stamp >= self._until:
            self._on = not self._on
            self._until += self._length() if self._on else self._wait(HOUR / model.per_hour)
        return self._on

    def _length(self) -> int:
        mean_s, log_std = self._model.mean_s, self._model.log_std
        if log_std == 0.0:
            return self._wait(mean_s)
        # The mean of a log-normal distribution is exp(µ + σ² / 2).
        drawn = math.exp(log_std * self._generator.standard_normal() - 0.5 * log_std**2)
        return max(1, round(mean_s * drawn * SECOND))

    def _wait(self, mean_s: float) -> int:
        # At least a nanosecond, so that time goes on.
        return max(1, round(mean_s * self._generator.standard_exponential() * SECOND))
