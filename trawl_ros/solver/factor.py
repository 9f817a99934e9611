"""Factorisation of the gear's sparse matrices."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU, splu

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.pattern import SparsityPattern
from trawl_ros.solver.elimination import Elimination, elimination
from trawl_ros.solver.fronts import factorise, solve

PIVOT_THRESHOLD = 0.01
"""Least ratio of a diagonal pivot to the largest of its column with which SuperLU keeps it."""

BACKWARD_ERROR = 1e-10
"""Residual of the first solution, as a share of matrix times solution, from which the pivots of a
fixed order are not trusted and SuperLU chooses its own."""


@dataclass
class Factor:
    """LU factors of a matrix on a gear's pattern."""

    pattern: SparsityPattern
    data: FloatArray
    _factors: tuple[FloatArray | IntArray | NDArray[np.uint32], ...]
    _pivoted: SuperLU | None = None
    _trusted: bool = False

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for one right-hand side (dof,) or several (dof, k).

        Raises
        ------
        RuntimeError
            If the matrix is singular.
        """
        right = np.asarray(right, self.data.dtype)
        if self._pivoted is None:
            columns = np.ascontiguousarray(right.T).reshape(-1, len(right))
            solution = np.empty_like(columns)
            solve(columns, *self._factors, solution)
            if self._trusted or self._holds(columns[0], solution[0]):
                self._trusted = True
                found: FloatArray = solution.T.reshape(right.shape)
                return found
            self._pivoted = factorised_part(self.pattern.matrix(self.data))
        pivoted: FloatArray = self._pivoted.solve(right)
        return pivoted

    def _holds(self, right: FloatArray, solution: FloatArray) -> bool:
        left = np.abs(self.pattern.matrix(self.data) @ solution - right).max()
        scale = np.abs(self.data).max() * np.abs(solution).max() + np.abs(right).max()
        return bool(left <= BACKWARD_ERROR * scale)

    @property
    def fill(self) -> int:
        """Number of values stored in both factors."""
        return elimination(self.pattern).fill


def factorised(pattern: SparsityPattern, data: FloatArray) -> Factor:
    """LU factors of the matrix of ``data`` on a gear's pattern.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """
    found = elimination(pattern)
    factors, exchanged = np.empty(found.fill, data.dtype), np.empty(pattern.dof, np.int64)
    done = factorise(
        data,
        found.fronts,
        found.slots,
        found.places,
        found.parents_rows,
        factors,
        exchanged,
        *_workspace(found, data.dtype),
    )
    pivoted = None if done else factorised_part(pattern.matrix(data))
    arrays = found.order, found.fronts, found.border, factors, exchanged
    return Factor(pattern, data, arrays, pivoted)


@lru_cache(maxsize=8)
def _workspace(found: Elimination, kind: np.dtype[np.float64]) -> tuple[FloatArray, FloatArray]:
    """Borders that wait for their parents, and the fronts at work."""
    return np.empty(found.waiting, kind), np.empty((2, found.largest**2), kind)


def factorised_part(matrix: sp.csc_matrix) -> SuperLU:
    """LU factors of a part of such a matrix, by SuperLU.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """
    return splu(
        matrix,
        permc_spec='MMD_AT_PLUS_A',
        diag_pivot_thresh=PIVOT_THRESHOLD,
        options={'SymmetricMode': True},
    )


def solve_refined(pattern: SparsityPattern, data: FloatArray, right: FloatArray) -> FloatArray:
    """Solve once, to rounding: one step of refinement makes up for the weaker pivots."""
    factor = factorised(pattern, data)
    solution = factor.solve(right)
    return solution + factor.solve(right - pattern.matrix(data) @ solution)
