"""Stability of a steady state by the eigenvalues of its linearised motion."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from trawl_ros.model.assembly import linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.factor import factorised

SHIFTS = (2.0 + 0.0j, 0.02 + 0.0j, 0.3 + 1.0j, 1.0 + 3.0j, 1.0 + 8.0j, 0.5 + 15.0j)
"""Points (1/s) around which eigenvalues are sought: a board that falls over in a second, slow
drifts of the whole gear, and the swings of boards on their ropes."""

PER_SHIFT = 6

Solve = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Stability:
    """The eigenvalues (1/s) nearest to instability; ``growth`` is the largest real part."""

    eigenvalues: np.ndarray

    @property
    def growth(self) -> float:
        """Rate of growth (1/s) of the least stable motion; negative when all die out."""
        return float(self.eigenvalues.real.max())

    @property
    def stable(self) -> bool:
        """True if every motion found dies out."""
        return self.growth < 0.0

    @property
    def settling_time(self) -> float:
        """Time (s) in which the slowest motion falls to 1/e."""
        return -1.0 / self.growth if self.stable else float('inf')


def stability(model: GearModel, state: State, tow: Tow) -> Stability:
    """Eigenvalues of M ẍ + C ẋ + K x = 0 near the imaginary axis, by shift and invert.

    Each shift takes one factorisation of s² M + s C + K, half the size of the first-order
    form: with y = (x, ẋ), (A - s B)⁻¹ B y follows from it by substitution.
    """
    here = linearised(model, state, tow)
    inertia = mass(model, state, tow)
    matrix = model.pattern.matrix
    m, c = matrix(inertia), matrix(here.damping)
    n = model.dof
    found = []
    for shift in SHIFTS:
        data = shift**2 * inertia + shift * here.damping + here.stiffness
        solve = factorised(model.pattern, data).solve

        def apply(y: np.ndarray, s: complex = shift, solve: Solve = solve) -> np.ndarray:
            x, v = y[:n], y[n:]
            # From ẋ = s x + x₀ and M ẍ + C ẋ + K x = 0 with right-hand side (x, M v).
            new = -solve(m @ (s * x + v) + c @ x)
            return np.concatenate([new, s * new + x])

        operator = LinearOperator((2 * n, 2 * n), matvec=apply, dtype=complex)
        start = np.concatenate([np.ones(n), np.zeros(n)]).astype(complex)
        try:
            values = eigs(
                operator, PER_SHIFT, which='LM', v0=start, tol=1e-5, return_eigenvectors=False
            )
        except ArpackNoConvergence as partial:
            values = partial.eigenvalues
        found.extend(shift + 1.0 / values)
    return Stability(np.array(found))
