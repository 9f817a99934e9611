"""Numerical factorisation front by front, and solution with the factors: compiled.

Fronts are dense and row-major. Pivots are exchanged within the pivot rows of a front alone, so the
order found for the pattern stands; `trawl_ros.solver.linear.factor` looks whether that was good
enough. All takes real matrices, and complex ones.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.compiled import fused, inlined

PIVOTS, SIZE, CHILDREN, ENTRIES, BORDER, ROWS, FACTORS = range(7)
"""Columns of `Elimination.fronts`."""

PANEL = 6
"""Pivots that are eliminated together: their rows stay in registers while the rest is updated."""

EXCHANGE = 10.0
"""A pivot is exchanged with one so many times as large."""


@fused
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

    ``exchanged`` (dof,) gets the pivot row with which each changed places; ``space`` (2, ...) is
    for the front at work and the one before, which is its last child unless it has none; what is
    left of other children is ``waiting``.
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
    """Add what is left of a child's border into its parent's front, block by block."""
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
    size = len(front)
    for first in range(0, pivots, PANEL):
        last = min(first + PANEL, pivots)
        for k in range(first, last):
            best, chosen = EXCHANGE * abs(front[k, k]), k
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
        if last - first == PANEL:
            _update_by_six(front, first)
        else:
            _update_by_three(front, first)
    return True


@inlined
def _update_by_six(front: FloatArray, k: int) -> None:
    """Subtract the product of six columns of L and six rows of U from all behind them."""
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
    """Subtract the product of three columns of L and three rows of U from all behind them."""
    size, end = len(front), k + 3
    u0, u1, u2 = front[k, end:], front[k + 1, end:], front[k + 2, end:]
    for i in range(end, size):
        a0, a1, a2 = front[i, k], front[i, k + 1], front[i, k + 2]
        row = front[i, end:]
        for j in range(size - end):
            row[j] -= a0 * u0[j] + a1 * u1[j] + a2 * u2[j]


@fused
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

    Pivots are taken in threes, which is one block of unknowns: rows of L and U are read side by
    side.
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
