# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
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
from trawl_ros.solver.linear.elimination import Elimination, elimination
from trawl_ros.solver.linear.fronts import factorise, solve, solve_many
from trawl_ros.solver.linear.search_budget import spend

MIN_DIAGONAL_PIVOT_RATIO = 0.01
"""SuperLU keeps a diagonal pivot that is at least this share of the largest of its column."""

MAX_BACKWARD_ERROR = 1e-10
"""Relative residual of the first solution above which SuperLU refactorises with its own pivots."""

ROUNDING_BACKWARD_ERROR = 1e-14
"""Relative residual that is explained by rounding; the default gear stays below 2.5e-15."""

keep_freed_memory()

MIN_RIGHTS_FOR_PANELS = 5
"""Number of right-hand sides from which panels are faster than one solution after another."""


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
        """Return the solution by the pivots of the fixed order."""
        if right.ndim > 1 and right.shape[1] >= MIN_RIGHTS_FOR_PANELS:
            side_by_side = np.empty_like(right, order='C')
            solve_many(np.ascontiguousarray(right), *self._factors, side_by_side)
            return side_by_side
        rows = np.ascontiguousarray(right.T).reshape(-1, len(right))
        solution = np.empty_like(rows)
        solve(rows, *self._factors, solution)
        found: FloatArray = solution.T.reshape(right.shape)
        return found

    def _holds(self, right: FloatArray, solution: FloatArray) -> bool:
        return self.backward_error(right, solution) <= MAX_BACKWARD_ERROR

    def backward_error(self, right: FloatArray, solution: FloatArray) -> float:
        """Return the residual of a solution (dof,) relative to matrix times solution."""
        # ‖A x - b‖ / (‖A‖ ‖x‖ + ‖b‖) in maximum norms (Rigal and Gaches 1967).
        left = float(np.abs(self.pattern.times(self.data, solution) - right).max())
        scale = self._largest * float(np.abs(solution).max()) + float(np.abs(right).max())
        return left / scale if scale > 0.0 else left

    @cached_property
    def _largest(self) -> float:
        """Return the largest entry of the matrix."""
        if self.data.dtype.kind == 'c':
            return float(np.abs(self.data).max())
        return float(max(self.data.max(), -self.data.min()))

    @property
    def fill(self) -> int:
        """Number of values stored in both factors."""
        return elimination(self.pattern).fill


def factorised(pattern: SparsityPattern, data: FloatArray) -> Factor:
    """Factorise the matrix of ``data`` on a gear's pattern.

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
    """Return space for update matrices that wait for their parents, and for two fronts."""
    return np.empty(found.waiting, kind), np.empty((2, found.largest**2), kind)


def factorised_part(matrix: sp.csc_matrix) -> SuperLU:
    """Factorise a part of such a matrix with SuperLU.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """
    return splu(
        matrix,
        permc_spec='MMD_AT_PLUS_A',
        diag_pivot_thresh=MIN_DIAGONAL_PIVOT_RATIO,
        options={'SymmetricMode': True},
    )


def solve_refined(factor: Factor, right: FloatArray) -> FloatArray:
    """Solve for (dof, k) right-hand sides to rounding, with one step of iterative refinement.

    The step is only taken where weak pivots have cost digits, which is rare.
    """
    solution = factor.solve(right)
    worst = int(np.abs(solution).max(axis=0).argmax())
    if factor.backward_error(right[:, worst], solution[:, worst]) <= ROUNDING_BACKWARD_ERROR:
        return solution
    return solution + factor.solve(right - factor.pattern.matrix(factor.data) @ solution)
