# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Measured inputs of a tow (warp lengths, speed, heading), and their corrections for errors.

An input u is measured as u + e. The error e has a constant part, an offset or a fraction of the
value (`INPUT_ERRORS`), and may have a part that varies in time, linear between knots (`Knots`).
Corrected inputs are the measured ones minus e, so all derivatives by errors are negative.

Letters in shapes: t grid points, e constant errors, m errors in all; the last axis of length 3 is
`INPUTS`, port and starboard warp length (m) and speed (m/s).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, Slice
from trawl_ros.estimation.fit.error_terms import channel_errors
from trawl_ros.estimation.motion.towing.knots import Knots, hats
from trawl_ros.records.channels import INPUTS
from trawl_ros.solver.motion.course import InputPoint

INPUT_ERRORS = channel_errors(INPUTS)
"""Constant errors of the warp counters and the log through a tow, by the channel table."""


@dataclass(frozen=True)
class TowInputs:
    """Measured inputs of a tow, smoothed, on an equally spaced time grid.

    Attributes
    ----------
    grid_s
        Step of the grid, s.
    values, rates : (t, 3) arrays
        Port and starboard warp length (m) and speed (m/s), and their rates of change.
    headings, yaw_rates : (t,) arrays
        Unwrapped ENU yaw (rad) and rate of turn (rad/s).
    knots
        Knots of the time-varying errors, one item per input that has them.
    hours
        Time from the beginning of the tow to the first grid point, h.
    """

    grid_s: float
    values: FloatArray
    rates: FloatArray
    headings: FloatArray
    yaw_rates: FloatArray
    knots: tuple[Knots, ...] = ()
    hours: float = 0.0

    @property
    def number_of_knots(self) -> int:
        """Number of knots of all inputs together."""
        return sum(knots.number for knots in self.knots)

    @property
    def knot_places(self) -> tuple[tuple[Knots, Slice, int], ...]:
        """Knots of each input, their slice of all knots, and the row of their first derivative.

        The rows are those of `CorrectedInputs.names`.
        """
        places, number, column = [], 0, len(INPUT_ERRORS)
        for knots in self.knots:
            places.append((knots, slice(number, number + knots.number), column))
            number, column = number + knots.number, column + knots.columns
        return tuple(places)

    @property
    def duration_s(self) -> float:
        """Time from the first to the last grid point, s."""
        return (len(self.values) - 1) * self.grid_s

    def at(self, time: float) -> tuple[FloatArray, FloatArray, float, float]:
        """Interpolate the inputs at a time (s after the first grid point).

        Returns
        -------
        tuple
            Inputs (3,), their rates (3,), heading (rad) and rate of turn (rad/s). Inputs follow
            the cubic Hermite spline through values and rates of the grid. Heading and rate of turn
            are linear between grid points.
        """
        place = min(max(time / self.grid_s, 0.0), len(self.values) - 1.0)
        first = min(int(place), len(self.values) - 2)
        # x in [0, 1] is the place between grid points of values a, b and rates v, w, h apart.
        x, h = place - first, self.grid_s
        (a, b), (v, w) = self.values[first : first + 2], self.rates[first : first + 2]
        rise, slope = b - a, (v * (1 - x) - w * x) * (1 - x) * x * h
        value = a + rise * x * x * (3 - 2 * x) + slope
        rate = rise / h * 6 * x * (1 - x) + v * (1 - x) * (1 - 3 * x) + w * x * (3 * x - 2)
        heading = float(np.interp(place, [first, first + 1], self.headings[first : first + 2]))
        yaw_rate = float(np.interp(place, [first, first + 1], self.yaw_rates[first : first + 2]))
        return value, rate, heading, yaw_rate


@dataclass(frozen=True)
class MeanInputs:
    """Corrected inputs averaged over a time.

    Attributes
    ----------
    values : (3,) array
        Warp lengths (m) and speed (m/s).
    by_errors : (e, 3) array
        Derivatives by each of `INPUT_ERRORS`, per std.
    by_knots
        Derivatives (number of knots,) of each input by its own errors (SI) at its knots.
    heading, hours
        ENU yaw (rad), and time (h) since the tow began.
    """

    values: FloatArray
    by_errors: FloatArray
    by_knots: Mapping[str, FloatArray]
    heading: float
    hours: float


@dataclass(frozen=True)
class CorrectedInputs:
    """Inputs of a tow, corrected for errors of the instruments, and derivatives by these errors.

    A call returns the corrected inputs at a time, as the motion solver needs them.

    Attributes
    ----------
    inputs
        Measured inputs.
    errors : (e,) array
        Values of `INPUT_ERRORS`, in std.
    drifts : (knots,) array
        Time-varying errors at all knots, m or m/s.
    begin
        Time (s) of the tow at which the simulated motion begins.
    """

    inputs: TowInputs
    errors: FloatArray
    drifts: FloatArray
    begin: float = 0.0

    @property
    def names(self) -> tuple[str, ...]:
        """Names (m) of the errors by which a motion is differentiated.

        A knot's error affects the gear only for a while, so the knots of an input take turns in a
        fixed number of names (`Knots.columns`).
        """
        return (
            *(error.name for error in INPUT_ERRORS),
            *(
                f'{knots.channel} {number + 1}'
                for knots in self.inputs.knots
                for number in range(knots.columns)
            ),
        )

    def __call__(self, time: float) -> InputPoint:
        """Return the corrected inputs at a time, s after the motion began."""
        time += self.begin
        measured, rates, heading, yaw_rate = self.inputs.at(time)
        by_errors, rates_by_errors = self._derivatives(time, measured, rates)
        value, rate = measured.copy(), rates.copy()
        constant = len(INPUT_ERRORS)
        value += self.errors @ by_errors[:constant]
        rate += self.errors @ rates_by_errors[:constant]
        for knots, own, _ in self.inputs.knot_places:
            column = INPUTS.index(knots.channel)
            value[column] -= knots.hats(time) @ self.drifts[own]
            rate[column] -= knots.hat_rates(time) @ self.drifts[own]
        hours = self.inputs.hours + time / 3600.0
        return InputPoint(value, rate, heading, yaw_rate, hours, by_errors, rates_by_errors)

    def mean(self, begin: float, end: float) -> MeanInputs:
        """Return the mean of the corrected inputs between two times, s since the tow began."""
        inputs, step = self.inputs, self.inputs.grid_s
        first = min(max(round(begin / step), 0), len(inputs.values) - 1)
        last = min(max(round(end / step), first), len(inputs.values) - 1)
        own = slice(first, last + 1)
        measured = inputs.values[own].mean(axis=0)
        by_errors, by_knots = _by_constant_errors(measured, 1.0), {}
        value = measured + self.errors @ by_errors
        for knots, place, _ in inputs.knot_places:
            times: FloatArray = step * np.arange(first, last + 1, dtype=np.float64)
            by_knots[knots.channel] = -hats(times, knots.number, knots.spacing_s).mean(axis=0)
            value[INPUTS.index(knots.channel)] += by_knots[knots.channel] @ self.drifts[place]
        heading = float(inputs.headings[own].mean())
        hours = inputs.hours + 0.5 * step * (first + last) / 3600.0
        return MeanInputs(value, by_errors, by_knots, heading, hours)

    def _derivatives(
        self, time: float, measured: FloatArray, rates: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return derivatives of corrected inputs and of their rates, both (m, 3), by `names`.

        Those by constant errors are per std, those by knots per SI unit of the error.
        """
        by_errors, rates_by_errors = np.zeros((2, len(self.names), 3))
        by_errors[: len(INPUT_ERRORS)] = _by_constant_errors(measured, 1.0)
        # A constant offset does not change a rate; a scale error does.
        rates_by_errors[: len(INPUT_ERRORS)] = _by_constant_errors(rates, 0.0)
        for knots, _, first in self.inputs.knot_places:
            column = INPUTS.index(knots.channel)
            values, slopes = knots.hats(time), knots.hat_rates(time)
            for knot in knots.acting(time):
                row = first + knot % knots.columns
                by_errors[row, column] = -values[knot]
                rates_by_errors[row, column] = -slopes[knot]
        return by_errors, rates_by_errors


def corrected(shown: FloatArray, errors: FloatArray) -> FloatArray:
    """Return measured inputs (3,), corrected for errors (e,) of `INPUT_ERRORS` in std."""
    true: FloatArray = shown + errors @ _by_constant_errors(shown, 1.0)
    return true


def _by_constant_errors(values: FloatArray, offset: float) -> FloatArray:
    """Return derivatives (e, 3) of corrected inputs, or of their rates, by `INPUT_ERRORS`, per std.

    ``values`` (3,) are measured inputs and ``offset`` is 1, or they are rates and it is 0.
    """
    derivatives = np.zeros((len(INPUT_ERRORS), 3))
    for row, error in enumerate(INPUT_ERRORS):
        column = INPUTS.index(error.channel)
        derivatives[row, column] = -error.std * (values[column] if error.relative else offset)
    return derivatives


def without_errors(inputs: TowInputs, begin: float = 0.0) -> CorrectedInputs:
    """Return the measured inputs with all errors taken as 0."""
    none = np.zeros(inputs.number_of_knots)
    return CorrectedInputs(inputs, np.zeros(len(INPUT_ERRORS)), none, begin)


def on_grid(
    times: FloatArray, values: FloatArray, grid: FloatArray, reach_s: float
) -> tuple[FloatArray, FloatArray]:
    """Smooth readings onto a grid by local linear regression with tricube weights.

    This is LOESS without its robust step (Cleveland 1979), with a fixed bandwidth.

    Parameters
    ----------
    times, values
        Times (n,), s, and readings (n,).
    grid
        Times (t,) of the grid, s.
    reach_s
        Half-width of the window, s. Where it holds fewer than four readings, four
        neighbouring ones are used.

    Returns
    -------
    tuple
        Values (t,) and rates (t,), per s.
    """
    first, last = np.searchsorted(times, (grid - reach_s, grid + reach_s))
    few = last - first < 4
    first = np.where(few, np.maximum(np.minimum(first - 2, len(times) - 4), 0), first)
    last = np.where(few, np.minimum(first + 4, len(times)), last)
    places = first[:, None] + np.arange(np.max(last - first))
    inside = places < last[:, None]
    places = np.minimum(places, len(times) - 1)
    offsets, neighbours = times[places] - grid[:, None], values[places]
    distances = np.abs(offsets)
    # The factor leaves the farthest reading a small weight.
    bandwidth = 1.0001 * np.maximum(reach_s, np.max(distances, axis=1, where=inside, initial=0.0))
    # A relative distance of 1 gives weight 0 to the padding.
    relative = np.where(inside, distances / bandwidth[:, None], 1.0)
    weights = (1.0 - relative**3) ** 3
    weights /= np.sum(weights, axis=1, keepdims=True)
    mean_offset, mean = np.sum(weights * offsets, axis=1), np.sum(weights * neighbours, axis=1)
    offsets -= mean_offset[:, None]
    square = np.sum(weights * offsets**2, axis=1)
    rates = np.sum(weights * offsets * neighbours, axis=1) / np.where(square > 0.0, square, 1.0)
    # The line passes through the mean at the mean offset; its value at the grid point is wanted.
    return mean - rates * mean_offset, rates


def stacked(series: Sequence[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Stack m series of values (t,) and rates (t,) as columns, both (t, m)."""
    return np.column_stack([s[0] for s in series]), np.column_stack([s[1] for s in series])
