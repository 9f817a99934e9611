# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Modes of the linearised motion M ẍ + C ẋ + K x = 0, by shift-invert and Arnoldi's method."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from scipy.linalg import get_blas_funcs

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.model.assembly import linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.pattern import SparsityPattern
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import Factor, factorised

MAX_VECTORS = 60
"""Largest number of Arnoldi vectors; six modes of the default gear take 24."""

FIRST_CHECK, CHECK_EVERY = 12, 4
"""Number of vectors before the first check of the eigenvalues, and between checks."""

REORTHOGONALISE_BELOW = 1e-3
"""A vector is orthogonalised again if less than this fraction of it is left."""

EXHAUSTED_BELOW = 1e-12
"""The Krylov space is complete if less than this fraction of a new vector is left."""


@dataclass(frozen=True)
class RitzPairs:
    """Ritz pairs of an operator, that is approximate eigenvalues and eigenvectors.

    Attributes
    ----------
    values : (k,) array
        Eigenvalues, the largest first.
    residuals : (k,) array
        Residuals relative to the eigenvalues.
    shares : (k, k) array
        Eigenvectors in the basis.
    basis : (k, n) array
        Orthonormal vectors of the Krylov space.
    """

    values: FloatArray
    residuals: FloatArray
    shares: FloatArray
    basis: FloatArray

    def vectors(self, chosen: BoolArray) -> FloatArray:
        """Return the eigenvectors (n, m) of chosen pairs."""
        found: FloatArray = self.basis.T @ self.shares[:, chosen]
        return found


def ritz_pairs(
    apply: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    enough: Callable[[FloatArray, FloatArray], bool],
    most: int,
) -> RitzPairs:
    """Find the largest eigenvalues of an operator by Arnoldi's method, without restarts.

    Parameters
    ----------
    apply
        Product with a vector (n,), real or complex as ``start``.
    start
        First vector (n,).
    enough
        Function of values (k,) and their relative residuals (k,); True ends the search.
    most
        Largest number of vectors.
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
        # Classical Gram-Schmidt; a second pass only after cancellation (Daniel et al. 1976).
        while last == 0.0 or EXHAUSTED_BELOW * whole < left < REORTHOGONALISE_BELOW * last:
            share = gemv(1.0, earlier, new, trans=2)
            new = gemv(-1.0, earlier, share, beta=1.0, y=new, overwrite_y=True)
            upper[:k, k - 1] += share
            last, left = left, float(np.linalg.norm(new))
        exhausted = left <= EXHAUSTED_BELOW * whole
        if exhausted or k == most or (k >= FIRST_CHECK and (k - FIRST_CHECK) % CHECK_EVERY == 0):
            values, shares = np.linalg.eig(upper[:k, :k])
            order = np.argsort(-np.abs(values))
            values, shares = values[order], shares[:, order]
            # ‖A x - λ x‖ = h(k+1, k) |y(k)| for the Ritz vector x = V y.
            residuals = left * np.abs(shares[-1]) / np.abs(values)
            if exhausted or k == most or enough(values, residuals):
                return RitzPairs(values, residuals, shares, basis[:k])
        upper[k, k - 1] = left
        basis[k] = new / left
    raise AssertionError


@dataclass(frozen=True)
class LinearisedMotion:
    """Linearised motion of a gear: M, C and K as data on its pattern."""

    pattern: SparsityPattern
    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray

    def nearest(
        self,
        shift: complex,
        number: int,
        *,
        tolerance: float,
        factor: Factor | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Find the modes whose eigenvalues lie nearest to a shift.

        Parameters
        ----------
        shift
            Point s, 1/s; with a real one the search is real.
        number
            Number of modes to look for.
        tolerance
            Error of an eigenvalue relative to its distance from the shift.
        factor
            Factors of s² M + s C + K, if they are known.

        Returns
        -------
        values, vectors
            Eigenvalues (k,), 1/s, at most ``number``, and shapes (dof, k).
        """

        def enough(values: FloatArray, residuals: FloatArray) -> bool:
            return bool(np.all(residuals[:number] <= tolerance))

        found = self.around(shift, enough, factor)
        near = (found.residuals <= tolerance) & (np.arange(len(found.values)) < number)
        return found.values[near], found.vectors(near)[: self.pattern.dof]

    def around(
        self,
        shift: complex,
        enough: Callable[[FloatArray, FloatArray], bool],
        factor: Factor | None = None,
    ) -> RitzPairs:
        """Search the eigenvalues λ nearest to a shift s, as the largest 1 / (λ - s).

        The search ends when ``enough`` accepts the eigenvalues (k,), the nearest first, and their
        errors (k,) relative to their distances from the shift. One factorisation of
        s² M + s C + K serves, half the size of the first-order form: with y = (x, ẋ),
        (A - s B)⁻¹ B y follows from it by substitution.
        """

        def back(inverted: FloatArray) -> FloatArray:
            return cast(FloatArray, shift + 1.0 / inverted)

        # A real shift keeps the whole search real, which takes half the time.
        s = shift.real if shift.imag == 0.0 else cast(float, shift)
        n, times = self.pattern.dof, self.pattern.times
        slowed = s * self.mass + self.damping
        if factor is None:
            factor = factorised(self.pattern, s * slowed + self.stiffness)
        solve = factor.solve

        def apply(y: FloatArray) -> FloatArray:
            x, v = y[:n], y[n:]
            # From ẋ = s x + x₀ and M ẍ + C ẋ + K x = 0 with right-hand side (x, M v).
            new = np.empty_like(y)
            np.negative(solve(times(self.mass, v) + times(slowed, x)), out=new[:n])
            np.multiply(s, new[:n], out=new[n:])
            new[n:] += x
            return new

        start = np.concatenate([np.ones(n), np.zeros(n)]).astype(factor.data.dtype)
        found = ritz_pairs(
            apply, start, lambda some, errors: enough(back(some), errors), MAX_VECTORS
        )
        return replace(found, values=back(found.values))


def linearised_motion(model: GearModel, state: State, tow: Tow) -> LinearisedMotion:
    """Linearise the motion around a steady state."""
    here = linearised(model, state, tow)
    return LinearisedMotion(model.pattern, mass(model, state, tow), here.damping, here.stiffness)
