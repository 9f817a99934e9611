# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Chain of stretches: innovations of each, given all before, by a Cholesky factor that grows.

The rows y of a tow have a joint normal distribution of covariance S = L Lᵀ. The innovations L⁻¹ y
of a stretch are its residuals less what the stretches before predict, white and of unit size.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from trawl_ros.core.arrays import FloatArray, Slice

MAX_INNOVATION = 4.0
"""Largest innovation, in its std: one reading alone is no onset."""

RELATIVE_JITTER = 1e-9
"""Part of its variance that is added to each row, against rounding."""


LEAST_LEFT = 1e-9
"""Least part of its variance that is left of a parameter, against rounding."""


@dataclass(frozen=True)
class Belief:
    """Normal distribution of the parameters that last: mean (q,), and root (q, q) of covariance."""

    mean: FloatArray
    root: FloatArray


@dataclass(frozen=True)
class Link:
    """Stretch of a chain.

    Attributes
    ----------
    place
        Rows of the stretch in the chain.
    back : (r, n) array
        Rows of the factor L for the n rows before.
    root : (r, r) array
        Rows of L for the stretch itself, by Huber's weights: wider for readings far off.
    white : (r,) array
        Rows of L⁻¹ y.
    weights : (r,) array
        Weights by which no innovation exceeds `MAX_INNOVATION`.
    """

    place: Slice
    back: FloatArray
    root: FloatArray
    white: FloatArray
    weights: FloatArray

    @property
    def innovations(self) -> FloatArray:
        """Innovations (r,), none beyond `MAX_INNOVATION`."""
        return self.weights * self.white

    def whitened(self, rows: FloatArray) -> FloatArray:
        """Return rows (r, ...) in units of their errors."""
        flat = rows.reshape(len(rows), math.prod(rows.shape[1:]))
        white = solve_triangular(self.root, flat, lower=True, check_finite=False)
        return np.asarray(white.reshape(rows.shape), np.float64)


class Chain:
    """Chain of stretches with lasting parameters, by which all its rows are correlated.

    Parameters
    ----------
    before
        Distribution of the lasting parameters before the first stretch.

    Attributes
    ----------
    white : (n,) array
        All rows of L⁻¹ y.
    """

    def __init__(self, before: Belief) -> None:
        self._before, size = before, len(before.mean)
        self._root, self._columns = np.zeros((0, 0)), np.zeros((0, size))
        self.white = np.zeros(0)

    def append(self, covariance: FloatArray, columns: FloatArray, residual: FloatArray) -> Link:
        """Append a stretch.

        Parameters
        ----------
        covariance : (r, n + r) array
            Covariance with all rows before, and of its own.
        columns : (r, q) array
            Derivatives by the belief's parameters, each in units of its root.
        residual : (r,) array
            Residuals at the mean of the belief.
        """
        n, r = len(self.white), len(residual)
        back = solve_triangular(self._root, covariance[:, :n].T, lower=True, check_finite=False).T
        own = covariance[:, n:] - back @ back.T
        own += RELATIVE_JITTER * np.diag(np.diag(covariance[:, n:]))
        root = cholesky(own, lower=True)
        away = solve_triangular(root, residual - back @ self.white, lower=True)
        # A reading far off moves the belief as one at the edge does: its variance counts as far
        # times as large (Huber). As evidence it counts as the edge too.
        far = np.sqrt(np.maximum(np.abs(away) / MAX_INNOVATION, 1.0))
        link = Link(slice(n, n + r), back, root * far, away / far, 1.0 / far)
        self._columns = np.vstack((self._columns, link.whitened(columns - back @ self._columns)))
        self._root = np.block([[self._root, np.zeros((n, r))], [back, link.root]])
        self.white = np.append(self.white, link.white)
        return link

    def belief(self, rows: int | None = None) -> Belief:
        """Return the belief after the first rows, or after all."""
        columns, before = self._columns[:rows], self._before
        # Posterior in units of the root: mean Cᵀ w and covariance 1 - Cᵀ C, whitened columns C.
        left = np.eye(len(before.mean)) - columns.T @ columns
        mean = before.mean + before.root @ (columns.T @ self.white[:rows])
        variances, axes = np.linalg.eigh(left)
        return Belief(mean, before.root @ (axes * np.sqrt(np.maximum(variances, LEAST_LEFT))))
