# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Inputs of a tow: warp lengths, speed and heading as instruments show them, and their errors."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, Slice
from trawl_ros.estimation.motion.towing.knots import Knots, hats
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.solver.motion.course import InputPoint


@dataclass(frozen=True)
class ChannelError:
    """Error of a channel that stays through the tow.

    It is what the instrument reads too much, as a part of the value where ``relative``.
    """

    channel: str
    std: float
    relative: bool

    @property
    def name(self) -> str:
        """Name of the parameter."""
        return f'{self.channel} {"scale" if self.relative else "offset"}'


def channel_errors(channels: Sequence[str]) -> tuple[ChannelError, ...]:
    """Errors of channels, by the channel table."""
    return tuple(
        ChannelError(name, std, relative)
        for name in channels
        for std, relative in ((CHANNELS[name].bias, False), (CHANNELS[name].bias_fraction, True))
        if std > 0.0
    )


INPUT_ERRORS = channel_errors(INPUTS)
"""Errors of counters and log through a tow, by the channel table."""


@dataclass(frozen=True)
class TowInputs:
    """Inputs of a tow, smoothed, on a grid of equal steps.

    Attributes
    ----------
    grid_s
        Step of the grid.
    values, rates : (t, 3) arrays
        Port and starboard warp length (m) and speed (m/s), and their rates of change.
    headings, yaw_rates : (t,) arrays
        ENU yaw (rad) without leaps, and rate of turn (rad/s).
    knots
        Of errors along the way, input by input; those without have none but `INPUT_ERRORS`.
    hours
        Since the tow began, at the first of the grid.
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
        """Number of all knots."""
        return sum(knots.number for knots in self.knots)

    @property
    def knot_places(self) -> tuple[tuple[Knots, Slice, int], ...]:
        """Knots, their slice among all knots, and the first of their columns."""
        places, number, column = [], 0, len(INPUT_ERRORS)
        for knots in self.knots:
            places.append((knots, slice(number, number + knots.number), column))
            number, column = number + knots.number, column + knots.columns
        return tuple(places)

    @property
    def duration_s(self) -> float:
        """Time from the first to the last of the grid."""
        return (len(self.values) - 1) * self.grid_s

    def at(self, time: float) -> tuple[FloatArray, FloatArray, float, float]:
        """Inputs (3,) and rates (3,) on the cubic through the grid, heading and rate of turn."""
        place = min(max(time / self.grid_s, 0.0), len(self.values) - 1.0)
        first = min(int(place), len(self.values) - 2)
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
    """Inputs averaged over a time.

    Attributes
    ----------
    values : (3,) array
        Warp lengths (m) and speed (m/s).
    by_errors : (e, 3) array
        Derivatives by a std of each of `INPUT_ERRORS`.
    by_knots
        Derivatives (number,) of each input by its errors at all knots, input by input.
    heading, hours
        ENU yaw (rad), and time since the tow began.
    """

    values: FloatArray
    by_errors: FloatArray
    by_knots: Mapping[str, FloatArray]
    heading: float
    hours: float


@dataclass(frozen=True)
class CorrectedInputs:
    """Inputs of a tow, corrected for errors of their instruments, with their derivatives.

    Attributes
    ----------
    inputs
        As the instruments show them.
    errors : (e,) array
        Errors of `INPUT_ERRORS`, in std.
    drifts : (knots,) array
        Errors at all knots, SI.
    begin
        Time (s) of the tow at which the motion is begun.
    """

    inputs: TowInputs
    errors: FloatArray
    drifts: FloatArray
    begin: float = 0.0

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the additions to the inputs by which a motion is differentiated."""
        return (
            *(error.name for error in INPUT_ERRORS),
            *(
                f'{knots.channel} {number + 1}'
                for knots in self.inputs.knots
                for number in range(knots.columns)
            ),
        )

    def __call__(self, time: float) -> InputPoint:
        """Inputs so many seconds after the motion began."""
        time += self.begin
        shown, rates, heading, yaw_rate = self.inputs.at(time)
        additions, paces = self._additions(time, shown, rates)
        value, rate = shown.copy(), rates.copy()
        stays = len(INPUT_ERRORS)
        value += self.errors @ additions[:stays]
        rate += self.errors @ paces[:stays]
        for knots, own, _ in self.inputs.knot_places:
            column = INPUTS.index(knots.channel)
            value[column] -= knots.hats(time) @ self.drifts[own]
            rate[column] -= knots.hat_rates(time) @ self.drifts[own]
        hours = self.inputs.hours + time / 3600.0
        return InputPoint(value, rate, heading, yaw_rate, hours, additions, paces)

    def mean(self, begin: float, end: float) -> MeanInputs:
        """Mean from one time (s since the tow began) to another."""
        inputs, step = self.inputs, self.inputs.grid_s
        first = min(max(round(begin / step), 0), len(inputs.values) - 1)
        last = min(max(round(end / step), first), len(inputs.values) - 1)
        own = slice(first, last + 1)
        shown = inputs.values[own].mean(axis=0)
        by_errors, by_knots = _by_errors(shown, 1.0), {}
        value = shown + self.errors @ by_errors
        for knots, place, _ in inputs.knot_places:
            times: FloatArray = step * np.arange(first, last + 1, dtype=np.float64)
            by_knots[knots.channel] = -hats(times, knots.number, knots.spacing_s).mean(axis=0)
            value[INPUTS.index(knots.channel)] += by_knots[knots.channel] @ self.drifts[place]
        heading = float(inputs.headings[own].mean())
        hours = inputs.hours + 0.5 * step * (first + last) / 3600.0
        return MeanInputs(value, by_errors, by_knots, heading, hours)

    def _additions(
        self, time: float, shown: FloatArray, rates: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Additions to inputs and rates, both (m, 3), by a unit of each parameter.

        What is shown too large is less in truth.
        """
        additions, paces = np.zeros((2, len(self.names), 3))
        additions[: len(INPUT_ERRORS)] = _by_errors(shown, 1.0)
        paces[: len(INPUT_ERRORS)] = _by_errors(rates, 0.0)
        for knots, _, first in self.inputs.knot_places:
            column = INPUTS.index(knots.channel)
            values, slopes = knots.hats(time), knots.hat_rates(time)
            for knot in knots.acting(time):
                row = first + knot % knots.columns
                additions[row, column], paces[row, column] = -values[knot], -slopes[knot]
        return additions, paces


def corrected(shown: FloatArray, errors: FloatArray) -> FloatArray:
    """Inputs (3,) as shown, corrected for errors (e,) of `INPUT_ERRORS`, in std."""
    true: FloatArray = shown + errors @ _by_errors(shown, 1.0)
    return true


def _by_errors(values: FloatArray, offset: float) -> FloatArray:
    """Additions (e, 3) to values (3,) by a std of each of `INPUT_ERRORS`.

    Those that are no part of a value add to ``offset``. What is shown too large is less in truth.
    """
    additions = np.zeros((len(INPUT_ERRORS), 3))
    for row, error in enumerate(INPUT_ERRORS):
        column = INPUTS.index(error.channel)
        additions[row, column] = -error.std * (values[column] if error.relative else offset)
    return additions


def without_errors(inputs: TowInputs, begin: float = 0.0) -> CorrectedInputs:
    """Inputs taken as they are shown."""
    none = np.zeros(inputs.number_of_knots)
    return CorrectedInputs(inputs, np.zeros(len(INPUT_ERRORS)), none, begin)


def on_grid(
    times: FloatArray, values: FloatArray, grid: FloatArray, reach_s: float
) -> tuple[FloatArray, FloatArray]:
    """Smooth readings (n,) at times (n,) on a grid (t,), by local lines with tricube weights.

    Returns
    -------
    tuple
        Values and rates (t,), by the readings within ``reach_s``, or by the nearest four.
    """
    first, last = np.searchsorted(times, (grid - reach_s, grid + reach_s))
    few = last - first < 4
    first = np.where(few, np.maximum(np.minimum(first - 2, len(times) - 4), 0), first)
    last = np.where(few, np.minimum(first + 4, len(times)), last)
    places = first[:, None] + np.arange(np.max(last - first))
    inside = places < last[:, None]
    places = np.minimum(places, len(times) - 1)
    away, near = times[places] - grid[:, None], values[places]
    far = 1.0001 * np.maximum(reach_s, np.max(np.abs(away), axis=1, where=inside, initial=0.0))
    share = np.where(inside, np.abs(away) / far[:, None], 1.0)
    weights = (1.0 - share**3) ** 3
    weights /= np.sum(weights, axis=1, keepdims=True)
    middle, mean = np.sum(weights * away, axis=1), np.sum(weights * near, axis=1)
    away -= middle[:, None]
    square = np.sum(weights * away**2, axis=1)
    rates = np.sum(weights * away * near, axis=1) / np.where(square > 0.0, square, 1.0)
    return mean - rates * middle, rates


def stacked(series: Sequence[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Values and rates (t, m) of m series."""
    return np.column_stack([s[0] for s in series]), np.column_stack([s[1] for s in series])
