# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Marginal likelihood of values of hypotheses, all nuisances integrated out.

Readings y are normal with covariance V + A A' + X S X': V of single tows, A of what all tows share
(boards, error of the model) in std of its prior, X S X' of the values of a hypothesis. With V and
A eliminated there remain the information X' P X and the score X' P y of all values of the library,
from which each hypothesis takes its own:

log B = m's - m'Jm/2 + u'(1 + t J t)⁻¹u/2 - log|1 + t J t|/2,  u = t (s - J m)

for a normal prior of mean m and std t (Gelman et al. 2013, section 14.2).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.inference.blocks import Blocks

MIN_INFORMATION = 1e-9
"""Information below this part of what a value has without boards is none."""


@dataclass(frozen=True)
class Marginal:
    """Information and score of n values, boards and errors integrated out.

    Attributes
    ----------
    information : (n, n) array
        Per squared unit of the values.
    score : (n,) array
        Derivative of the log likelihood at the start of the values.
    log_evidence
        Log marginal likelihood with all values at their start.
    """

    information: FloatArray
    score: FloatArray
    log_evidence: float = 0.0

    def of(self, places: Sequence[int]) -> 'Marginal':
        """Return the marginal of some of the values; the others stay at their start."""
        rows = list(places)
        own = self.information[np.ix_(rows, rows)]
        return Marginal(own, self.score[rows], self.log_evidence)

    def posterior(
        self, places: Sequence[int], mean: FloatArray, std: FloatArray
    ) -> tuple[float, FloatArray, FloatArray]:
        """Return log Bayes factor, mean and covariance of some values with a normal prior."""
        own = self.of(places)
        pull = std * (own.score - own.information @ mean)
        inner = np.eye(len(std)) + std[:, None] * own.information * std
        inverse = np.linalg.inv(inner)
        factor = mean @ own.score - 0.5 * mean @ own.information @ mean
        factor += 0.5 * pull @ inverse @ pull - 0.5 * np.linalg.slogdet(inner)[1]
        return (
            float(factor),
            mean + std * (inverse @ pull),
            std[:, None] * inverse * std,
        )

    def given(self, places: Sequence[int], mean: FloatArray, std: FloatArray) -> 'Marginal':
        """Return the marginal with additional values of a normal prior, integrated out."""
        rows = list(places)
        score = self.score - self.information[:, rows] @ mean
        own = self.information[np.ix_(rows, rows)]
        inner = np.linalg.inv(np.eye(len(std)) + std[:, None] * own * std)
        gain = self.information[:, rows] @ (std[:, None] * inner * std)
        factor, _, _ = self.posterior(places, mean, std)
        return Marginal(
            self.information - gain @ self.information[rows],
            score - gain @ score[rows],
            self.log_evidence + factor,
        )

    def without(self, places: Sequence[int]) -> 'Marginal':
        """Return the marginal with some values free, without a prior; theirs is 0 then."""
        rows = list(places)
        gain = self.information[:, rows] @ self._inverse(rows)
        return Marginal(
            self.information - gain @ self.information[rows],
            self.score - gain @ self.score[rows],
            self.log_evidence,
        )

    def chi2(self, places: Sequence[int]) -> float:
        """Return the decrease of χ² with some values free."""
        score = self.score[list(places)]
        return float(score @ self._inverse(list(places)) @ score)

    def values(self, places: Sequence[int]) -> FloatArray:
        """Return the most likely values, relative to their start."""
        return self._inverse(list(places)) @ self.score[list(places)]

    def std(self, places: Sequence[int]) -> FloatArray:
        """Return std of values, each alone; infinite where they are unobservable."""
        diagonal = np.diag(self.information)[list(places)]
        with np.errstate(divide='ignore'):
            return 1.0 / np.sqrt(np.where(diagonal > MIN_INFORMATION, diagonal, 0.0))

    def covered(self, places: Sequence[int], values: FloatArray, other: Sequence[int]) -> float:
        """Return the cosine of the values' signature with the nearest of other values'."""
        rows, columns = list(places), list(other)
        size = float(values @ self.of(rows).information @ values)
        if size <= MIN_INFORMATION:
            return 0.0
        shared = self.information[np.ix_(columns, rows)] @ values
        inverse = self._inverse(columns)
        return float(np.sqrt(np.clip(shared @ inverse @ shared / size, 0.0, 1.0)))

    def _inverse(self, rows: list[int]) -> FloatArray:
        own = self.information[np.ix_(rows, rows)]
        return np.asarray(np.linalg.pinv(own, 1e-10, hermitian=True), np.float64)


def marginal(blocks: Blocks) -> Marginal:
    """Integrate out what all tows share, which has unit normal priors."""
    shared, columns, residual = blocks.shared, blocks.columns, blocks.residual
    root = np.linalg.cholesky(np.eye(shared.shape[1]) + shared.T @ shared)
    across = np.linalg.solve(root, shared.T @ np.column_stack((columns, residual)))
    of_columns, of_residual = across[:, :-1], across[:, -1]
    size = float(residual @ residual - of_residual @ of_residual)
    log_det = blocks.log_det + float(np.log(np.diag(root)).sum())
    return Marginal(
        columns.T @ columns - of_columns.T @ of_columns,
        columns.T @ residual - of_columns.T @ of_residual,
        -0.5 * size - log_det - 0.5 * len(residual) * float(np.log(2.0 * np.pi)),
    )
