# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Windows of a plant from instruments, with correlated noise and calibration errors per tow."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
from scipy.signal import lfilter

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.fit.error_terms import group_of
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.windows.records import SteadyWindow, WindowOptions
from trawl_ros.estimation.windows.statistics import error_of_mean
from trawl_ros.lab.trials.linearised_plant import LinearisedState
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED

CORRELATION_S = 15.0
"""Correlation time of the noise, after which 1/e remains."""


@dataclass(frozen=True)
class SensorKind:
    """Readings per second of a kind of sensor, and the standard deviations of its noise.

    The noise has a ``white`` and a ``correlated`` part.
    """

    rate_hz: float
    white: float
    correlated: float

    @property
    def stated(self) -> float:
        """Standard deviation that the sensor states."""
        return float(np.hypot(self.white, self.correlated))

    @property
    def number(self) -> int:
        """Readings in a window."""
        return round(self.rate_hz * WindowOptions.window_s)

    @property
    def lag(self) -> float:
        """Correlation of one correlated error with the next."""
        return float(np.exp(-1.0 / (self.rate_hz * CORRELATION_S)))

    @property
    def mean_std(self) -> float:
        """Standard deviation of the mean of a window's noise."""
        apart = np.abs(np.subtract.outer(np.arange(self.number), np.arange(self.number)))
        correlated = self.correlated**2 * float(np.mean(self.lag**apart))
        return float(np.sqrt(self.white**2 / self.number + correlated))

    def noise(self, rng: np.random.Generator, number: int | None = None) -> FloatArray:
        """Return errors (n,) of a number of readings, by default of one window."""
        drawn = rng.standard_normal(self.number if number is None else number)
        drawn[1:] *= np.sqrt(1.0 - self.lag**2)
        slow = lfilter([1.0], [1.0, -self.lag], drawn)
        noise: FloatArray = self.white * rng.standard_normal(len(drawn)) + self.correlated * slow
        return noise


_DEGREE = np.pi / 180.0

SENSOR_KINDS: Mapping[str, SensorKind] = {
    'length': SensorKind(1.0, 0.05, 0.0),
    'speed': SensorKind(1.0, 0.03, 0.02),
    'tension': SensorKind(1.0, 1600.0, 1500.0),
    'door_depth': SensorKind(0.5, 0.2, 0.3),
    'door_spread': SensorKind(0.28, 0.4, 0.0),
    'net_depth': SensorKind(0.5, 0.2, 0.3),
    'pitch': SensorKind(0.25, 0.5 * _DEGREE, 0.5 * _DEGREE),
    'roll': SensorKind(0.25, 0.5 * _DEGREE, 0.5 * _DEGREE),
    'vertical_opening': SensorKind(0.1, 1.0, 1.0),
}
"""As ``bags/sea_trial.yaml`` has them, SI, of the spread what is left without its false echoes and
gaps; the opening as read off the sonar's image."""

SENSED_CHANNELS = tuple(name for name in MEASURED if group_of(name) in SENSOR_KINDS)
"""Channels of these sensors."""

SENSED_NAMES = (*SENSED_CHANNELS, *INPUTS)


@dataclass(frozen=True)
class Sensors:
    """Sensors of a trial.

    ``factors`` multiply the stated noise and biases of each quantity. ``state_share`` is the part
    of a bias that changes with the state, as in `EstimatorOptions`.
    """

    factors: Mapping[str, float]
    state_share: float = EstimatorOptions.state_share

    def factor(self, name: str) -> float:
        """Factor of a channel or input."""
        return self.factors[group_of(name)]

    def mean_std(self, name: str) -> float:
        """Standard deviation of the mean of one window's noise, in the channel's unit."""
        return self.factor(name) * SENSOR_KINDS[group_of(name)].mean_std

    def state_std(self, name: str, value: float) -> float:
        """Standard deviation of what changes from one state to the next, in the channel's unit."""
        channel = CHANNELS[name]
        return self.factor(name) * channel.state_std(channel.bias_std(value), self.state_share)


AS_STATED = Sensors(dict.fromkeys(SENSOR_KINDS, 1.0))
SAME_IN_ALL_STATES = replace(AS_STATED, state_share=0.0)
"""Sensors as stated, without errors that change with the state."""


def wrong_by(part: float, rng: np.random.Generator) -> Sensors:
    """Return sensors that are each either worse or better than stated by this share."""
    return Sensors({name: 1.0 + part * rng.choice((-1.0, 1.0)) for name in SENSOR_KINDS})


def drawn_errors(
    sensors: Sensors, rng: np.random.Generator
) -> tuple[dict[str, float], dict[str, float]]:
    """Draw offsets and errors of scale of all channels for a tow."""
    offset, scale = (
        {name: sensors.factor(name) * std * rng.standard_normal() for name, std in stds}
        for stds in (
            [(name, CHANNELS[name].bias) for name in SENSED_NAMES],
            [(name, CHANNELS[name].bias_fraction) for name in SENSED_NAMES],
        )
    )
    return offset, scale


def steady_windows(
    tows: Sequence[Sequence[LinearisedState]],
    sensors: Sensors,
    rng: np.random.Generator,
    first_tow: int = 0,
) -> tuple[SteadyWindow, ...]:
    """One window of each steady state, as the finder would find it.

    Readings are the plant's observables and inputs with an offset and an error of scale for each
    tow, an offset for each state, and noise, a part of which is autoregressive of first order. Mean
    and stated error are computed from the readings in the same way as by the finder.

    Parameters
    ----------
    tows
        Observables of the plant, tow by tow.
    sensors
        True errors of the instruments.
    rng
        Generator of random numbers.
    first_tow
        Number of the first tow.
    """
    indices = count(1000 * first_tow)
    windows = []
    length_ns = round(WindowOptions.window_s * SECOND)
    for tow, looks in enumerate(tows, first_tow):
        offset, scale = drawn_errors(sensors, rng)
        for look in looks:
            means, noise, counts = {}, {}, {}
            for name in SENSED_NAMES:
                truth = _truth(look, name)
                own = sensors.state_std(name, truth) * rng.standard_normal()
                centre = (1.0 + scale[name]) * truth + offset[name] + own
                kind = SENSOR_KINDS[group_of(name)]
                readings = centre + sensors.factor(name) * kind.noise(rng)
                means[name] = float(readings.mean())
                noise[name] = error_of_mean(readings, kind.stated)
                counts[name] = len(readings)
            bias = {name: CHANNELS[name].bias_std(means[name]) for name in SENSED_NAMES}
            index = next(indices)
            start_ns = (index + 1) * 10 * length_ns
            windows.append(
                SteadyWindow(
                    index, index, start_ns, start_ns + length_ns, means, noise, bias, counts, tow
                )
            )
    return tuple(windows)


def _truth(look: LinearisedState, name: str) -> float:
    return look.inputs[INPUTS.index(name)] if name in INPUTS else look[name]
