# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Detection of echoes in an image."""

import numpy as np

from trawl_ros.core.arrays import ByteArray, FloatArray, IntArray
from trawl_ros.instruments.sonar.image import BRIGHTEST, Grid
from trawl_ros.instruments.sonar.running import running_mean

CLEAR_CONTRAST_DB = 12.0
"""Contrast from which an echo is clear.

Means over three cells of noise have a standard deviation of 3.2 dB; few per million exceed it.
"""

_SIGNAL_CELLS = 3
"""Width of the mean along a beam."""

_NOISE_CELLS = 9
"""Width of the mean over ranges of the usual level."""


def contrast(image: ByteArray, grid: Grid) -> FloatArray:
    """Return the contrast of an image against the usual level at each range.

    Parameters
    ----------
    image
        Shape (beams, cells), uint8.

    Returns
    -------
    array
        Shape (beams, cells), dB: means over three cells, relative to the median of all beams; zero
        at ranges where the sonar receives its own pulse.
    """
    level = running_mean(image.astype(float), _SIGNAL_CELLS) * (grid.span / BRIGHTEST)
    usual = running_mean(np.median(level, axis=0), _NOISE_CELLS)
    level -= usual
    level[:, grid.ranges < 2 * grid.min_range] = 0.0
    return level


def clear_echoes(image: ByteArray, grid: Grid) -> tuple[IntArray, IntArray]:
    """Detect all echoes.

    Returns
    -------
    rows, columns
        Shape (n,) each: brightest cell of each run of clear cells, sorted by row and range.
    """
    level = contrast(image, grid)
    there = level >= CLEAR_CONTRAST_DB
    begins = there & ~np.pad(there, ((0, 0), (1, 0)))[:, :-1]
    rows, starts = np.nonzero(begins)
    if len(rows) == 0:
        return rows, starts
    run = np.cumsum(begins.ravel()).reshape(there.shape)[there] - 1
    # Sorted by run, then brightness: the last cell of each run is its brightest.
    order = np.lexsort((level[there], run))
    last = order[np.append(np.flatnonzero(np.diff(run[order])), len(order) - 1)]
    columns: IntArray = np.nonzero(there)[1][last]
    return rows, columns


def first_echoes(image: ByteArray, grid: Grid) -> tuple[FloatArray, FloatArray]:
    """Detect the nearest echo of each beam.

    Returns
    -------
    ranges, intensities
        Shape (beams,) each: range (m) and brightness; infinity and zero without an echo.
    """
    ranges, intensities = np.full(grid.beams, np.inf), np.zeros(grid.beams)
    rows, columns = clear_echoes(image, grid)
    first, where = np.unique(rows, return_index=True)
    ranges[first] = grid.ranges[columns[where]]
    intensities[first] = image[first, columns[where]]
    return ranges, intensities
