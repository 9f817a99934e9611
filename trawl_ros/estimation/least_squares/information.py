# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Information of blocks of data on their parameters: joined, the blocks' own ones eliminated."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular

from trawl_ros.core.arrays import FloatArray

LEAST_PRECISION = 1e-12
"""Precision of a parameter of which neither data nor prior know anything."""


@dataclass(frozen=True)
class Information:
    """Information of a block of data on its p parameters, the first of which all blocks share.

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

    @classmethod
    def none(cls, number: int) -> 'Information':
        """Information of no data on a number of parameters."""
        return cls(np.zeros((number, number)), np.zeros(number), 0.0, 0.0)

    @classmethod
    def whitened(cls, root: FloatArray, columns: FloatArray, residual: FloatArray) -> 'Information':
        """Information of rows whose errors have a covariance.

        Parameters
        ----------
        root : (m, m) array
            Lower Cholesky factor of the covariance.
        columns : (m, p) array
            Derivatives by the parameters.
        residual : (m,) array
            Residuals of parameters that are all zero.
        """
        p = columns.shape[1]
        both = np.column_stack((columns, residual))
        white = solve_triangular(root, both, lower=True, check_finite=False)
        square = white.T @ white
        return cls(
            square[:p, :p], square[:p, p], float(square[p, p]),
            2.0 * float(np.log(np.diag(root)).sum()),
        )  # fmt: skip

    def damped(self, precision: FloatArray, at: FloatArray, damping: float) -> 'Information':
        """Return this with information of staying at a place (p,): a part of the prior's.

        By the prior's precision, not by the data's: by these a step along what several parameters
        share all but ends, because each of them alone seems well known.
        """
        # A parameter without a prior stays by its unit.
        stays = damping * np.where(precision > 0.0, precision, 1.0)
        return self + Information(np.diag(stays), stays * at, 0.0, 0.0)

    def about(self, place: FloatArray) -> 'Information':
        """Return this with residuals of parameters 0, where they were those at a place (p,)."""
        change = self.matrix @ place
        square = self.square + float(place @ (2.0 * self.right + change))
        return Information(self.matrix, self.right + change, square, self.log_determinant)

    def squared_misfit(self, at: FloatArray) -> float:
        """Square of the whitened residual at parameters (p,)."""
        return self.square + float(at @ (self.matrix @ at - 2.0 * self.right))


@dataclass(frozen=True)
class Joined:
    """Information of all blocks on the s shared parameters, their own eliminated.

    Attributes
    ----------
    matrix, right : (s, s) and (s,) arrays
        Normal equations, without the prior.
    precision : (s,) array
        Of the prior.
    rest
        Negative log-likelihood of the data at shared parameters of 0, up to a constant.
    """

    matrix: FloatArray
    right: FloatArray
    precision: FloatArray
    rest: float

    @property
    def posterior(self) -> FloatArray:
        """Information (s, s) with the prior."""
        return self.matrix + np.diag(self.precision)

    @cached_property
    def covariance(self) -> FloatArray:
        """Posterior covariance (s, s); std of a million prior units where nothing is known."""
        known = self.matrix + np.diag(np.maximum(self.precision, LEAST_PRECISION))
        values, vectors = np.linalg.eigh(known)
        found: FloatArray = (vectors / np.maximum(values, LEAST_PRECISION)) @ vectors.T
        return found

    @property
    def negative_log_likelihood(self) -> float:
        """Of the data, up to a constant, all parameters integrated out with their priors."""
        root = cholesky(self.posterior, lower=True)
        half = solve_triangular(root, self.right, lower=True)
        return self.rest + float(np.log(np.diag(root)).sum()) - 0.5 * float(half @ half)


def joined(blocks: Sequence[Information], precisions: Sequence[FloatArray], shared: int) -> Joined:
    """Join blocks.

    Parameters
    ----------
    blocks
        Information of each.
    precisions
        Prior precisions (p,) of the parameters of each; of the shared ones those of the first.
    shared
        Number of parameters, the first, that all blocks share.
    """
    matrix, right, value = np.zeros((shared, shared)), np.zeros(shared), 0.0
    for block, precision in zip(blocks, precisions, strict=True):
        own = block.matrix[shared:, shared:] + np.diag(precision[shared:])
        root = cholesky(own, lower=True, check_finite=False)
        across = np.column_stack((block.matrix[shared:, :shared], block.right[shared:]))
        half = solve_triangular(root, across, lower=True, check_finite=False)
        less = half.T @ half
        matrix += block.matrix[:shared, :shared] - less[:shared, :shared]
        right += block.right[:shared] - less[:shared, shared]
        value += 0.5 * (block.square - less[shared, shared] + block.log_determinant)
        value += float(np.log(np.diag(root)).sum()) - 0.5 * float(np.log(precision[shared:]).sum())
    precision = precisions[0][:shared] if len(precisions) else np.ones(shared)
    return Joined(matrix, right, precision, value)


def own_values(block: Information, precision: FloatArray, shared: FloatArray) -> FloatArray:
    """Most likely values of a block's own parameters, given those (s,) that are shared."""
    s = len(shared)
    own = cholesky(block.matrix[s:, s:] + np.diag(precision[s:]), lower=True)
    found: FloatArray = cho_solve((own, True), block.right[s:] - block.matrix[s:, :s] @ shared)
    return found


def extended_root(matrix: FloatArray, precision: FloatArray, root: FloatArray) -> FloatArray:
    """Root (p, p) of the posterior covariance of all parameters, from that of the first.

    Parameters
    ----------
    matrix : (p, p) array
        Information of the data.
    precision : (p,) array
        Of the prior.
    root : (f, f) array
        Root S of the covariance S Sᵀ of the first f parameters.
    """
    f = len(root)
    own = cholesky(matrix[f:, f:] + np.diag(precision[f:]), lower=True)
    inverse = solve_triangular(own, np.eye(len(own)), lower=True).T
    follows = -inverse @ (inverse.T @ matrix[f:, :f]) @ root
    return np.block([[root, np.zeros((f, len(own)))], [follows, inverse]])
