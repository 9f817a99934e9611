"""Detection of echoes in an image."""

import numpy as np

from trawl_ros.core.arrays import ByteArray, FloatArray, IntArray
from trawl_ros.instruments.sonar.image import BRIGHTEST, Grid
from trawl_ros.instruments.sonar.running import running_mean

CLEAR = 12.0
"""An echo is clear where the image is this much (dB) brighter than usual at its range: of the
means of three cells of noise alone, whose levels scatter by 3.2 dB, few per million are."""

_ALONG = 3
_NOISE_ALONG = 9


def contrast(image: ByteArray, grid: Grid) -> FloatArray:
    """Contrast of an image against the usual level at each range.

    Parameters
    ----------
    image
        Shape (beams, cells), uint8.

    Returns
    -------
    array
        Shape (beams, cells), dB: means over three cells above the median of all beams; zero so
        near to the sonar that its own pulse is heard.
    """
    level = running_mean(image.astype(float), _ALONG) * (grid.span / BRIGHTEST)
    usual = running_mean(np.median(level, axis=0), _NOISE_ALONG)
    level -= usual
    level[:, grid.ranges < 2 * grid.min_range] = 0.0
    return level


def clear_echoes(image: ByteArray, grid: Grid) -> tuple[IntArray, IntArray]:
    """Detect all echoes.

    Returns
    -------
    rows, columns
        Shape (n,) each: the brightest cell of each run of clear cells, by row and range.
    """
    level = contrast(image, grid)
    there = level >= CLEAR
    begins = there & ~np.pad(there, ((0, 0), (1, 0)))[:, :-1]
    rows, starts = np.nonzero(begins)
    if len(rows) == 0:
        return rows, starts
    run = np.cumsum(begins.ravel()).reshape(there.shape)[there] - 1
    # Sorted by run, then brightness: the last of each run is its brightest.
    order = np.lexsort((level[there], run))
    last = order[np.append(np.flatnonzero(np.diff(run[order])), len(order) - 1)]
    columns: IntArray = np.nonzero(there)[1][last]
    return rows, columns


def first_echoes(image: ByteArray, grid: Grid) -> tuple[FloatArray, FloatArray]:
    """Detect the nearest echo of each beam.

    Returns
    -------
    ranges, intensities
        Shape (beams,) each: m, infinite without an echo, and brightness, then zero.
    """
    ranges, intensities = np.full(grid.beams, np.inf), np.zeros(grid.beams)
    rows, columns = clear_echoes(image, grid)
    first, where = np.unique(rows, return_index=True)
    ranges[first] = grid.ranges[columns[where]]
    intensities[first] = image[first, columns[where]]
    return ranges, intensities
