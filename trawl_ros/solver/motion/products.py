"""History of a step's derivatives, gathered and carried on for all parameters at once: compiled.

Derivatives (dof, m) are larger than a processor's cache, so each is read and written but once a
step. Places of the boards, the last twelve rows, turn and are worked out by the caller.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.compiled import fused

BOARDS = 12
"""Rows of the boards."""


@fused
def subtract_history(
    indices: IntArray,
    indptr: IntArray,
    stiffness: FloatArray,
    damping: FloatArray,
    slopes: FloatArray,
    way: FloatArray,
    predicted_way: FloatArray,
    pace: FloatArray,
    before: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    reached_boards: FloatArray,
    predicted_boards: FloatArray,
    right: FloatArray,
) -> None:
    """Subtract stiffness · reached + damping · pace + slopes · predicted from ``right`` (dof, m).

    The matrices are data on one pattern, whose columns come in threes of like rows. ``way``,
    ``predicted_way`` and ``pace`` are weights (3,) of the velocities, accelerations and averaged
    accelerations among the derivatives ``before`` the step, whose places come first.
    """
    number = right.shape[1]
    x, v, p = np.empty((3, number)), np.empty((3, number)), np.empty((3, number))
    tail = len(right) - BOARDS
    for column in range(0, len(right), 3):
        for i in range(3):
            place, speed = before[0][column + i], before[1][column + i]
            old, mean = before[2][column + i], before[3][column + i]
            for m in range(number):
                x[i, m] = place[m] + way[0] * speed[m] + way[1] * old[m] + way[2] * mean[m]
                p[i, m] = x[i, m] + (predicted_way[2] - way[2]) * mean[m]
                v[i, m] = pace[0] * speed[m] + pace[1] * old[m] + pace[2] * mean[m]
            if column >= tail:
                x[i], p[i] = (
                    reached_boards[column - tail + i],
                    predicted_boards[column - tail + i],
                )
        first, second, third = indptr[column], indptr[column + 1], indptr[column + 2]
        for entry in range(second - first):
            i, j, k = first + entry, second + entry, third + entry
            row = right[indices[i]]
            a0, a1, a2 = stiffness[i], stiffness[j], stiffness[k]
            b0, b1, b2 = damping[i], damping[j], damping[k]
            c0, c1, c2 = slopes[i], slopes[j], slopes[k]
            for m in range(number):
                row[m] -= (
                    (a0 * x[0, m] + a1 * x[1, m] + a2 * x[2, m])
                    + (b0 * v[0, m] + b1 * v[1, m] + b2 * v[2, m])
                    + (c0 * p[0, m] + c1 * p[1, m] + c2 * p[2, m])
                )


@fused
def carry_on(
    way: FloatArray,
    pace: FloatArray,
    carried: FloatArray,
    by_shift: FloatArray,
    before: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    shift: FloatArray,
    after: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> None:
    """Fill in the derivatives after a step from those before it and from the solution ``shift``.

    ``by_shift`` (4,) is the share of that in places, velocities, accelerations and averaged ones;
    ``carried`` are weights (3,) as the others of `subtract_history`.
    """
    for row in range(len(shift)):
        place, speed, old, mean = before[0][row], before[1][row], before[2][row], before[3][row]
        new = shift[row]
        for m in range(len(new)):
            s, a, b = speed[m], old[m], mean[m]
            after[0][row, m] = (
                place[m] + way[0] * s + way[1] * a + way[2] * b + by_shift[0] * new[m]
            )
            after[1][row, m] = pace[0] * s + pace[1] * a + pace[2] * b + by_shift[1] * new[m]
            after[2][row, m] = by_shift[2] * new[m]
            after[3][row, m] = carried[1] * a + carried[2] * b + by_shift[3] * new[m]
