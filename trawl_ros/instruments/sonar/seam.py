"""Seam: the brightest line through an image that goes on from beam to beam without a jump."""

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray

REACH = 14
"""A line goes on at most so many cells nearer or further in the next beam."""

BEND = 0.5
"""Cost of each of these cells, dB."""

ENOUGH = 25.0
"""An echo counts no more for being brighter than this, dB: a fish outshines no row of ropes."""


def follow(level: FloatArray) -> IntArray:
    """Find the line along which the sum of levels is largest.

    By dynamic programming, row by row; a line may pass through rows without an echo.

    Parameters
    ----------
    level
        Shape (rows, cells), dB above what is usual.

    Returns
    -------
    array
        The line's cell in each row, shape (rows,).
    """
    worth = np.clip(level, 0.0, ENOUGH)
    rows, cells = worth.shape
    steps = np.arange(-REACH, REACH + 1)
    cost = BEND * np.abs(steps)
    total = np.full(cells + 2 * REACH, -np.inf)
    inner = slice(REACH, REACH + cells)
    # A view: it shows the totals of each cell's neighbours as they are at the time.
    around = np.lib.stride_tricks.sliding_window_view(total, len(steps))
    total[inner] = worth[0]
    came_from = np.zeros((rows, cells), dtype=int)
    everywhere = np.arange(cells)
    for row in range(1, rows):
        reached = around - cost
        step = np.argmax(reached, axis=1)
        came_from[row] = everywhere + steps[step]
        total[inner] = worth[row] + reached[everywhere, step]
    line = np.empty(rows, dtype=int)
    line[-1] = np.argmax(total[inner])
    for row in range(rows - 1, 0, -1):
        line[row - 1] = came_from[row, line[row]]
    return line
