"""Arnoldi's method: largest eigenvalues of an operator from as many vectors as these need."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import get_blas_funcs

from trawl_ros.core.arrays import BoolArray, FloatArray

FIRST, MORE = 12, 4
"""Vectors before eigenvalues are looked at for the first time, and from one look to the next."""

CANCELLED = 1e-3
"""Share of a vector beside the earlier ones below which it is made orthogonal to them again."""

EXHAUSTED = 1e-12
"""Such a share of a vector that lies among the earlier ones."""


@dataclass(frozen=True)
class RitzPairs:
    """Approximate eigenvalues ``values`` (k,), the largest first, with ``residuals`` (k,) relative
    to them; ``shares`` (k, k) of the vectors ``basis`` (k, n) in their eigenvectors.
    """

    values: FloatArray
    residuals: FloatArray
    shares: FloatArray
    basis: FloatArray

    def vectors(self, chosen: BoolArray) -> FloatArray:
        """Eigenvectors (n, m) of some of them."""
        found: FloatArray = self.basis.T @ self.shares[:, chosen]
        return found


def ritz_pairs(
    apply: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    enough: Callable[[FloatArray, FloatArray], bool],
    most: int,
) -> RitzPairs:
    """Eigenvalues of an operator from products of it with vectors, none of which is thrown away.

    Parameters
    ----------
    apply
        Product with a vector (n,), real or complex as ``start``.
    start
        First vector (n,).
    enough
        True for values (k,) and their relative residuals (k,) with which the search ends.
    most
        Vectors with which it ends in any case.
    """
    basis, upper = (
        np.empty((most + 1, len(start)), start.dtype),
        np.zeros((most, most), start.dtype),
    )
    basis[0] = start / np.linalg.norm(start)
    gemv = get_blas_funcs('gemv', (basis,))
    for k in range(1, most + 1):
        new, earlier = apply(basis[k - 1]), basis[:k].T
        last, left = 0.0, float(np.linalg.norm(new))
        whole = left
        # Once is enough, unless little is left: what remains is then of the size of rounding.
        while last == 0.0 or (left < CANCELLED * last and left > EXHAUSTED * whole):
            share = gemv(1.0, earlier, new, trans=2)
            new = gemv(-1.0, earlier, share, beta=1.0, y=new, overwrite_y=True)
            upper[:k, k - 1] += share
            last, left = left, float(np.linalg.norm(new))
        exhausted = left <= EXHAUSTED * whole
        if exhausted or k == most or (k >= FIRST and (k - FIRST) % MORE == 0):
            values, shares = np.linalg.eig(upper[:k, :k])
            order = np.argsort(-np.abs(values))
            values, shares = values[order], shares[:, order]
            residuals = left * np.abs(shares[-1]) / np.abs(values)
            if exhausted or k == most or enough(values, residuals):
                return RitzPairs(values, residuals, shares, basis[:k])
        upper[k, k - 1] = left
        basis[k] = new / left
    raise AssertionError
