# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""States and sensors of a comparison: differences with their errors, and trends."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from trawl_ros.comparison.rows import Rows
from trawl_ros.core.arrays import FloatArray
from trawl_ros.records.channels import CHANNELS

LEAST_SPREAD = 0.02
"""Least relative std of an axis, warp or speed, along which a trend is looked for."""


@dataclass(frozen=True)
class Compared:
    """Measured and reference value, SI, and their difference.

    Attributes
    ----------
    measured, reference, std
        Values, and the std of the error of their difference.
    difference, fraction, scaled
        Measured minus reference, as a part of the reference, and in std of its error.
    """

    measured: float
    reference: float
    std: float
    difference: float
    fraction: float
    scaled: float

    @classmethod
    def of(cls, measured: float, reference: float, std: float) -> 'Compared':
        """Return both values with their difference."""
        off = measured - reference
        part = off / abs(reference) if reference else math.nan
        return cls(measured, reference, std, off, part, off / std)


@dataclass(frozen=True)
class ComparedState:
    """One steady state, or one stretch of time: its operation, and what its sensors show.

    Attributes
    ----------
    log
        Index of the log it is from.
    hours
        Time from the start of the log to its middle, h.
    inputs
        Warp lengths (m), port and starboard, and speed (m/s), as measured.
    sensors
        Channel → what it shows.
    """

    log: int
    hours: float
    inputs: tuple[float, float, float]
    sensors: Mapping[str, Compared]

    @property
    def axes(self) -> dict[str, float]:
        """Mean warp length (m), speed (m/s) and time (h) by axis."""
        port, starboard, speed = self.inputs
        return {'warp': 0.5 * (port + starboard), 'speed': speed, 'time': self.hours}


@dataclass(frozen=True)
class Trend:
    """Straight line through the differences of a channel over warp, speed or time.

    ``ends`` are the least and largest value of the ``axis`` (SI, h), ``at_ends`` the difference
    there: a part of the reference, or rad of an angle. ``scaled`` is the slope in std of its error.
    """

    axis: str
    ends: tuple[float, float]
    at_ends: tuple[float, float]
    scaled: float


@dataclass(frozen=True)
class ComparedSensor:
    """One sensor over all states.

    Attributes
    ----------
    channel, unit
        Name, and SI unit.
    mean
        Means over the states.
    fractions : (s,) array
        Difference in each state, a part of the reference, or rad of an angle.
    trends
        Trends over warp, speed and time, where these change.
    """

    channel: str
    unit: str
    mean: Compared
    fractions: FloatArray
    trends: tuple[Trend, ...]

    @property
    def states(self) -> int:
        """Number of states with this sensor."""
        return len(self.fractions)

    @property
    def is_angle(self) -> bool:
        """True of an angle, which has no relative difference."""
        return self.unit == 'rad'

    @property
    def relative(self) -> float:
        """Mean difference: a part of the reference, or rad of an angle."""
        return self.mean.difference if self.is_angle else self.mean.fraction


@dataclass(frozen=True)
class Summary:
    """Means and trends of all channels as one vector with its covariance.

    Attributes
    ----------
    channels
        Channel of each of the q elements.
    values, covariance : (q,) and (q, q) arrays
        Differences, and the covariance of their errors.
    by_coefficients : (q, 12) array or None
        Their change by the board's coefficients, per std of the prior, sign reversed.
    """

    channels: tuple[str, ...]
    values: FloatArray
    covariance: FloatArray
    by_coefficients: FloatArray | None


def states_of(rows: Rows) -> tuple[ComparedState, ...]:
    """Average the rows of each state."""
    found = []
    for state in range(1 + int(rows.state.max(initial=-1))):
        own = rows.state == state
        port, starboard, speed = map(float, rows.inputs[own].mean(axis=0))
        sensors = {}
        for column, name in enumerate(rows.channels):
            if (with_it := own & rows.present[:, column]).any():
                sensors[name] = _compared(rows, column, with_it / with_it.sum())
        log, hours = int(rows.log[own][0]), float(rows.hours[own].mean())
        found.append(ComparedState(log, hours, (port, starboard, speed), sensors))
    return tuple(found)


def _compared(rows: Rows, column: int, weights: FloatArray) -> Compared:
    """Return the mean of a channel with weights (n,)."""
    variance = rows.errors.covariance(_in_column(rows, column, weights[None]))[0, 0]
    measured, reference = weights @ rows.measured[:, column], weights @ rows.reference[:, column]
    return Compared.of(float(measured), float(reference), math.sqrt(variance))


def _in_column(rows: Rows, column: int, weights: FloatArray) -> FloatArray:
    """Return weights (q, n) of one channel as weights (q, n, k) of all."""
    full = np.zeros((len(weights), *rows.present.shape))
    full[:, :, column] = weights
    return full


def sensors_of(
    rows: Rows, states: tuple[ComparedState, ...]
) -> tuple[tuple[ComparedSensor, ...], Summary]:
    """Summarise every channel over its states."""
    sensors, names, weights = [], [], []
    for column, name in enumerate(rows.channels):
        by_state, own = rows.by_state(column)
        if not len(own):
            continue
        unit = CHANNELS[name].unit
        seen = [states[state].sensors[name] for state in own]
        scale = np.array([1.0 if unit == 'rad' else max(abs(one.reference), 1e-9) for one in seen])
        fractions = np.array([one.difference for one in seen]) / scale
        axes = _axes([states[state] for state in own])
        lines = [np.full(len(own), 1.0 / len(own)), *(_slope(axes[axis]) / scale for axis in axes)]
        full = _in_column(rows, column, np.array(lines) @ by_state)
        stds = np.sqrt(np.diag(rows.errors.covariance(full)))
        trends = tuple(
            _trend(axis, values, fractions, float(std))
            for (axis, values), std in zip(axes.items(), stds[1:], strict=True)
        )
        mean = _compared(rows, column, by_state.mean(axis=0))
        sensors.append(ComparedSensor(name, unit, mean, fractions, trends))
        # Row 0 is the mean. Time is left out: the drift of a sensor says nothing about the boards.
        kept = [0, *(1 + i for i, axis in enumerate(axes) if axis != 'time')]
        weights.append(full[kept])
        names += [name] * len(kept)
    together = np.concatenate(weights)
    by_coefficients = None
    if rows.by_coefficients is not None:
        by_coefficients = np.einsum('qnk,nkc->qc', together, rows.by_coefficients)
    values = np.einsum('qnk,nk->q', together, rows.difference)
    covariance = rows.errors.covariance(together)
    return tuple(sensors), Summary(tuple(names), values, covariance, by_coefficients)


def _axes(states: list[ComparedState]) -> dict[str, FloatArray]:
    """Return warp, speed and hours of states, where they change."""
    rows = [state.axes for state in states]
    found = {axis: np.array([row[axis] for row in rows]) for axis in rows[0]}
    logs = {state.log for state in states}
    return {
        axis: values
        for axis, values in found.items()
        if len(states) > 2
        and np.std(values) > LEAST_SPREAD * abs(np.mean(values))
        and (axis != 'time' or len(logs) == 1)
    }


def _slope(values: FloatArray) -> FloatArray:
    """Return weights (s,) of the slope of a line of least squares, per std of the axis.

    With z = (x - mean x) / std x, the slope of y over z is Σ z y / s.
    """
    away = values - values.mean()
    slope: FloatArray = away / np.sqrt(np.mean(away**2)) / len(values)
    return slope


def _trend(axis: str, values: FloatArray, fractions: FloatArray, std: float) -> Trend:
    slope = float(_slope(values) @ fractions)
    low, high = float(values.min()), float(values.max())
    at = [
        float(fractions.mean() + slope * (end - values.mean()) / np.std(values))
        for end in (low, high)
    ]
    return Trend(axis, (low, high), (at[0], at[1]), slope / std)
