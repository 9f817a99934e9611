"""Measurement channel: one quantity with its errors.

    reading = quantised(limited((1 + scale) truth + offset + drift + bias + noise
                                [+ outlier] [+ longer way of a false echo]))

and while the sensor hangs, the reading before. Each kind of error of each channel draws from a
generator of its own, which follows from the seed and the channel's name. So neither another
sensor nor another kind of error on this one changes what is drawn here.
"""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.bursts import HOUR, NO_BURSTS, BurstModel, Bursts
from trawl_ros.instruments.errors.false_echoes import FalseEchoes, FalseEchoModel
from trawl_ros.instruments.errors.faults import Fault
from trawl_ros.instruments.errors.noise import NO_NOISE, Noise, NoiseModel
from trawl_ros.instruments.errors.random_streams import generator

FAR_OFF = 1.0
"""Standard deviation of outliers that a fault brings, as a part of the reading."""


@dataclass(frozen=True)
class ErrorModel:
    """Error model of a channel, in the channel's unit.

    ``white`` is drawn per sample. ``correlated_std`` is that of a first-order process
    with ``correlation_time`` (s). ``bias_std`` is that of a constant drawn anew for each
    state of the tow. Readings are multiples of ``resolution`` (0: not quantised).
    ``stated_std`` is what the sensor's maker says of its noise.

    ``scale`` is the part by which readings are too large, ``offset`` is added to them, and
    ``drift`` per hour since the first reading. A share ``outlier_share`` of them is off by a
    normal error of ``outlier_std`` more. None is below ``lowest`` or above ``highest``. In
    spells of ``freezes`` the reading stays what it was, and so does a share ``repeated`` of all.
    ``false_echoes`` come a longer way.
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
        Unique among all channels; by convention topic and quantity.
    errors
        Errors added to truth.
    seed
        Not negative; shared by all channels.
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
        """Reset all but the faults: the same readings follow as from a new channel."""
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
            The truth, in the channel's unit.
        stamp
            Time (ns); not before the last one.
        state
            Number of the tow's state, which decides on the bias.
        """
        errors = self.errors
        # All is drawn whether it shows or not: a fault changes no reading after its end.
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
            reading += faults['drift'] * (stamp - self._drift_began) / SECOND / HOUR
        if 'noise' in faults:
            reading += faults['noise'] * self._faulty.standard_normal()
        if 'outliers' in faults and self._faulty.random() < faults['outliers']:
            reading += FAR_OFF * abs(reading) * self._faulty.standard_normal()
        return min(reading, faults.get('saturated', math.inf))

    def _drift_at(self, stamp: int) -> float:
        if self._first is None:
            self._first = stamp
        return self.errors.drift * (stamp - self._first) / SECOND / HOUR

    def _outlier(self) -> float:
        if self.errors.outlier_share == 0.0:
            return 0.0
        size = self.errors.outlier_std * self._wild.standard_normal()
        return float(size) if self._wild.random() < self.errors.outlier_share else 0.0

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
        return generator(self._seed, f'{self.name}/{kind}', number)
