"""Score tests of effects with the coefficients eliminated: information, score and χ² of each.

Errors, calibration and coefficients are eliminated together (`eliminate_nuisance`): a triangle T
and a right side z for the values of effects: T'T is their information and T'z their score. The
evidence for each is a χ², and so are rivalry and what a trial could have shown.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import chdtrc, ndtri

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import GROUP_OF, TowErrors, in_all_channels
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.nuisance import eliminate_nuisance, triangular

BLIND = 1e-9
"""Information below this part of what an effect has without coefficients is none."""

POWER = 0.84
"""Normal quantile of 80 %: what is said to be detectable is found in so many trials."""

DRAWS = 4000


@dataclass(frozen=True)
class Evidence:
    """Information and score of n values, for tests to first order.

    Attributes
    ----------
    information : (n, n) array
        Per squared std, with coefficients and errors eliminated.
    score : (n,) array
        Its product with the values most likely, had each no rival.
    root : (r, n) array
        T; the score of data without any effect is its transpose times standard normal numbers.
    inverses, ranks
        Of blocks of the information as they were asked for; other draws of the noise share them.
    """

    information: FloatArray
    score: FloatArray
    root: FloatArray
    inverses: dict[tuple[int, ...], FloatArray] = field(
        default_factory=dict, repr=False, compare=False
    )
    ranks: dict[tuple[int, ...], int] = field(default_factory=dict, repr=False, compare=False)

    def chi2(self, block: Sequence[int]) -> float:
        """Score statistic: decrease of the χ² of all data with these values free."""
        if len(block) == 1:
            # Asked for thousands of times.
            own = self.information[block[0], block[0]]
            return float(self.score[block[0]] ** 2 / own) if own else 0.0
        return float(self.score[list(block)] @ self.values(block))

    def degrees_of_freedom(self, block: Sequence[int]) -> int:
        """Degrees of freedom: rank of the information on these values."""
        if len(block) == 1:
            return int(abs(self.information[block[0], block[0]]) > BLIND)
        if (key := tuple(block)) not in self.ranks:
            self.ranks[key] = int(np.linalg.matrix_rank(self._of(block), BLIND, hermitian=True))
        return self.ranks[key]

    def strength(self, block: Sequence[int], doubt: float = 1.0) -> float:
        """-log₁₀ of the probability of as large a χ² where these values are not there.

        With all errors ``doubt`` times as large as they are taken to be.
        """
        freedom = self.degrees_of_freedom(block)
        return tail(self.chi2(block) / doubt**2, freedom) if freedom else 0.0

    def values(self, block: Sequence[int]) -> FloatArray:
        """Most likely values, relative to their linearisation point, in units of the columns."""
        return self._inverse(block) @ self.score[list(block)]

    def std(self, block: Sequence[int]) -> FloatArray:
        """Standard deviations of values, each alone; infinite where they are unobservable."""
        diagonal = np.diag(self._of(block))
        with np.errstate(divide='ignore'):
            return 1.0 / np.sqrt(np.where(diagonal > BLIND, diagonal, 0.0))

    def covered(self, block: Sequence[int], values: FloatArray, other: Sequence[int]) -> float:
        """Cosine of the values' signature with the nearest of other values' signatures."""
        rows, columns = list(block), list(other)
        size = float(values @ self._of(block) @ values)
        if size <= BLIND:
            return 0.0
        shared = self.information[np.ix_(columns, rows)] @ values
        inverse = self._inverse(other)
        return float(np.sqrt(np.clip(shared @ inverse @ shared / size, 0.0, 1.0)))

    def without(self, block: Sequence[int]) -> 'Evidence':
        """Conditional evidence with some values free in any case; theirs is 0 then."""
        rows = list(block)
        inverse = self._inverse(block)
        gain = self.information[:, rows] @ inverse
        taken = self.root[:, rows] @ inverse @ self.root[:, rows].T
        return Evidence(
            self.information - gain @ self.information[rows],
            self.score - gain @ self.score[rows],
            self.root - taken @ self.root,
        )

    def with_noise(self, rng: np.random.Generator) -> 'Evidence':
        """Evidence of the same data with as much noise again, drawn by chance."""
        drawn = rng.standard_normal(len(self.root)) @ self.root
        return replace(self, score=self.score + drawn)

    def _inverse(self, block: Sequence[int]) -> FloatArray:
        """Pseudo-inverse of the information on these values."""
        if (key := tuple(block)) not in self.inverses:
            inverse = np.linalg.pinv(self._of(block), 1e-10, hermitian=True)
            self.inverses[key] = np.asarray(inverse, np.float64)
        return self.inverses[key]

    def _of(self, block: Sequence[int]) -> FloatArray:
        return self.information[np.ix_(list(block), list(block))]


def evidence(
    fit: Fit,
    columns: Sequence[FloatArray],
    units: FloatArray,
    *,
    tows: Sequence[TowErrors] | None = None,
    weights: Sequence[FloatArray] | None = None,
) -> Evidence:
    """Compute information and score of effects' values around a fit of the boards.

    Parameters
    ----------
    fit
        Source of the noise; its windows may have more than the twelve columns of the boards.
    columns
        For each window (channels of the window, n): what a unit of each value changes.
    units
        Sizes (n,) in which values are counted.
    tows
        Errors of those tows that count, one of them perhaps several times; all of them if None.
    weights
        Huber weights of each of these tows; found if None.
    """
    boards = fit.prior.slice_of('coefficients')
    number, board = len(units), boards.stop
    jacobian = np.zeros((*fit.residual.shape, board + number))
    jacobian[:, :, boards] = fit.jacobian[:, :, boards]
    for row, (linear, own) in enumerate(zip(fit.windows, columns, strict=True)):
        jacobian[row, :, board:] = in_all_channels(linear, own * units)
    scales = np.array(fit.scales)[GROUP_OF]
    information = eliminate_nuisance(
        fit.errors if tows is None else tows,
        scales,
        fit.residual,
        jacobian,
        fit.options.huber,
        weights,
    )
    root = np.sqrt(fit.options.prior_weight)
    away = -fit.prior.departure(fit.coefficients)[boards]
    known = np.zeros((board, board + number + 1))
    known[:, :board] = root * np.eye(board)
    known[:, -1] = root * away
    rows = np.vstack((known, np.column_stack((information.triangle, information.right))))
    rest = triangular(rows)[board:]
    left, right = rest[:, board:-1], rest[:, -1]
    return Evidence(left.T @ left, left.T @ right, left)


def tail(value: float, freedom: int) -> float:
    """-log₁₀ of the probability that χ² of so many degrees of freedom exceeds a value."""
    return float(_tails(np.array(value), freedom))


def _tails(values: FloatArray, freedom: int) -> FloatArray:
    # Beyond the smallest number it is infinite.
    with np.errstate(divide='ignore'):
        tails: FloatArray = -np.log(chdtrc(freedom, values)) / np.log(10.0)
    return tails


def threshold(
    of_effects: Evidence, blocks: Sequence[Sequence[int]], false_alarms: float, seed: int = 0
) -> float:
    """Critical value of the largest `tail` of all blocks, for a rate of false alarms."""
    draws = (
        np.random.default_rng(seed).standard_normal((DRAWS, len(of_effects.root))) @ of_effects.root
    )
    largest = np.zeros(DRAWS)
    for block in blocks:
        own = of_effects.information[np.ix_(list(block), list(block))]
        inverse = np.linalg.pinv(own, 1e-10, hermitian=True)
        freedom = of_effects.degrees_of_freedom(block)
        if freedom == 0:
            continue
        chosen = draws[:, list(block)]
        sizes = np.einsum('ni,ij,nj->n', chosen, inverse, chosen)
        largest = np.maximum(largest, _tails(sizes, freedom))
    return float(np.quantile(largest, 1.0 - false_alarms))


def detectable(
    of_effects: Evidence, block: Sequence[int], limit: float, doubt: float = 1.0
) -> FloatArray:
    """Detectable sizes of values, each alone, that exceed a `threshold` in 80 % of trials."""
    sigmas = doubt * float(-ndtri(0.5 * 10.0**-limit)) + POWER
    return sigmas * of_effects.std(block)
