"""Factorisation of the gear's sparse matrices."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU, splu

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.core.memory import keep_freed_memory
from trawl_ros.model.pattern import SparsityPattern
from trawl_ros.solver.frontal.elimination import Elimination, elimination
from trawl_ros.solver.frontal.fronts import factorise, solve
from trawl_ros.solver.frontal.many_rights import solve_many
from trawl_ros.solver.linear.search_budget import spend

PIVOT_THRESHOLD = 0.01
"""Least ratio of a diagonal pivot to the largest of its column with which SuperLU keeps it."""

BACKWARD_ERROR = 1e-10
"""Residual of the first solution, as a share of matrix times solution, from which the pivots of a
fixed order are not trusted and SuperLU chooses its own."""

ROUNDING = 1e-14
"""Such a share is that of rounding: with the default gear it stays below 2.5e-15."""

keep_freed_memory()

MANY = 5
"""So many right-hand sides are solved faster side by side than one after another."""


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
            solution = self._solved(right)
            first = (part.reshape(len(right), -1)[:, 0] for part in (right, solution))
            if self._trusted or self._holds(*first):
                self._trusted = True
                return solution
            self._pivoted = factorised_part(self.pattern.matrix(self.data))
        pivoted: FloatArray = self._pivoted.solve(right)
        return pivoted

    def _solved(self, right: FloatArray) -> FloatArray:
        """Solution by the pivots of the fixed order."""
        if right.ndim > 1 and right.shape[1] >= MANY:
            side_by_side = np.empty_like(right, order='C')
            solve_many(np.ascontiguousarray(right), *self._factors, side_by_side)
            return side_by_side
        rows = np.ascontiguousarray(right.T).reshape(-1, len(right))
        solution = np.empty_like(rows)
        solve(rows, *self._factors, solution)
        found: FloatArray = solution.T.reshape(right.shape)
        return found

    def _holds(self, right: FloatArray, solution: FloatArray) -> bool:
        return self.backward_error(right, solution) <= BACKWARD_ERROR

    def backward_error(self, right: FloatArray, solution: FloatArray) -> float:
        """Residual of a solution (dof,), as a share of matrix times solution."""
        left = float(np.abs(self.pattern.times(self.data, solution) - right).max())
        scale = self._largest * float(np.abs(solution).max()) + float(np.abs(right).max())
        return left / scale if scale > 0.0 else left

    @cached_property
    def _largest(self) -> float:
        """Largest entry of the matrix."""
        if self.data.dtype.kind == 'c':
            return float(np.abs(self.data).max())
        return float(max(self.data.max(), -self.data.min()))

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
    NoSteadyState
        If the search under way has spent its budget.
    """
    found = elimination(pattern)
    spend(found.fill)
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


def solve_refined(factor: Factor, right: FloatArray) -> FloatArray:
    """Solve for (dof, k) right-hand sides to rounding.

    As a rule the factors are as good as that; where the weaker pivots have cost digits, a step of
    refinement makes up for them.
    """
    solution = factor.solve(right)
    worst = int(np.abs(solution).max(axis=0).argmax())
    if factor.backward_error(right[:, worst], solution[:, worst]) <= ROUNDING:
        return solution
    return solution + factor.solve(right - factor.pattern.matrix(factor.data) @ solution)
