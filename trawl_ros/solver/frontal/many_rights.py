"""Solution with the factors of fronts for many right-hand sides at once: compiled.

Right-hand sides stand side by side, (dof, m), so that each number of the factors meets all of them
while it is at hand; three pivots, which is one block of unknowns, are taken together.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.compiled import fused, inlined
from trawl_ros.solver.frontal.fronts import BORDER, FACTORS, PIVOTS, SIZE

BLOCK = 3
"""Pivots that are taken together."""


@fused
def solve_many(
    rights: FloatArray,
    order: IntArray,
    fronts: IntArray,
    border: IntArray,
    factors: FloatArray,
    exchanged: IntArray,
    solutions: FloatArray,
) -> None:
    """Solve for right-hand sides (dof, m) with the factors that `fronts.factorise` made."""
    x = np.empty_like(rights)
    for k in range(len(order)):
        x[k] = rights[order[k]]
    first = 0
    for number in range(len(fronts)):
        pivots, size, at = fronts[number, PIVOTS], fronts[number, SIZE], fronts[number, FACTORS]
        edge, begin = size - pivots, fronts[number, BORDER]
        upper = factors[at : at + pivots * size].reshape(pivots, size)
        at += pivots * size
        lower = factors[at : at + pivots * edge].reshape(pivots, edge)
        y = x[first : first + pivots]
        for k in range(pivots):
            other = exchanged[first + k]
            if other != k:
                for m in range(x.shape[1]):
                    y[k, m], y[other, m] = y[other, m], y[k, m]
        for k in range(pivots):
            whole = k - k % BLOCK
            for j in range(0, whole, BLOCK):
                _subtract_three(y[k], upper[k, j], upper[k, j + 1], upper[k, j + 2], y, j)
            for j in range(whole, k):
                share = upper[k, j]
                for m in range(x.shape[1]):
                    y[k, m] -= share * y[j, m]
        for i in range(edge):
            row = x[border[begin + i]]
            for k in range(0, pivots, BLOCK):
                _subtract_three(row, lower[k, i], lower[k + 1, i], lower[k + 2, i], y, k)
        first += pivots
    for number in range(len(fronts) - 1, -1, -1):
        pivots, size, at = fronts[number, PIVOTS], fronts[number, SIZE], fronts[number, FACTORS]
        edge, begin = size - pivots, fronts[number, BORDER]
        upper = factors[at : at + pivots * size].reshape(pivots, size)
        first -= pivots
        y = x[first : first + pivots]
        for i in range(0, edge, BLOCK):
            # Borders come in blocks too, whose rows follow one another.
            for k in range(pivots):
                a, b, c = upper[k, pivots + i], upper[k, pivots + i + 1], upper[k, pivots + i + 2]
                _subtract_three(y[k], a, b, c, x, border[begin + i])
        for k in range(pivots - 1, -1, -1):
            end = k - k % BLOCK + BLOCK
            for j in range(end, pivots, BLOCK):
                _subtract_three(y[k], upper[k, j], upper[k, j + 1], upper[k, j + 2], y, j)
            for j in range(k + 1, end):
                share = upper[k, j]
                for m in range(x.shape[1]):
                    y[k, m] -= share * y[j, m]
            for m in range(x.shape[1]):
                y[k, m] *= upper[k, k]
    for k in range(len(order)):
        solutions[order[k]] = x[k]


@inlined
def _subtract_three(
    row: FloatArray, a: float, b: float, c: float, rows: FloatArray, first: int
) -> None:
    """Subtract a combination of three rows that follow one another."""
    one, two, three = rows[first], rows[first + 1], rows[first + 2]
    for m in range(len(row)):
        row[m] -= a * one[m] + b * two[m] + c * three[m]
