"""Sizes of the errors by the marginal likelihood of all data, with a prior on each size."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize, minimize_scalar

from trawl_ros.core.arrays import FloatArray, Slice
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.motion.information import (
    Information,
    LinearGroup,
    group_information,
    joined,
)
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes

SPREAD = np.array([0.3, 1.0, 0.7])
"""Std of the logarithms of the sizes of noise, drift and model's error before the data speak."""

LOG_SPREAD = 0.3
"""Std of the logarithm of the size of the log's errors."""

SIMPLEX = 0.5
"""First steps of the search, in these std."""

SWEEPS = 2


@dataclass(frozen=True)
class LinearData:
    """Linearised tows: groups of each, place of the log's errors among its parameters."""

    tows: tuple[tuple[LinearGroup, ...], ...]
    logs: tuple[Slice, ...]
    shared: int
    times: ErrorTimes

    def precisions(self, log: float) -> list[FloatArray]:
        """Prior precisions of the parameters of each tow, by the size of the log's errors."""
        found = []
        for groups, place in zip(self.tows, self.logs, strict=True):
            precision = np.ones(groups[0].columns.shape[1])
            precision[place] = log**-2
            found.append(precision)
        return found

    def information(self, sizes: ErrorSizes) -> list[Information]:
        """Information of each tow."""
        return [_total(group_information(groups, sizes, self.times)) for groups in self.tows]


def _total(parts: Sequence[Information]) -> Information:
    total = parts[0]
    for part in parts[1:]:
        total = total + part
    return total


def estimated_sizes(data: LinearData, expected: ErrorSizes, start: ErrorSizes) -> ErrorSizes:
    """Most likely sizes.

    Parameters
    ----------
    data
        Linearised tows.
    expected
        Medians of the sizes before the data speak; a size of 0 stays 0.
    start
        Sizes to begin with.
    """
    sizes = start
    for _ in range(SWEEPS):
        for group in range(len(GROUPS)):
            if any(len(groups[group].residual) for groups in data.tows):
                sizes = _of_group(data, expected, sizes, group)
        if any(place.stop > place.start for place in data.logs):
            sizes = _of_log(data, expected, sizes)
    return sizes


def _of_group(data: LinearData, expected: ErrorSizes, sizes: ErrorSizes, group: int) -> ErrorSizes:
    known, free = expected.of_group(group), expected.of_group(group) > 0.0
    precisions = data.precisions(sizes.log)
    others = []
    for groups in data.tows:
        parts = group_information(groups, sizes, data.times)
        others.append(_total([part for number, part in enumerate(parts) if number != group]))

    def factors(logs: FloatArray) -> FloatArray:
        full = np.zeros(3)
        full[free] = known[free] * np.exp(logs * SPREAD[free])
        return full

    def cost(logs: FloatArray) -> float:
        own = factors(logs)
        tows = [
            other + groups[group].information(own, data.times)
            for other, groups in zip(others, data.tows, strict=True)
        ]
        found = joined(tows, precisions, data.shared).negative_log_likelihood
        return found + 0.5 * float(logs @ logs)

    start = np.log(sizes.of_group(group)[free] / known[free]) / SPREAD[free]
    # Left to itself the simplex begins with steps of 0.00025 about 0, and ends there.
    simplex = start + SIMPLEX * np.vstack((np.zeros(len(start)), np.eye(len(start))))
    options = {'initial_simplex': simplex, 'xatol': 0.03, 'fatol': 0.01, 'maxfev': 80}
    best = minimize(cost, start, method='Nelder-Mead', options=options)
    return sizes.having(group, *map(float, factors(best.x)))


def _of_log(data: LinearData, expected: ErrorSizes, sizes: ErrorSizes) -> ErrorSizes:
    tows = data.information(sizes)

    def cost(logarithm: float) -> float:
        size = expected.log * np.exp(logarithm * LOG_SPREAD)
        found = joined(tows, data.precisions(size), data.shared).negative_log_likelihood
        return found + 0.5 * logarithm**2

    best = minimize_scalar(cost, bounds=(-4.0, 4.0), method='bounded', options={'xatol': 0.02})
    return replace(sizes, log=float(expected.log * np.exp(best.x * LOG_SPREAD)))
