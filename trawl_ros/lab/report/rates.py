"""Rates and medians of trials with their intervals, as rows of a report."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import binomtest

from trawl_ros.lab.report.measured import MeasuredValue, between

EXACT = 'binomial 95 % interval (Clopper and Pearson)'
AGAIN = 'median; 95 % interval by drawing trials again'
DRAWS = 1000


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


def median(
    what: str,
    values: Sequence[float],
    unit: str,
    *,
    least: float | None = None,
    most: float | None = None,
) -> MeasuredValue:
    """The median, of trials whose effect was named rightly."""
    if not values:
        return MeasuredValue(what, np.nan, unit, between(least, most), 'no trials')
    known = np.array(values)
    chance = np.random.default_rng(0)
    drawn = np.median(known[chance.integers(len(known), size=(DRAWS, len(known)))], axis=1)
    low, high = np.percentile(drawn, (2.5, 97.5))
    note = f'{len(known)} trials named rightly at 3 and 6 times; {AGAIN}'
    middle, target = float(np.median(known)), between(least, most)
    return MeasuredValue(what, middle, unit, target, note, float(low), float(high))
