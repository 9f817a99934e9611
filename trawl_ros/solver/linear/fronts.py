# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Compiled factorisation front by front, and solution with the factors.

Fronts are dense and row-major. Pivots are exchanged only within the pivot rows of a front, so the
order found for the pattern stays valid; `trawl_ros.solver.linear.factor` checks the accuracy. All
functions accept real and complex matrices.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.compiled import inlined, njit_fastmath

PIVOTS, SIZE, CHILDREN, ENTRIES, BORDER, ROWS, FACTORS = range(7)
"""Columns of `Elimination.fronts`."""

PIVOTS_AT_ONCE = 6
"""Pivots eliminated together; their rows stay in registers while the rest is updated."""

EXCHANGE_RATIO = 10.0
"""A pivot is exchanged if another of its front is larger by this factor."""

PANEL_COLUMNS = 24
"""Right-hand sides of a panel in `solve_many`."""


@njit_fastmath
def factorise(
    data: FloatArray,
    fronts: IntArray,
    slots: IntArray,
    places: IntArray,
    parents_rows: IntArray,
    factors: FloatArray,
    exchanged: IntArray,
    waiting: FloatArray,
    space: FloatArray,
) -> bool:
    """Factorise the matrix of ``data`` into ``factors``; False if a pivot vanished.

    ``exchanged`` (dof,) receives the pivot row with which each row changed places. ``space``
    (2, ...) holds the current front and the one before, which is its last child if it has any.
    ``waiting`` holds the update matrices of the other children.
    """
    stack = np.empty(len(fronts), np.int64)
    held = end = entry = first = 0
    last = space[:0, :0]
    for number in range(len(fronts)):
        pivots, size = fronts[number, PIVOTS], fronts[number, SIZE]
        edge = size - pivots
        flat = space[number % 2, : size * size]
        flat[:] = 0.0
        while entry < fronts[number, ENTRIES]:
            flat[places[entry]] += data[slots[entry]]
            entry += 1
        front = flat.reshape(size, size)
        for earlier in range(fronts[number, CHILDREN]):
            if earlier == 0:
                child, rest = number - 1, last
            else:
                held -= 1
                child = stack[held]
                width = fronts[child, SIZE] - fronts[child, PIVOTS]
                end -= width * width
                rest = waiting[end : end + width * width].reshape(width, width)
            at = fronts[child, ROWS]
            _add_rest(rest, parents_rows[at : at + len(rest) // 3], front)
        if not _eliminate(front, pivots, exchanged[first : first + pivots]):
            return False
        at = fronts[number, FACTORS]
        for k in range(pivots * size):
            factors[at + k] = flat[k]
        at += pivots * size
        for i in range(edge):
            for k in range(pivots):
                factors[at + k * edge + i] = front[pivots + i, k]
        last = front[pivots:, pivots:]
        if number + 1 < len(fronts) and fronts[number + 1, CHILDREN] == 0:
            for i in range(edge):
                for k in range(edge):
                    waiting[end] = last[i, k]
                    end += 1
            stack[held] = number
            held += 1
        first += pivots
    return True


@inlined
def _add_rest(rest: FloatArray, rows: IntArray, front: FloatArray) -> None:
    """Add the update matrix of a child to the front of its parent, block by block (extend-add)."""
    for i in range(len(rest)):
        source, target = rest[i], front[rows[i // 3] + i % 3]
        for j in range(len(rows)):
            at = rows[j]
            target[at] += source[3 * j]
            target[at + 1] += source[3 * j + 1]
            target[at + 2] += source[3 * j + 2]


@inlined
def _eliminate(front: FloatArray, pivots: int, exchanged: IntArray) -> bool:
    """Eliminate the pivots of a front in place: L below its diagonal, U above, 1 / U on it."""
    # A blocked right-looking LU: factorise a panel of columns, finish its rows, update the rest.
    size = len(front)
    for first in range(0, pivots, PIVOTS_AT_ONCE):
        last = min(first + PIVOTS_AT_ONCE, pivots)
        for k in range(first, last):
            best, chosen = EXCHANGE_RATIO * abs(front[k, k]), k
            for i in range(k + 1, pivots):
                if abs(front[i, k]) > best:
                    best, chosen = abs(front[i, k]), i
            exchanged[k] = chosen
            if chosen != k:
                for j in range(size):
                    front[k, j], front[chosen, j] = front[chosen, j], front[k, j]
            if front[k, k] == 0.0:
                return False
            inverse = 1.0 / front[k, k]
            front[k, k] = inverse
            for i in range(k + 1, size):
                share = front[i, k] * inverse
                front[i, k] = share
                for j in range(k + 1, last):
                    front[i, j] -= share * front[k, j]
        for k in range(first + 1, last):
            for i in range(first, k):
                share = front[k, i]
                for j in range(last, size):
                    front[k, j] -= share * front[i, j]
        if last - first == PIVOTS_AT_ONCE:
            _update_by_six(front, first)
        else:
            _update_by_three(front, first)
    return True


@inlined
def _update_by_six(front: FloatArray, k: int) -> None:
    """Subtract the product of six columns of L and six rows of U from the trailing matrix."""
    size, end = len(front), k + 6
    u0, u1, u2 = front[k, end:], front[k + 1, end:], front[k + 2, end:]
    u3, u4, u5 = front[k + 3, end:], front[k + 4, end:], front[k + 5, end:]
    for i in range(end, size):
        a0, a1, a2 = front[i, k], front[i, k + 1], front[i, k + 2]
        a3, a4, a5 = front[i, k + 3], front[i, k + 4], front[i, k + 5]
        row = front[i, end:]
        for j in range(size - end):
            row[j] -= a0 * u0[j] + a1 * u1[j] + a2 * u2[j] + a3 * u3[j] + a4 * u4[j] + a5 * u5[j]


@inlined
def _update_by_three(front: FloatArray, k: int) -> None:
    """Subtract the product of three columns of L and three rows of U from the trailing matrix."""
    size, end = len(front), k + 3
    u0, u1, u2 = front[k, end:], front[k + 1, end:], front[k + 2, end:]
    for i in range(end, size):
        a0, a1, a2 = front[i, k], front[i, k + 1], front[i, k + 2]
        row = front[i, end:]
        for j in range(size - end):
            row[j] -= a0 * u0[j] + a1 * u1[j] + a2 * u2[j]


@njit_fastmath
def solve(
    rights: FloatArray,
    order: IntArray,
    fronts: IntArray,
    border: IntArray,
    factors: FloatArray,
    exchanged: IntArray,
    solutions: FloatArray,
) -> None:
    """Solve for right-hand sides (k, dof) with the factors, one after another.

    Pivots are taken in threes, one block of unknowns, so that three rows of a factor are read in
    one pass.
    """
    largest = 0
    for number in range(len(fronts)):
        largest = max(largest, fronts[number, SIZE])
    x, beyond = np.empty(len(order), rights.dtype), np.empty(largest, rights.dtype)
    for right in range(len(rights)):
        for k in range(len(order)):
            x[k] = rights[right, order[k]]
        first = 0
        for number in range(len(fronts)):
            pivots, size = fronts[number, PIVOTS], fronts[number, SIZE]
            edge, begin, at = size - pivots, fronts[number, BORDER], fronts[number, FACTORS]
            upper = factors[at : at + pivots * size].reshape(pivots, size)
            at += pivots * size
            y, rest = x[first : first + pivots], beyond[:edge]
            for k in range(pivots):
                other = exchanged[first + k]
                y[k], y[other] = y[other], y[k]
            rest[:] = 0.0
            for k in range(0, pivots, 3):
                u, v, w = upper[k], upper[k + 1], upper[k + 2]
                a, b, c = y[k], y[k + 1], y[k + 2]
                for j in range(k):
                    a -= u[j] * y[j]
                    b -= v[j] * y[j]
                    c -= w[j] * y[j]
                b -= v[k] * a
                c -= w[k] * a + w[k + 1] * b
                y[k], y[k + 1], y[k + 2] = a, b, c
                u, v, w = factors[at:], factors[at + edge :], factors[at + 2 * edge :]
                at += 3 * edge
                for i in range(edge):
                    rest[i] += u[i] * a + v[i] * b + w[i] * c
            rows = border[begin : begin + edge]
            for i in range(edge):
                x[rows[i]] -= rest[i]
            first += pivots
        for number in range(len(fronts) - 1, -1, -1):
            pivots, size = fronts[number, PIVOTS], fronts[number, SIZE]
            edge, begin, at = size - pivots, fronts[number, BORDER], fronts[number, FACTORS]
            upper = factors[at : at + pivots * size].reshape(pivots, size)
            first -= pivots
            y, rest, rows = x[first : first + pivots], beyond[:edge], border[begin : begin + edge]
            for i in range(edge):
                rest[i] = x[rows[i]]
            for k in range(pivots - 3, -1, -3):
                u, v, w = upper[k], upper[k + 1], upper[k + 2]
                a, b, c = y[k], y[k + 1], y[k + 2]
                for j in range(k + 3, pivots):
                    a -= u[j] * y[j]
                    b -= v[j] * y[j]
                    c -= w[j] * y[j]
                u, v, w = upper[k, pivots:], upper[k + 1, pivots:], upper[k + 2, pivots:]
                for i in range(edge):
                    a -= u[i] * rest[i]
                    b -= v[i] * rest[i]
                    c -= w[i] * rest[i]
                c *= upper[k + 2, k + 2]
                b = (b - upper[k + 1, k + 2] * c) * upper[k + 1, k + 1]
                a = (a - upper[k, k + 1] * b - upper[k, k + 2] * c) * upper[k, k]
                y[k], y[k + 1], y[k + 2] = a, b, c
        for k in range(len(order)):
            solutions[right, order[k]] = x[k]


@njit_fastmath
def solve_many(
    rights: FloatArray,
    order: IntArray,
    fronts: IntArray,
    border: IntArray,
    factors: FloatArray,
    exchanged: IntArray,
    solutions: FloatArray,
) -> None:
    """Solve for many right-hand sides (dof, m) with the factors, in panels of a fixed width.

    Each number of the factors is used for a whole panel while it is in a register. The width is a
    compile-time constant, so the compiler can vectorise and rule out overlapping rows.
    """
    panel = np.empty(PANEL_COLUMNS * len(order), rights.dtype)
    for begin in range(0, rights.shape[1], PANEL_COLUMNS):
        wide = min(PANEL_COLUMNS, rights.shape[1] - begin)
        for k in range(len(order)):
            row, given = (
                panel[PANEL_COLUMNS * k : PANEL_COLUMNS * k + PANEL_COLUMNS],
                rights[order[k]],
            )
            for m in range(wide):
                row[m] = given[begin + m]
            for m in range(wide, PANEL_COLUMNS):
                row[m] = 0.0
        _solve_panel(fronts, border, factors, exchanged, panel)
        for k in range(len(order)):
            row, found = (
                panel[PANEL_COLUMNS * k : PANEL_COLUMNS * k + PANEL_COLUMNS],
                solutions[order[k]],
            )
            for m in range(wide):
                found[begin + m] = row[m]


@njit_fastmath
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
                for m in range(PANEL_COLUMNS):
                    i, j = PANEL_COLUMNS * (first + k) + m, PANEL_COLUMNS * (first + other) + m
                    panel[i], panel[j] = panel[j], panel[i]
        for k in range(0, pivots, 3):
            three = _block(panel, first + k)
            for j in range(0, k, 3):
                _subtract(three, upper[k : k + 3, j : j + 3], _block(panel, first + j))
            a, b, c = upper[k + 1, k], upper[k + 2, k], upper[k + 2, k + 1]
            for m in range(PANEL_COLUMNS):
                value = three[PANEL_COLUMNS + m] - a * three[m]
                three[PANEL_COLUMNS + m] = value
                three[2 * PANEL_COLUMNS + m] -= b * three[m] + c * value
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
            for m in range(PANEL_COLUMNS):
                last = three[2 * PANEL_COLUMNS + m] * inverse[2]
                value = (three[PANEL_COLUMNS + m] - c * last) * inverse[1]
                three[2 * PANEL_COLUMNS + m] = last
                three[PANEL_COLUMNS + m] = value
                three[m] = (three[m] - a * value - b * last) * inverse[0]


@inlined
def _block(panel: FloatArray, row: int) -> FloatArray:
    """Return three consecutive rows of a panel, from this one."""
    return panel[PANEL_COLUMNS * row : PANEL_COLUMNS * row + 3 * PANEL_COLUMNS]


@inlined
def _subtract(three: FloatArray, share: FloatArray, others: FloatArray) -> None:
    """Subtract a matrix (3, 3) times three rows from three rows."""
    a, b, c = share[0, 0], share[0, 1], share[0, 2]
    d, e, f = share[1, 0], share[1, 1], share[1, 2]
    g, h, i = share[2, 0], share[2, 1], share[2, 2]
    for m in range(PANEL_COLUMNS):
        x, y, z = others[m], others[PANEL_COLUMNS + m], others[2 * PANEL_COLUMNS + m]
        three[m] -= a * x + b * y + c * z
        three[PANEL_COLUMNS + m] -= d * x + e * y + f * z
        three[2 * PANEL_COLUMNS + m] -= g * x + h * y + i * z


def dense_solution(matrix: FloatArray, right: FloatArray) -> FloatArray | None:
    """Solve a small dense system (k, k) as a single front; None where the matrix is singular.

    LAPACK would start threads here, which cost more than they save at this size.
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
