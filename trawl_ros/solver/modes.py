"""Modes of the linearised motion M ẍ + C ẋ + K x = 0, by shift and invert."""

from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.pattern import SparsityPattern
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.factor import Factor, factorised

SUBSPACE = 20
"""Vectors among which modes are sought before the search starts anew with the best of them."""


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
        restarts: int | None = None,
        subspace: int = SUBSPACE,
        factor: Factor | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Find the modes whose eigenvalues lie nearest to a shift.

        One factorisation of s² M + s C + K serves, half the size of the first-order form: with
        y = (x, ẋ), (A - s B)⁻¹ B y follows from it by substitution.

        Parameters
        ----------
        shift
            Point s, 1/s; with a real one the search is real.
        number
            Of modes to look for.
        tolerance
            Relative to their distance from the shift.
        restarts
            Of the search, after which it ends with those that are found.
        subspace
            Number of vectors among which modes are sought before the search starts anew.
        factor
            Of s² M + s C + K, where that is known.

        Returns
        -------
        values, vectors
            Eigenvalues (k,), 1/s, at most ``number``, and shapes (dof, k).
        """
        # All below takes a complex shift as it takes a real one.
        s = shift.real if shift.imag == 0.0 else cast(float, shift)
        n, times = self.pattern.dof, self.pattern.times
        if factor is None:
            data = s**2 * self.mass + s * self.damping + self.stiffness
            factor = factorised(self.pattern, data)
        solve, kind = factor.solve, factor.data.dtype

        def apply(y: FloatArray) -> FloatArray:
            x, v = y[:n], y[n:]
            # From ẋ = s x + x₀ and M ẍ + C ẋ + K x = 0 with right-hand side (x, M v).
            new = -solve(times(self.mass, s * x + v) + times(self.damping, x))
            return np.concatenate([new, s * new + x])

        operator = LinearOperator((2 * n, 2 * n), matvec=apply, dtype=kind)
        start = np.concatenate([np.ones(n), np.zeros(n)]).astype(kind)
        try:
            values, vectors = eigs(
                operator, number, v0=start, tol=tolerance, ncv=subspace, maxiter=restarts
            )
        except ArpackNoConvergence as partial:
            values, vectors = partial.eigenvalues, partial.eigenvectors
        return shift + 1.0 / values, vectors[:n]


def linearised_motion(model: GearModel, state: State, tow: Tow) -> LinearisedMotion:
    """Linearise the motion around a steady state."""
    here = linearised(model, state, tow)
    return LinearisedMotion(model.pattern, mass(model, state, tow), here.damping, here.stiffness)
