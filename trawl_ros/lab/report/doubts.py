# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Factors on an assumed number that bring a point near its measured value."""

import math
from collections.abc import Mapping
from itertools import pairwise

from trawl_ros.report.rendering import number

SEARCH_STEPS = 4000
"""Number of steps of a range of factors in this search."""


def factors_needed(
    values: Mapping[float, float], measured: float, tolerance: float
) -> tuple[float, float] | None:
    """Factors on an assumed number with which a value comes within a share of the measured one.

    Parameters
    ----------
    values
        Value of the model by factor, two or more; straight lines lie between them. Values that are
        missing (NaN) end the range.
    measured
        Measured value.
    tolerance
        Share of it within which the value is to be.

    Returns
    -------
    tuple of float, or None
        Ends of the range nearest to 1; None where no factor tried is enough.
    """
    known = sorted((factor, value) for factor, value in values.items() if not math.isnan(value))
    good: list[list[float]] = []
    for (low, first), (high, second) in pairwise(known):
        for step in range(SEARCH_STEPS + 1):
            share = step / SEARCH_STEPS
            factor = low + share * (high - low)
            inside = abs(first + share * (second - first) - measured) <= tolerance * measured
            if inside and good and abs(good[-1][1] - factor) <= (high - low) / SEARCH_STEPS * 1.5:
                good[-1][1] = factor
            elif inside:
                good.append([factor, factor])
    if not good:
        return None
    low, high = min(good, key=lambda ends: min(abs(ends[0] - 1.0), abs(ends[1] - 1.0)))
    return low, high


def need_in_words(values: Mapping[float, float], measured: float, tolerance: float) -> str:
    """Return the factors that a point needs in words, or that none of those tried is enough."""
    needed = factors_needed(values, measured, tolerance)
    if needed is None:
        return 'not enough'
    low, high = (number(factor) for factor in needed)
    return f'× {low}' if low == high else f'× {low} to {high}'
