# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Normal equations of blocks of data that share some parameters and have others of their own.

A block of whitened rows with residual r and Jacobian J is kept as A = Jᵀ J, b = Jᵀ r and rᵀ r. Its
misfit at parameters z is |r - J z|² = rᵀ r - 2 bᵀ z + zᵀ A z. The first s parameters are shared by
all blocks. A block's own parameters o are eliminated with their prior precisions P (Schur
complement), which gives the normal equations of the shared ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular

from trawl_ros.core.arrays import FloatArray

LEAST_PRECISION = 1e-12
"""Smallest precision (1 / prior unit²); it stands in for 0 where data and prior say nothing."""


@dataclass(frozen=True)
class Information:
    """Information of a block of data on its p parameters, the shared ones first.

    Attributes
    ----------
    matrix : (p, p) array
        Matrix A of the normal equations, in prior units of the parameters.
    right : (p,) array
        Right-hand side b of the normal equations.
    square
        Squared norm rᵀ r of the whitened residual at parameters of 0.
    log_determinant
        Logarithm of the determinant of the errors' covariance.
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
        """Return the information of no data on so many parameters: all zero."""
        return cls(np.zeros((number, number)), np.zeros(number), 0.0, 0.0)

    @classmethod
    def whitened(cls, root: FloatArray, columns: FloatArray, residual: FloatArray) -> 'Information':
        """Return the information of rows with correlated errors.

        Parameters
        ----------
        root : (m, m) array
            Lower Cholesky factor of the covariance.
        columns : (m, p) array
            Jacobian of the predictions.
        residual : (m,) array
            Measured minus predicted at parameters of 0.
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
        """Return this with Levenberg-Marquardt damping towards a point.

        The damping is scaled by the prior precisions and not, as usual, by the diagonal of A. That
        diagonal is large for each of several correlated parameters. It would block steps along
        the direction in which they compensate each other.

        Parameters
        ----------
        precision : (p,) array
            Prior precisions.
        at : (p,) array
            Point.
        damping
            Factor on the precisions.
        """
        # A parameter without a prior is damped in its own unit.
        added = damping * np.where(precision > 0.0, precision, 1.0)
        return self + Information(np.diag(added), added * at, 0.0, 0.0)

    def about(self, place: FloatArray) -> 'Information':
        """Return this with the residual r + J z at 0, if it now has the residual r at z (p,)."""
        change = self.matrix @ place
        square = self.square + float(place @ (2.0 * self.right + change))
        return Information(self.matrix, self.right + change, square, self.log_determinant)

    def squared_misfit(self, at: FloatArray) -> float:
        """Return the squared norm of the whitened residual at parameters (p,)."""
        return self.square + float(at @ (self.matrix @ at - 2.0 * self.right))


@dataclass(frozen=True)
class Joined:
    """Information of all blocks on the s shared parameters, with the blocks' own eliminated.

    Attributes
    ----------
    matrix, right : (s, s) and (s,) arrays
        Normal equations, without the prior.
    precision : (s,) array
        Prior precisions of the shared parameters.
    rest
        Negative log-likelihood (nats) of the data at shared parameters of 0, up to a constant.
    """

    matrix: FloatArray
    right: FloatArray
    precision: FloatArray
    rest: float

    @property
    def posterior(self) -> FloatArray:
        """Posterior information (s, s): that of the data plus that of the prior."""
        return self.matrix + np.diag(self.precision)

    @cached_property
    def covariance(self) -> FloatArray:
        """Posterior covariance (s, s); the std is limited to 10⁶ prior units."""
        known = self.matrix + np.diag(np.maximum(self.precision, LEAST_PRECISION))
        values, vectors = np.linalg.eigh(known)
        found: FloatArray = (vectors / np.maximum(values, LEAST_PRECISION)) @ vectors.T
        return found

    @property
    def negative_log_likelihood(self) -> float:
        """Negative log evidence (nats) of the data, with all parameters integrated out.

        It is ``rest`` + ½ log |A + P| - ½ bᵀ (A + P)⁻¹ b. The term - ½ log |P| of the shared
        parameters is left out as a constant.
        """
        root = cholesky(self.posterior, lower=True)
        half = solve_triangular(root, self.right, lower=True)
        return self.rest + float(np.log(np.diag(root)).sum()) - 0.5 * float(half @ half)


def joined(blocks: Sequence[Information], precisions: Sequence[FloatArray], shared: int) -> Joined:
    """Eliminate the own parameters of each block, and add up the information on the shared ones.

    Parameters
    ----------
    blocks
        Information of each block.
    precisions
        Prior precisions (p,) of each block's parameters. Those of the shared parameters are taken
        from the first block.
    shared
        Number s of shared parameters.
    """
    matrix, right, value = np.zeros((shared, shared)), np.zeros(shared), 0.0
    for block, precision in zip(blocks, precisions, strict=True):
        # C = A_oo + P_o = L Lᵀ; ``less`` holds [A_so; b_oᵀ] C⁻¹ [A_os b_o].
        own = block.matrix[shared:, shared:] + np.diag(precision[shared:])
        root = cholesky(own, lower=True, check_finite=False)
        across = np.column_stack((block.matrix[shared:, :shared], block.right[shared:]))
        half = solve_triangular(root, across, lower=True, check_finite=False)
        less = half.T @ half
        matrix += block.matrix[:shared, :shared] - less[:shared, :shared]
        right += block.right[:shared] - less[:shared, shared]
        # -log p(data | z_s = 0) = ½ (rᵀ r - b_oᵀ C⁻¹ b_o + log |V| + log |C| - log |P_o|), where V
        # is the covariance of the errors.
        value += 0.5 * (block.square - less[shared, shared] + block.log_determinant)
        value += float(np.log(np.diag(root)).sum()) - 0.5 * float(np.log(precision[shared:]).sum())
    precision = precisions[0][:shared] if len(precisions) else np.ones(shared)
    return Joined(matrix, right, precision, value)


def own_values(block: Information, precision: FloatArray, shared: FloatArray) -> FloatArray:
    """Return the most likely own parameters z_o of a block, given the shared ones z_s (s,).

    They solve (A_oo + P_o) z_o = b_o - A_os z_s.
    """
    s = len(shared)
    own = cholesky(block.matrix[s:, s:] + np.diag(precision[s:]), lower=True)
    found: FloatArray = cho_solve((own, True), block.right[s:] - block.matrix[s:, :s] @ shared)
    return found


def extended_root(matrix: FloatArray, precision: FloatArray, root: FloatArray) -> FloatArray:
    """Extend a root of the covariance of the first f parameters to all p parameters.

    The other parameters follow the first by z_o = -C⁻¹ A_of z_f and scatter about that with
    covariance C⁻¹, where C = A_oo + P_o. So the root of the joint posterior covariance is
    [[S, 0], [-C⁻¹ A_of S, C⁻¹ᐟ²]].

    Parameters
    ----------
    matrix : (p, p) array
        Information of the data on all parameters.
    precision : (p,) array
        Prior precisions.
    root : (f, f) array
        Root S of the covariance S Sᵀ of the first f parameters.

    Returns
    -------
    (p, p) array
        Root of the posterior covariance of all parameters.
    """
    f = len(root)
    own = cholesky(matrix[f:, f:] + np.diag(precision[f:]), lower=True)
    # L⁻ᵀ of C = L Lᵀ, so that L⁻ᵀ L⁻¹ = C⁻¹.
    inverse = solve_triangular(own, np.eye(len(own)), lower=True).T
    follows = -inverse @ (inverse.T @ matrix[f:, :f]) @ root
    return np.block([[root, np.zeros((f, len(own)))], [follows, inverse]])
