# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sizes of the errors by the marginal likelihood of all data, with a prior on each size."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from trawl_ros.core.arrays import FloatArray, Slice
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.least_squares.information import Information, Joined, joined
from trawl_ros.estimation.motion.information import LinearGroup, group_information
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes, total_covariance

SPREAD = np.array([0.3, 1.0, 0.7, 0.7])
"""Std of the logarithms of the sizes of noise, drift, model's error and what changes with states
before the data speak."""

LOG_SPREAD = 0.3
"""Std of the logarithm of the size of the log's errors."""

FLOORED = np.array([False, False, True, True])
"""Of those: sizes that the data may find larger than stated, and no smaller. How little an error
of the model, or of a state, changes through a tow does not show how large it is; what of it is
alike all along, coefficients take up."""

SIMPLEX = 0.5
"""First steps of the search, in these std."""

SWEEPS = 1
"""Of the groups: sizes are looked for again after each step of the fit."""


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

    def joined(self, sizes: ErrorSizes) -> Joined:
        """Information of all tows on the parameters that they share."""
        return joined(self.information(sizes), self.precisions(sizes.log), self.shared)


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
        Medians of the sizes before the data speak; a size of 0 stays 0, and slow errors are no
        smaller than expected.
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
    *known_sizes, swift = expected.of_group(group)
    known = np.array(known_sizes)
    free = known > 0.0
    told = given_the_others(data, sizes, group)

    def factors(logs: FloatArray) -> FloatArray:
        full = np.zeros(len(SPREAD))
        logs = np.where(FLOORED[free], np.maximum(logs, 0.0), logs)
        full[free] = known[free] * np.exp(logs * SPREAD[free])
        return full

    def cost(logs: FloatArray) -> float:
        tried = np.append(factors(logs), swift)
        return told(tried) + 0.5 * float(logs @ logs)

    start = np.log(sizes.of_group(group)[:-1][free] / known[free]) / SPREAD[free]
    # Left to itself the simplex begins with steps of 0.00025 about 0, and ends there.
    simplex = start + SIMPLEX * np.vstack((np.zeros(len(start)), np.eye(len(start))))
    options = {'initial_simplex': simplex, 'xatol': 0.1, 'fatol': 0.05, 'maxfev': 80}
    # Imported here: it takes a node's start long, and no node fits a tow in motion.
    from scipy.optimize import minimize

    best = minimize(cost, start, method='Nelder-Mead', options=options)
    return sizes.having(group, *map(float, factors(best.x)))


def given_the_others(
    data: LinearData, sizes: ErrorSizes, group: int
) -> Callable[[FloatArray], float]:
    """Negative log-likelihood of one group's rows, up to a constant, by sizes (5,) of their errors.

    Rows of all tows are taken as the other groups predict them. So no column is needed for what is
    a tow's own: hundreds of knots are eliminated once, and not with each size that is tried.
    """
    shared = data.shared
    matrix, right = np.eye(shared), np.zeros(shared)
    tows = []
    for groups, precision in zip(data.tows, data.precisions(sizes.log), strict=True):
        parts = group_information(groups, sizes, data.times)
        others = _total([part for number, part in enumerate(parts) if number != group])
        own = others.matrix[shared:, shared:] + np.diag(precision[shared:])
        root = cholesky(own, lower=True, check_finite=False)
        rows, columns = groups[group].rows, groups[group].columns
        across = np.column_stack(
            (others.matrix[shared:, :shared], others.right[shared:], columns[:, shared:].T)
        )
        half = solve_triangular(root, across, lower=True, check_finite=False)
        known, ahead, back = half[:, :shared], half[:, shared], half[:, shared + 1 :]
        matrix += others.matrix[:shared, :shared] - known.T @ known
        right += others.right[:shared] - known.T @ ahead
        if len(columns):
            # Rows, covariances of their processes, derivatives, residual, and its covariance by
            # the tow's own parameters.
            tows.append(
                (
                    rows, rows.processes(data.times), columns[:, :shared] - back.T @ known,
                    groups[group].residual - back.T @ ahead, back.T @ back,
                )
            )  # fmt: skip
    mean = np.linalg.solve(matrix, right)

    def negative_log_likelihood(tried: FloatArray) -> float:
        total = Information(matrix, np.zeros(shared), 0.0, 0.0)
        for rows, processes, columns, residual, spread in tows:
            covariance = total_covariance(rows.noise, rows.change, processes, tried) + spread
            root = cholesky(covariance, lower=True, check_finite=False)
            total = total + Information.whitened(root, columns, residual - columns @ mean)
        rest = 0.5 * (total.square + total.log_determinant)
        # The prior is in the matrix.
        all_told = Joined(total.matrix, total.right, np.zeros(shared), rest)
        return all_told.negative_log_likelihood

    return negative_log_likelihood


def _of_log(data: LinearData, expected: ErrorSizes, sizes: ErrorSizes) -> ErrorSizes:
    tows = data.information(sizes)

    def cost(logarithm: float) -> float:
        size = expected.log * np.exp(logarithm * LOG_SPREAD)
        found = joined(tows, data.precisions(size), data.shared).negative_log_likelihood
        return found + 0.5 * logarithm**2

    # Imported here: it takes a node's start long, and no node fits a tow in motion.
    from scipy.optimize import minimize_scalar

    best = minimize_scalar(cost, bounds=(-4.0, 4.0), method='bounded', options={'xatol': 0.02})
    return replace(sizes, log=float(expected.log * np.exp(best.x * LOG_SPREAD)))
