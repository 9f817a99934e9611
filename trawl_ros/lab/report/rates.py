# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rates, medians and other figures of trials with their intervals, as rows of a report."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.stats import binomtest

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.lab.report.measured import MeasuredValue, TargetRange, between

EXACT = 'binomial 95 % interval (Clopper and Pearson)'
AGAIN = 'interval by drawing trials again'
RESAMPLINGS, RESAMPLING_SEED = 1000, 7

Figures = Callable[[IntArray], FloatArray]
"""Figures (n,) of the trials that are chosen by their places, some of them several times."""


def interval(figures: Figures, number: int) -> tuple[FloatArray, FloatArray]:
    """Bootstrap 95 % interval of figures over so many trials: lower and upper ends."""
    if number < 2:
        nothing = np.full(np.shape(figures(np.arange(number))), np.nan)
        return nothing, nothing
    rng = np.random.default_rng(RESAMPLING_SEED)
    found = np.array([figures(rng.integers(number, size=number)) for _ in range(RESAMPLINGS)])
    low, high = np.percentile(found, (2.5, 97.5), axis=0)
    return low, high


def figure_row(
    what: str,
    figure: Callable[[IntArray], float],
    number: int,
    unit: str,
    target: TargetRange | None,
    note: str,
) -> MeasuredValue:
    """Row of one figure over so many trials, with its bootstrap interval."""
    low, high = interval(lambda some: np.array(figure(some)), number)
    value = float(figure(np.arange(number)))
    return MeasuredValue(what, value, unit, target, note, low=float(low), high=float(high))


def rate(
    what: str,
    outcomes: Sequence[bool],
    *,
    least: float | None = None,
    most: float | None = None,
    note: str = '',
) -> MeasuredValue:
    """Rate of an outcome, %, with its interval."""
    if not outcomes:
        return MeasuredValue(what, np.nan, '%', between(least, most), 'no trials')
    count, number = sum(outcomes), len(outcomes)
    ends = binomtest(count, number).proportion_ci(method='exact')
    counted = f'{count} of {number}; {note or EXACT}'
    low, high = 100.0 * ends.low, 100.0 * ends.high
    return MeasuredValue(
        what, 100.0 * count / number, '%', between(least, most), counted, low, high
    )
