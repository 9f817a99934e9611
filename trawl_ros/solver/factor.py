"""Factorisation of the gear's sparse matrices."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from trawl_ros.model.pattern import SparsityPattern

PIVOT_THRESHOLD = 0.01
"""Least ratio of a diagonal pivot to the largest of its column with which it is kept. The
matrices are symmetric in pattern and strong on their diagonal; keeping the order of minimum
degree cuts the time to a fifth on a net of two thousand unknowns."""


@dataclass(frozen=True)
class Factor:
    """LU factors of a matrix whose rows and columns were permuted first."""

    lu: SuperLU
    order: np.ndarray
    kind: np.dtype

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solve for one right-hand side (dof,) or several (dof, k)."""
        solution = np.empty(right.shape, self.kind)
        solution[self.order] = self.lu.solve(right[self.order].astype(self.kind, copy=False))
        return solution

    @property
    def fill(self) -> int:
        """Number of non-zeros stored in both factors."""
        return int(self.lu.nnz)


@dataclass(frozen=True)
class _Elimination:
    """Fill-reducing ordering of a pattern's unknowns, and the pattern in this order."""

    order: np.ndarray
    slots: np.ndarray
    indices: np.ndarray
    indptr: np.ndarray


@lru_cache(maxsize=16)
def _elimination(pattern: SparsityPattern) -> _Elimination:
    """Minimum-degree ordering; it depends on the pattern alone, so it is found once for a gear."""
    columns = np.repeat(np.arange(pattern.dof), np.diff(pattern.indptr))
    diagonal = pattern.indices == columns
    dominant = pattern.matrix(np.where(diagonal, 1.0, 1e-3 / pattern.dof))
    order = np.argsort(_ordered(dominant, 'MMD_AT_PLUS_A').perm_c)
    numbers = pattern.matrix(np.arange(1.0, len(pattern.indices) + 1))
    moved = numbers[order][:, order].tocsc()
    moved.sort_indices()
    return _Elimination(order, moved.data.astype(int) - 1, moved.indices, moved.indptr)


def _ordered(matrix: sp.csc_matrix, ordering: str) -> SuperLU:
    # Panels of one column: the supernodes of a net are too narrow for wider ones to pay.
    return splu(
        matrix,
        permc_spec=ordering,
        diag_pivot_thresh=PIVOT_THRESHOLD,
        relax=1,
        panel_size=1,
        options={'SymmetricMode': True},
    )


def factorised(pattern: SparsityPattern, data: np.ndarray) -> Factor:
    """LU factors of the matrix of ``data`` on a gear's pattern.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """
    found = _elimination(pattern)
    matrix = sp.csc_matrix(
        (data[found.slots], found.indices, found.indptr), shape=(pattern.dof, pattern.dof)
    )
    return Factor(_ordered(matrix, 'NATURAL'), found.order, data.dtype)


def factorised_part(matrix: sp.csc_matrix) -> SuperLU:
    """LU factors of a part of such a matrix.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """
    return _ordered(matrix, 'MMD_AT_PLUS_A')


def solve_refined(pattern: SparsityPattern, data: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve once, to rounding: one step of refinement makes up for the weaker pivots."""
    factor = factorised(pattern, data)
    solution = factor.solve(right)
    return solution + factor.solve(right - pattern.matrix(data) @ solution)
