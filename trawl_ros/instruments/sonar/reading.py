# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Readings of the net's openings from an image of the trawl sonar, as an operator takes them.

Input is the image with the meaning of its rows, columns and brightness only. The net is a line of
echoes from side to side, with the footrope as its lowest point; fish between the ropes are nearer
than the footrope and off the line. A seabed in view is a straight, very bright line; everything
below it is ignored. If fish around the net hide the line, there is no reading.
"""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import ByteArray, FloatArray, IntArray
from trawl_ros.instruments.sonar.detection import CLEAR_CONTRAST_DB, contrast
from trawl_ros.instruments.sonar.image import BRIGHTEST, Grid
from trawl_ros.instruments.sonar.running import running_least, running_median


@dataclass(frozen=True)
class LineSearch:
    """Options of the search for a line that continues from beam to beam.

    Attributes
    ----------
    reach_cells
        Greatest change of the cell from one beam to the next.
    cost_db
        Cost of each cell of change, dB.
    ceiling_db
        Level from which brightness does not count, dB: a fish must not outweigh a row of ropes.
    """

    reach_cells: int = 14
    cost_db: float = 0.5
    ceiling_db: float = 25.0


@dataclass(frozen=True)
class ReadingOptions:
    """Options of the reading of an image.

    Attributes
    ----------
    footrope_sector
        Greatest angle (rad) from straight down at which the footrope's lowest point is searched.
    side_sector, netting_sector
        Least angles (rad) from straight down at which a side of the net is searched, and at which
        its netting is in view.
    crowd_low
        Greatest number of echoes about as low as the lowest; with more it is doubtful which one is
        the footrope. The ropes are fewer than ten.
    crowd_beside_per_rad
        Greatest number of echoes per radian outside a side's line; with more it is doubtful that
        the line is the net.
    roughness_m
        Greatest roughness (m, root mean square) of a side's line near its widest place.
    seabed_sector, seabed_beams, seabed_white
        The seabed is a straight line within this angle (rad) of straight down, through at least so
        many beams, with at least this part of the greatest brightness.
    seabed_tilts
        Slopes of this line, the most likely first: the headrope is level except in turns.
    least_beams
        Least number of beams with clear echoes for the reading of a side.
    beams_around
        Number of beams on either side of the widest place through which a curve is fitted.
    line
        Search for a side's line.
    """

    footrope_sector: float = math.radians(30.0)
    side_sector: float = math.radians(10.0)
    netting_sector: float = math.radians(40.0)
    crowd_low: int = 20
    crowd_beside_per_rad: float = 22.0
    roughness_m: float = 0.6
    seabed_sector: float = math.radians(35.0)
    seabed_beams: int = 8
    seabed_white: float = 0.8
    seabed_tilts: tuple[float, ...] = (0.0, 0.05, -0.05, 0.1, -0.1, 0.15, -0.15, 0.2, -0.2)
    least_beams: int = 6
    beams_around: int = 3
    line: LineSearch = LineSearch()


DEFAULT_READING = ReadingOptions()


@dataclass(frozen=True)
class Openings:
    """Openings read from an image (m), NaN if they cannot be read.

    ``height`` is from the sonar down to the footrope, ``width`` from side to side of the net.
    """

    height: float
    width: float


def read_openings(
    image: ByteArray, grid: Grid, options: ReadingOptions = DEFAULT_READING
) -> Openings:
    """Read the openings from an image.

    Parameters
    ----------
    image
        Shape (beams, cells), uint8.
    grid
        Meaning of its rows, columns and brightness.
    options
        Options of the reading.
    """
    level = contrast(image, grid)
    level = np.where(grid.ranges < _seabed(image, level, grid, options)[:, None], level, 0.0)
    halves = [
        _half_width(level[rows], angles, grid, options) for rows, angles in _sides(grid, options)
    ]
    # If neither side can be distinguished from its surroundings, neither can the footrope.
    height = math.nan if np.isnan(halves).all() else _height(level, grid, options)
    return Openings(height, sum(halves))


def _sides(grid: Grid, options: ReadingOptions) -> list[tuple[IntArray, FloatArray]]:
    """Return the rows of the port and the starboard side, upward, and their angles outward."""
    found = []
    for outward in (1.0, -1.0):
        rows = np.argsort(outward * grid.angles)
        angles = outward * grid.angles[rows]
        found.append((rows[angles > options.side_sector], angles[angles > options.side_sector]))
    return found


def _height(level: FloatArray, grid: Grid, options: ReadingOptions) -> float:
    """Return the height (m) from the lowest clear echo below the sonar; NaN without one."""
    rows = np.flatnonzero(np.abs(grid.angles) < options.footrope_sector)
    there = level[rows] >= CLEAR_CONTRAST_DB
    if not there.any():
        return math.nan
    down = grid.ranges * np.cos(grid.angles[rows])[:, None]
    row, column = np.nonzero(there & (down > down[there].max() - 1.0))
    # Each echo counts with its centre, not with its lower end.
    lowest = max(
        _middle(level[rows[k]], column[row == k][-1], grid) * math.cos(grid.angles[rows[k]])
        for k in np.unique(row)
    )
    begins = there[:, 1:] & ~there[:, :-1] & (down[:, 1:] > 0.85 * lowest)
    return math.nan if begins.sum() > options.crowd_low else lowest


def _half_width(
    level: FloatArray, angles: FloatArray, grid: Grid, options: ReadingOptions
) -> float:
    """Return the half width (m) of a side, from a curve through the widest part of its line."""
    line = follow(level, options.line)
    beams = np.arange(len(line))
    seen = level[beams, line] >= CLEAR_CONTRAST_DB
    if seen.sum() < options.least_beams:
        return math.nan
    netting = seen & (angles > options.netting_sector)
    outside = (
        (level >= CLEAR_CONTRAST_DB)
        & (grid.ranges > grid.ranges[line][:, None] + 2.0)
        & netting[:, None]
    )
    looked = grid.angle_increment * max(netting.sum(), 1)
    if (outside[:, 1:] & ~outside[:, :-1]).sum() > options.crowd_beside_per_rad * looked:
        return math.nan
    at = angles[seen]
    out = np.array([_middle(level[k], line[k], grid) for k in beams[seen]]) * np.sin(at)
    smooth = running_median(out, 3)
    widest = int(np.argmax(smooth))
    near = slice(max(widest - options.beams_around, 0), widest + options.beams_around + 1)
    fits = np.abs(out[near] - smooth[near]) < 1.5
    place, way = at[near][fits] - at[widest], out[near][fits]
    if len(way) < 4:
        return math.nan
    curve = np.polynomial.Polynomial.fit(place, way, 2)
    if np.sqrt(np.mean((curve(place) - way) ** 2)) > options.roughness_m:
        return math.nan
    return float(curve(np.linspace(place.min(), place.max(), 25)).max())


def _middle(level: FloatArray, column: int, grid: Grid) -> float:
    """Return the range (m) of the echo's centre in one beam at a column."""
    around = np.arange(max(column - 3, 0), min(column + 3, grid.cells - 1) + 1)
    weight = np.maximum(level[around] - 0.5 * CLEAR_CONTRAST_DB, 0.0) ** 2
    if weight.sum() == 0.0:
        return float(grid.ranges[column])
    return float(weight @ grid.ranges[around] / weight.sum())


def _seabed(image: ByteArray, level: FloatArray, grid: Grid, options: ReadingOptions) -> FloatArray:
    """Return the range (beams,) from which on a beam may receive the seabed, else infinity.

    The seabed is in view if the brightest echoes of many beams, nearly white, lie on one straight
    line.
    """
    none = np.full(grid.beams, math.inf)
    brightest = np.argmax(level, axis=1)
    each = np.arange(grid.beams)
    rows = np.flatnonzero(
        (np.abs(grid.angles) < options.seabed_sector)
        & (level[each, brightest] >= CLEAR_CONTRAST_DB)
        & (image[each, brightest] > options.seabed_white * BRIGHTEST)
    )
    if len(rows) < options.seabed_beams:
        return none
    away = grid.ranges[brightest[rows]]
    down, out = away * np.cos(grid.angles[rows]), away * np.sin(grid.angles[rows])
    depth, slope, most = 0.0, 0.0, 0
    for tilt in options.seabed_tilts:
        under = down - tilt * out
        on = np.abs(under[:, None] - under) < 1.0
        count = on.sum(axis=1)
        if count.max() > most:
            most, slope = count.max(), tilt
            depth = float(np.median(under[on[np.argmax(count)]]))
    if most < options.seabed_beams:
        return none
    fall = np.cos(grid.angles) - slope * np.sin(grid.angles)
    along = np.where(fall > 0.05, depth / np.maximum(fall, 0.05), math.inf)
    # A beam receives echoes from the directions of its neighbours too.
    return running_least(along, 7) - 1.0


def follow(level: FloatArray, search: LineSearch) -> IntArray:
    """Find the line with the largest sum of levels, by dynamic programming over the rows.

    A line may pass through rows without an echo.

    Parameters
    ----------
    level
        Contrast, shape (rows, cells), dB.
    search
        Options.

    Returns
    -------
    array
        Cell of the line in each row, shape (rows,).
    """
    worth, reach = np.clip(level, 0.0, search.ceiling_db), search.reach_cells
    rows, cells = worth.shape
    steps = np.arange(-reach, reach + 1)
    cost = search.cost_db * np.abs(steps)
    total = np.full(cells + 2 * reach, -np.inf)
    inner = slice(reach, reach + cells)
    # A view: it shows the present totals of each cell's neighbours.
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
