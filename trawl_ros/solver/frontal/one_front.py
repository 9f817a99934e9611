"""Solution of a small dense system: a matrix that is one front."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.solver.frontal.fronts import factorise, solve


def dense_solution(matrix: FloatArray, right: FloatArray) -> FloatArray | None:
    """Solution (k,) of a dense system (k, k); None where the matrix is singular.

    Unlike a library's, it runs in one thread: others would only wait for each other.
    """
    size = len(right)
    every, nothing = np.arange(size * size, dtype=np.uint32), np.empty(0, np.uint32)
    fronts = np.array([[size, size, 0, size * size, 0, 0, 0]])
    factors, exchanged = np.empty(size * size), np.empty(size, np.int64)
    space = np.empty(0), np.empty((2, size * size))
    if not factorise(matrix.ravel(), fronts, every, every, nothing, factors, exchanged, *space):
        return None
    solution = np.empty((1, size))
    solve(right.reshape(1, -1), np.arange(size), fronts, nothing, factors, exchanged, solution)
    found: FloatArray = solution[0]
    return found
