"""Errors of stretches as stated processes: noise, drifts of sensors, and the model's own error.

The error of a mean is the sum of three: its own, which no other mean shares; a first-order
Gauss-Markov process of its sensor; and one of the model, slower, which is the same for both sides
of the gear. Sizes are parts of what is stated for each, and are estimated (`sizes`).
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.estimation.fit.error_terms import GROUPS, MODEL_ANGLE, MODEL_FRACTION, group_of
from trawl_ros.estimation.motion.records import MovingTow
from trawl_ros.records.channels import CHANNELS


@dataclass(frozen=True)
class ErrorTimes:
    """Correlation times (s) of the drift of sensors and of the model's error."""

    drift: float = 30.0
    model: float = 300.0


@dataclass(frozen=True)
class ErrorSizes:
    """Sizes of the errors of each of `GROUPS`, as factors on what is stated.

    Attributes
    ----------
    noise
        On the scatter of the means.
    drift
        On the noise of a single reading in the channel table: std of the sensor's process.
    model
        On `MODEL_FRACTION` of the value, or `MODEL_ANGLE`: std of the model's process.
    log
        On the errors of the speed log at its knots.
    """

    noise: tuple[float, ...] = (1.0,) * len(GROUPS)
    drift: tuple[float, ...] = (0.1,) * len(GROUPS)
    model: tuple[float, ...] = (1.0,) * len(GROUPS)
    log: float = 1.0

    def having(self, group: int, noise: float, drift: float, model: float) -> 'ErrorSizes':
        """Sizes with those of one group replaced."""

        def put(values: tuple[float, ...], value: float) -> tuple[float, ...]:
            return (*values[:group], value, *values[group + 1 :])

        return replace(
            self,
            noise=put(self.noise, noise),
            drift=put(self.drift, drift),
            model=put(self.model, model),
        )

    def tempered(self, factor: float) -> 'ErrorSizes':
        """Sizes with all errors of stretches larger by a factor."""

        def more(values: tuple[float, ...]) -> tuple[float, ...]:
            return tuple(factor * value for value in values)

        return replace(self, noise=more(self.noise), drift=more(self.drift), model=more(self.model))

    def of_group(self, group: int) -> FloatArray:
        """Factors (3,) on noise, drift and model's error of a group."""
        return np.array([self.noise[group], self.drift[group], self.model[group]])


EXACT_MODEL = ErrorSizes(drift=(0.0,) * len(GROUPS), model=(0.0,) * len(GROUPS))
"""White noise as it scatters, of a model without errors."""


@dataclass(frozen=True)
class GroupRows:
    """Rows (m,) of one group of channels: stretch and channel of each mean that is there, its
    noise, and the std there of a drift and an error of the model of size 1.
    """

    stretches: IntArray
    channels: IntArray
    times: FloatArray
    noise: FloatArray
    drift: FloatArray
    model: FloatArray

    def covariance(self, sizes: FloatArray, times: ErrorTimes) -> FloatArray:
        """Covariance (m, m) of the errors by sizes (3,) of noise, drift and model's error."""
        apart = np.abs(self.times[:, None] - self.times)
        same = self.channels[:, None] == self.channels
        total = np.diag((sizes[0] * self.noise) ** 2)
        drift, model = sizes[1] * self.drift, sizes[2] * self.model
        total += np.where(same, np.outer(drift, drift) * np.exp(-apart / times.drift), 0.0)
        total += np.outer(model, model) * np.exp(-apart / times.model)
        return total


def group_rows(tow: MovingTow, predicted: FloatArray, noise: FloatArray) -> list[GroupRows]:
    """Rows of each of `GROUPS`.

    Parameters
    ----------
    tow
        The tow.
    predicted, noise : (n, k) arrays
        Means as predicted, NaN where there are none; standard errors of the measured ones.
    """
    there = np.isfinite(tow.means) & np.isfinite(predicted)
    groups = [group_of(name) for name in tow.channels]
    found = []
    for group in GROUPS:
        own = np.array([name == group for name in groups], dtype=bool)
        stretches, channels = np.nonzero(there & own)
        values = np.abs(predicted[stretches, channels])
        angle = any(CHANNELS[tow.channels[c]].unit == 'rad' for c in np.flatnonzero(own))
        found.append(
            GroupRows(
                stretches,
                channels,
                tow.middles[stretches],
                noise[stretches, channels],
                np.array([CHANNELS[tow.channels[c]].noise for c in channels]),
                np.full(len(values), MODEL_ANGLE) if angle else MODEL_FRACTION * values,
            )
        )
    return found
