"""Information of whitened stretches on the parameters, tow by tow and joined."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes, GroupRows


@dataclass(frozen=True)
class Information:
    """Information of one tow, or a part of it, on its p parameters.

    ``matrix`` (p, p) and ``right`` (p,) of the normal equations, ``square`` of the whitened
    residual, and ``log_determinant`` of the covariance of the errors.
    """

    matrix: FloatArray
    right: FloatArray
    square: float
    log_determinant: float

    def __add__(self, other: 'Information') -> 'Information':
        return Information(
            self.matrix + other.matrix,
            self.right + other.right,
            self.square + other.square,
            self.log_determinant + other.log_determinant,
        )


@dataclass(frozen=True)
class LinearGroup:
    """Rows of one group, with their derivatives (m, p) and residuals (m,) at nought."""

    rows: GroupRows
    columns: FloatArray
    residual: FloatArray

    def root(self, sizes: FloatArray, times: ErrorTimes) -> FloatArray:
        """Lower Cholesky factor (m, m) of the covariance of the errors."""
        found: FloatArray = cholesky(self.rows.covariance(sizes, times), lower=True)
        return found

    def information(self, sizes: FloatArray, times: ErrorTimes) -> Information:
        """Information on the parameters, by sizes (5,) of the errors."""
        p = self.columns.shape[1]
        if not len(self.residual):
            return Information(np.zeros((p, p)), np.zeros(p), 0.0, 0.0)
        root = self.root(sizes, times)
        both = np.column_stack((self.columns, self.residual))
        white = solve_triangular(root, both, lower=True, check_finite=False)
        square = white.T @ white
        return Information(
            square[:p, :p], square[:p, p], float(square[p, p]),
            2.0 * float(np.log(np.diag(root)).sum()),
        )  # fmt: skip


@dataclass(frozen=True)
class Joined:
    """Information of all tows on the s shared parameters, their own eliminated.

    Attributes
    ----------
    matrix, right : (s, s) and (s,) arrays
        Normal equations, without the prior.
    negative_log_likelihood
        Of the data, up to a constant, all parameters integrated out with their unit priors.
    """

    matrix: FloatArray
    right: FloatArray
    negative_log_likelihood: float


def joined(tows: Sequence[Information], precisions: Sequence[FloatArray], shared: int) -> Joined:
    """Join tows.

    Parameters
    ----------
    tows
        Information of each.
    precisions
        Prior precisions (p,) of the parameters of each.
    shared
        Number of parameters, the first, that all tows share.
    """
    matrix, right, value = np.zeros((shared, shared)), np.zeros(shared), 0.0
    for tow, precision in zip(tows, precisions, strict=True):
        own = tow.matrix[shared:, shared:] + np.diag(precision[shared:])
        root = cholesky(own, lower=True, check_finite=False)
        across = np.column_stack((tow.matrix[shared:, :shared], tow.right[shared:]))
        half = solve_triangular(root, across, lower=True, check_finite=False)
        less = half.T @ half
        matrix += tow.matrix[:shared, :shared] - less[:shared, :shared]
        right += tow.right[:shared] - less[:shared, shared]
        value += 0.5 * (tow.square - less[shared, shared] + tow.log_determinant)
        value += float(np.log(np.diag(root)).sum()) - 0.5 * float(np.log(precision[shared:]).sum())
    root = cholesky(matrix + np.eye(shared), lower=True)
    half = solve_triangular(root, right, lower=True)
    value += float(np.log(np.diag(root)).sum()) - 0.5 * float(half @ half)
    return Joined(matrix, right, value)


def own_values(tow: Information, precision: FloatArray, shared: FloatArray) -> FloatArray:
    """Most likely values of a tow's own parameters, given those (s,) that are shared."""
    s = len(shared)
    own = cholesky(tow.matrix[s:, s:] + np.diag(precision[s:]), lower=True)
    found: FloatArray = cho_solve((own, True), tow.right[s:] - tow.matrix[s:, :s] @ shared)
    return found


def group_information(
    groups: Sequence[LinearGroup], sizes: ErrorSizes, times: ErrorTimes
) -> list[Information]:
    """Information of each group of channels of a tow."""
    return [group.information(sizes.of_group(number), times) for number, group in enumerate(groups)]
