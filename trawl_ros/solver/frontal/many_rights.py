"""Solution with the factors of fronts for many right-hand sides at once: compiled.

Right-hand sides stand side by side in panels of a fixed width, so that each number of the factors
meets all of a panel while it is at hand. Blocks of three unknowns, whose rows follow one another,
are taken together: nine numbers of the factors for three rows and three others. As the width is
known to the compiler, rows of a block lie at known distances, and it can tell that two blocks do
not overlap.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.compiled import fused, inlined
from trawl_ros.solver.frontal.fronts import BORDER, FACTORS, PIVOTS, SIZE

WIDTH = 24
"""Right-hand sides of a panel."""


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
    panel = np.empty(WIDTH * len(order), rights.dtype)
    for begin in range(0, rights.shape[1], WIDTH):
        wide = min(WIDTH, rights.shape[1] - begin)
        for k in range(len(order)):
            row, given = panel[WIDTH * k : WIDTH * k + WIDTH], rights[order[k]]
            for m in range(wide):
                row[m] = given[begin + m]
            for m in range(wide, WIDTH):
                row[m] = 0.0
        _solve_panel(fronts, border, factors, exchanged, panel)
        for k in range(len(order)):
            row, found = panel[WIDTH * k : WIDTH * k + WIDTH], solutions[order[k]]
            for m in range(wide):
                found[begin + m] = row[m]


@fused
def _solve_panel(
    fronts: IntArray,
    border: IntArray,
    factors: FloatArray,
    exchanged: IntArray,
    panel: FloatArray,
) -> None:
    first = 0
    for number in range(len(fronts)):
        pivots, size, at = fronts[number, PIVOTS], fronts[number, SIZE], fronts[number, FACTORS]
        edge, begin = size - pivots, fronts[number, BORDER]
        upper = factors[at : at + pivots * size].reshape(pivots, size)
        at += pivots * size
        lower = factors[at : at + pivots * edge].reshape(pivots, edge)
        for k in range(pivots):
            other = exchanged[first + k]
            if other != k:
                for m in range(WIDTH):
                    i, j = WIDTH * (first + k) + m, WIDTH * (first + other) + m
                    panel[i], panel[j] = panel[j], panel[i]
        for k in range(0, pivots, 3):
            three = _block(panel, first + k)
            for j in range(0, k, 3):
                _subtract(three, upper[k : k + 3, j : j + 3], _block(panel, first + j))
            a, b, c = upper[k + 1, k], upper[k + 2, k], upper[k + 2, k + 1]
            for m in range(WIDTH):
                value = three[WIDTH + m] - a * three[m]
                three[WIDTH + m] = value
                three[2 * WIDTH + m] -= b * three[m] + c * value
        for i in range(0, edge, 3):
            three = _block(panel, border[begin + i])
            for k in range(0, pivots, 3):
                _subtract(three, lower[k : k + 3, i : i + 3].T, _block(panel, first + k))
        first += pivots
    for number in range(len(fronts) - 1, -1, -1):
        pivots, size, at = fronts[number, PIVOTS], fronts[number, SIZE], fronts[number, FACTORS]
        edge, begin = size - pivots, fronts[number, BORDER]
        upper = factors[at : at + pivots * size].reshape(pivots, size)
        first -= pivots
        for k in range(pivots - 3, -1, -3):
            three, rows = _block(panel, first + k), upper[k : k + 3]
            for i in range(0, edge, 3):
                at = pivots + i
                _subtract(three, rows[:, at : at + 3], _block(panel, border[begin + i]))
            for j in range(k + 3, pivots, 3):
                _subtract(three, rows[:, j : j + 3], _block(panel, first + j))
            a, b, c = rows[0, k + 1], rows[0, k + 2], rows[1, k + 2]
            inverse = rows[0, k], rows[1, k + 1], rows[2, k + 2]
            for m in range(WIDTH):
                last = three[2 * WIDTH + m] * inverse[2]
                value = (three[WIDTH + m] - c * last) * inverse[1]
                three[2 * WIDTH + m] = last
                three[WIDTH + m] = value
                three[m] = (three[m] - a * value - b * last) * inverse[0]


@inlined
def _block(panel: FloatArray, row: int) -> FloatArray:
    """Three rows that follow one another, from this one."""
    return panel[WIDTH * row : WIDTH * row + 3 * WIDTH]


@inlined
def _subtract(three: FloatArray, share: FloatArray, others: FloatArray) -> None:
    """Subtract a matrix (3, 3) times three rows from three rows."""
    a, b, c = share[0, 0], share[0, 1], share[0, 2]
    d, e, f = share[1, 0], share[1, 1], share[1, 2]
    g, h, i = share[2, 0], share[2, 1], share[2, 2]
    for m in range(WIDTH):
        x, y, z = others[m], others[WIDTH + m], others[2 * WIDTH + m]
        three[m] -= a * x + b * y + c * z
        three[WIDTH + m] -= d * x + e * y + f * z
        three[2 * WIDTH + m] -= g * x + h * y + i * z
