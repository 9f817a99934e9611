"""False echoes of an acoustic range: ways that are longer, twice as long, or of another period."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class FalseEchoModel:
    """Share and size of readings that are too long, in runs.

    Attributes
    ----------
    share
        Share of the readings.
    longer
        By how much they are too long, in the channel's unit: the mean of an exponential
        distribution for a reflection, or the same each time for an ambiguous range, which is
        taken for one that is a whole period of the ranging longer.
    ambiguous
        True for an ambiguous range.
    multiple
        The quantity this many times: 2 for sound that went there and back twice; 1 for once.
    run
        Mean number of readings in a row; 1 / (1 - share) is that of independent ones, and the
        least.
    """

    share: float = 0.0
    longer: float = 0.0
    ambiguous: bool = False
    multiple: float = 1.0
    run: float = 1.0


class FalseEchoes:
    """Random process of false echoes: a chain of two states, from reading to reading.

    Parameters
    ----------
    model
        Their share and size.
    generator
        Generator of random numbers of its own.
    """

    def __init__(self, model: FalseEchoModel, generator: np.random.Generator) -> None:
        self._model = model
        self._generator = generator
        self._on = False
        if 0.0 < model.share < 1.0:
            self._goes_on = max(1.0 - 1.0 / max(model.run, 1.0), model.share)
            # In balance as many runs begin as end.
            self._begins = model.share * (1.0 - self._goes_on) / (1.0 - model.share)
        else:
            self._goes_on = self._begins = model.share

    def draw(self, value: float) -> float:
        """Draw by how much the next reading, of ``value``, is too long; 0 for a true echo."""
        if self._model.share == 0.0:
            return 0.0
        self._on = self._generator.random() < (self._goes_on if self._on else self._begins)
        size = 1.0 if self._model.ambiguous else float(self._generator.standard_exponential())
        longer = self._model.longer * size + (self._model.multiple - 1.0) * value
        return longer if self._on else 0.0
