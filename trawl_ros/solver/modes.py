"""Modes of the linearised motion M ẍ + C ẋ + K x = 0, by shift and invert."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.pattern import SparsityPattern
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.arnoldi import RitzPairs, ritz_pairs
from trawl_ros.solver.linear.factor import Factor, factorised

MOST = 60
"""Vectors among which modes are sought: with the default gear, six take 24 of them."""


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
            Of modes to look for.
        tolerance
            Relative to their distance from the shift.
        factor
            Of s² M + s C + K, where that is known.

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
        """Search the eigenvalues λ around a shift s, as 1 / (λ - s), until those found (k,), the
        nearest first, and their errors (k,) relative to their distances from it are enough.

        One factorisation of s² M + s C + K serves, half the size of the first-order form: with
        y = (x, ẋ), (A - s B)⁻¹ B y follows from it by substitution.
        """

        def back(inverted: FloatArray) -> FloatArray:
            return cast(FloatArray, shift + 1.0 / inverted)

        # All below takes a complex shift as it takes a real one.
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
        found = ritz_pairs(apply, start, lambda some, errors: enough(back(some), errors), MOST)
        return replace(found, values=back(found.values))


def linearised_motion(model: GearModel, state: State, tow: Tow) -> LinearisedMotion:
    """Linearise the motion around a steady state."""
    here = linearised(model, state, tow)
    return LinearisedMotion(model.pattern, mass(model, state, tow), here.damping, here.stiffness)
