# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of stretches as stated processes: noise, drifts of sensors, and the model's own error.

The error of a mean is the sum of five: its own, which no other mean shares; two first-order
Gauss-Markov processes of its sensor, a drift and one that changes as steady states do; one of the
model, slow too, which is the same for both sides of the gear; and one of how fast it changes. Sizes
are parts of what is stated for each; all but the last are estimated (`sizes`).
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.estimation.fit.error_terms import GROUPS, group_of, model_std
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.records.channels import CHANNELS

STATE_SHARE = EstimatorOptions.state_share
"""Part of a channel's bias that changes from one state of a tow to the next where the channel table
has nothing measured; as for steady windows."""

SWIFT = 0.05
"""Part of its change from one stretch to the next that a mean is predicted wrong by: inputs are
smoothed over 10 s, time steps are 3 s, and where doors fall or rise by metres in half a minute the
predictions are not linear in what is unknown. Found on one tow of a finer plant, in which it was
5 % where boards were hauled to the surface, and elsewhere less."""


@dataclass(frozen=True)
class ErrorTimes:
    """Correlation times (s) of the errors.

    They are those of the drift of sensors, of the model's error, and of errors of sensors that
    differ from one state of a tow to the next.
    """

    drift: float = 30.0
    model: float = 300.0
    state: float = 900.0


KINDS = 'noise', 'drift', 'model', 'state'
"""Kinds of errors whose sizes are estimated for each group."""


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
        On `model_std`: std of the model's process.
    state
        On `Channel.state_std`, as for steady windows: std of the process that changes with states.
    log
        On the errors of the speed log at its knots.
    swift
        On the change of a mean from stretch to stretch; of all groups, and not estimated.
    """

    noise: tuple[float, ...] = (1.0,) * len(GROUPS)
    drift: tuple[float, ...] = (0.1,) * len(GROUPS)
    model: tuple[float, ...] = (1.0,) * len(GROUPS)
    state: tuple[float, ...] = (1.0,) * len(GROUPS)
    log: float = 1.0
    swift: float = SWIFT

    def having(
        self, group: int, noise: float, drift: float, model: float, state: float
    ) -> 'ErrorSizes':
        """Sizes with those of one group replaced."""
        table = self._table
        table[:, group] = noise, drift, model, state
        return self._with(table)

    def tempered(self, factor: float) -> 'ErrorSizes':
        """Sizes with all errors of stretches larger by a factor."""
        return replace(self._with(factor * self._table), swift=factor * self.swift)

    def away_from(self, other: 'ErrorSizes') -> float:
        """Largest logarithm of a size over that of another record; 0 where both are 0."""
        one, two = (np.append(sizes._table, sizes.log) for sizes in (self, other))
        both = (one > 0.0) & (two > 0.0)
        return float(np.max(np.abs(np.log(one[both] / two[both]))))

    def no_less_than(self, other: 'ErrorSizes') -> 'ErrorSizes':
        """Sizes with each that is below another record's replaced by that."""
        more = self._with(np.maximum(self._table, other._table))
        return replace(more, log=max(self.log, other.log), swift=max(self.swift, other.swift))

    def record(self) -> dict[str, object]:
        """Record for JSON: the sizes that are estimated, by kind of error and group."""
        rows = zip(KINDS, self._table.tolist(), strict=True)
        return {kind: dict(zip(GROUPS, row, strict=True)) for kind, row in rows} | {'log': self.log}

    def of_group(self, group: int) -> FloatArray:
        """Factors (5,) on the errors of a group.

        They are those on noise, drift, model's error, what changes with states, and what is swift.
        """
        return np.append(self._table[:, group], self.swift)

    @property
    def _table(self) -> FloatArray:
        """Sizes (4, groups) by kind of error."""
        return np.array([self.noise, self.drift, self.model, self.state])

    def _with(self, table: FloatArray) -> 'ErrorSizes':
        noise, drift, model, state = map(tuple, table.tolist())
        return replace(self, noise=noise, drift=drift, model=model, state=state)


NO_ERROR = (0.0,) * len(GROUPS)

EXACT_MODEL = ErrorSizes(drift=NO_ERROR, model=NO_ERROR, state=NO_ERROR, swift=0.0)
"""White noise as it scatters, of a model without errors."""


@dataclass(frozen=True)
class GroupRows:
    """Rows (m,) of one group of channels.

    Given are stretch and channel of each mean that is there, its noise, the std there of a drift,
    an error of the model and one of the state of size 1, and its change from stretch to stretch.
    """

    stretches: IntArray
    channels: IntArray
    times: FloatArray
    noise: FloatArray
    drift: FloatArray
    model: FloatArray
    state: FloatArray
    change: FloatArray

    def processes(self, times: ErrorTimes) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Covariances (m, m) of a drift, an error of the model and one of the state of size 1."""
        apart = np.abs(self.times[:, None] - self.times)
        same = self.channels[:, None] == self.channels
        return (
            np.where(same, np.outer(self.drift, self.drift) * np.exp(-apart / times.drift), 0.0),
            np.outer(self.model, self.model) * np.exp(-apart / times.model),
            np.where(same, np.outer(self.state, self.state) * np.exp(-apart / times.state), 0.0),
        )

    def covariance(self, sizes: FloatArray, times: ErrorTimes) -> FloatArray:
        """Covariance (m, m) of the errors by their sizes (5,)."""
        return total_covariance(self.noise, self.change, self.processes(times), sizes)


def total_covariance(
    noise: FloatArray,
    change: FloatArray,
    processes: tuple[FloatArray, FloatArray, FloatArray],
    sizes: FloatArray,
) -> FloatArray:
    """Covariance (m, m) of noise and change (m,) and of processes, by sizes (5,)."""
    drift, model, state = processes
    total = sizes[1] ** 2 * drift + sizes[2] ** 2 * model + sizes[3] ** 2 * state
    total[np.diag_indices_from(total)] += (sizes[0] * noise) ** 2 + (sizes[4] * change) ** 2
    return np.asarray(total, np.float64)


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
    change = changes(tow.means)
    found = []
    for group in GROUPS:
        own = np.array([name == group for name in groups], dtype=bool)
        stretches, channels = np.nonzero(there & own)
        values = np.abs(predicted[stretches, channels])
        names = [tow.channels[c] for c in channels]
        found.append(
            GroupRows(
                stretches,
                channels,
                tow.middles[stretches],
                noise[stretches, channels],
                np.array([CHANNELS[name].noise for name in names]),
                model_std(names[0], values) if names else values,
                np.array([_state_std(*one) for one in zip(names, values, strict=True)]),
                change[stretches, channels],
            )
        )
    return found


def _state_std(channel: str, value: float) -> float:
    row = CHANNELS[channel]
    return row.state_std(row.bias_std(value), STATE_SHARE)


def changes(means: FloatArray) -> FloatArray:
    """Change of means (n, k) from the stretch before or to the one behind.

    It is the larger one, and 0 where both are missing.
    """
    steps = np.abs(np.diff(means, axis=0))
    none = np.full((1, means.shape[1]), np.nan)
    found: FloatArray = np.fmax(np.vstack((none, steps)), np.vstack((steps, none)))
    return np.nan_to_num(found)
