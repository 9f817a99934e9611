# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Values of an effect that are known together and not each alone."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.inference.posterior import Explanation
from trawl_ros.diagnosis.report.common_units import in_common_unit

BETTER = 0.3
"""A sum or difference is given if its std is below this part of either value's."""

WIDTH = 1.96
"""Half a 95 % interval, in std."""


def known_together(best: Explanation) -> Iterator[str]:
    """Yield a sentence on each two values of which sum or difference alone is known well.

    Where only the difference of upper and lower bridles shows, the intervals of both are wide.
    """
    if best.refit is None:
        return
    estimate, refit = best.refit.estimate, best.refit
    for suspect, block in zip(best.suspects, refit.fit.prior.blocks('effect'), strict=True):
        for own, (i, j) in zip(
            combinations(suspect.entry.effect.parameters, 2), combinations(block, 2), strict=True
        ):
            first, second = own
            if first.unit != second.unit:
                continue
            value, std, word = sharper(estimate.values, estimate.covariance, i, j)
            if std > BETTER * min(estimate.std[i], estimate.std[j]):
                continue
            low, high = value - WIDTH * std, value + WIDTH * std
            size = in_common_unit(value, low, high, first.unit)
            yield (
                f'Of {suspect.entry.name.replace("_", " ")} {first.name.replace("_", " ")} {word} '
                f'{second.name.replace("_", " ")} is known, {size}, better than each alone.'
            )


def sharper(values: FloatArray, covariance: FloatArray, i: int, j: int) -> tuple[float, float, str]:
    """Sum or difference of two values, whichever is known better, with its std and word."""
    sign = -1.0 if covariance[i, j] > 0.0 else 1.0
    variance = covariance[i, i] + covariance[j, j] + 2.0 * sign * covariance[i, j]
    std = float(np.sqrt(max(variance, 0.0)))
    return float(values[i] + sign * values[j]), std, 'less' if sign < 0.0 else 'and'
