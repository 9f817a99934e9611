"""One measured quantity with its errors.

    reading = quantised(truth + bias of the state + correlated noise + white noise)

Each kind of error of each channel draws from a generator of its own, which follows from the
seed and the channel's name. So neither another sensor nor another kind of error on this one
changes what is drawn here.
"""

import math
import zlib
from dataclasses import dataclass

import numpy as np

from trawl_ros.instruments.sampling import SECOND


@dataclass(frozen=True)
class ErrorModel:
    """Errors of a channel, in the channel's unit.

    ``white_std`` is drawn per sample. ``correlated_std`` is that of a first-order process
    with ``correlation_time`` (s). ``bias_std`` is that of a constant drawn anew for each
    state of the tow. Readings are multiples of ``resolution`` (0: not quantised).
    ``stated_std`` is what the sensor's maker says of its noise.
    """

    white_std: float = 0.0
    correlated_std: float = 0.0
    correlation_time: float = 0.0
    bias_std: float = 0.0
    resolution: float = 0.0
    stated_std: float = 0.0


class Channel:
    """Measures one quantity.

    Parameters
    ----------
    name
        Unique among all channels; by convention topic and quantity.
    errors
        What is added to truth.
    seed
        Not negative; shared by all channels.
    """

    def __init__(self, name: str, errors: ErrorModel, seed: int) -> None:
        self.name = name
        self.errors = errors
        self._seed = seed
        self.restart()

    @property
    def stated_std(self) -> float:
        """What the sensor says of its own noise, in the channel's unit."""
        return self.errors.stated_std

    def restart(self) -> None:
        """Forget all: the same readings follow as from a new channel."""
        self._white = self._generator('white')
        self._driving = self._generator('correlated')
        self._correlated: tuple[int, float] | None = None
        self._bias: tuple[int, float] | None = None

    def measure(self, value: float, stamp: int, state: int = 0) -> float:
        """Measure.

        Parameters
        ----------
        value
            The truth, in the channel's unit.
        stamp
            When (ns); not before the last one.
        state
            Number of the tow's state, which decides on the bias.
        """
        errors = self.errors
        reading = value + self._bias_of(state) + self._correlated_at(stamp)
        reading += errors.white_std * self._white.standard_normal()
        if errors.resolution > 0 and math.isfinite(reading):
            reading = round(reading / errors.resolution) * errors.resolution
        return float(reading)

    def _bias_of(self, state: int) -> float:
        # By number, not in turn: a state too short for a sample leaves the others as they are.
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
        key = zlib.crc32(f'{self.name}/{kind}'.encode())
        return np.random.default_rng(np.random.SeedSequence(self._seed, spawn_key=(key, number)))
