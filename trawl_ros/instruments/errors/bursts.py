"""Random bursts of trouble, such as dropouts of a link or a hanging sensor."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.time import SECOND

HOUR = 3600.0


@dataclass(frozen=True)
class BurstModel:
    """Statistics of bursts: rate and mean length.

    ``per_hour`` counts from the end of the last one, ``mean_s`` is their mean length; both are
    exponentially distributed. 0: there are none.
    """

    per_hour: float = 0.0
    mean_s: float = 0.0


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
        self._draw = generator.standard_exponential
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
            mean = model.mean_s if self._on else HOUR / model.per_hour
            self._until += self._wait(mean)
        return self._on

    def _wait(self, mean_s: float) -> int:
        # At least a nanosecond, so that time goes on.
        return max(1, round(mean_s * self._draw() * SECOND))
