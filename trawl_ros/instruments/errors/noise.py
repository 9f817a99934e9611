"""White noise of a channel: normal or with heavy tails, constant or growing with the reading."""

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class NoiseModel:
    """Model of what is drawn anew for each sample.

    Attributes
    ----------
    std
        Standard deviation at a reading of zero, in the channel's unit.
    of_reading
        Part of the quantity that is added to it, as the root of the sum of squares.
    tail_dof
        Degrees of freedom of Student's t, which has the same standard deviation and heavier
        tails the fewer they are; more than 2. Infinite: normal.
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
        Its size and tails.
    generator
        Generator of random numbers of its own.
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
