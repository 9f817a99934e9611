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
from trawl_ros.instruments.sonar.detection import CLEAR, contrast
from trawl_ros.instruments.sonar.image import BRIGHTEST, Grid
from trawl_ros.instruments.sonar.running import running_least, running_median

LOW_SECTOR = math.radians(30.0)
"""Greatest angle from straight down at which the footrope's lowest point is searched."""

SIDE_SECTOR = math.radians(10.0)
"""Least angle from straight down at which a side of the net is searched."""

NETTING_SECTOR = math.radians(40.0)
"""Least angle from straight down at which the netting of a side is in view."""

CROWD = 20
"""Echoes about as low as the lowest that make it doubtful which of them is the footrope. The
ropes themselves are fewer than ten."""

CROWD_BESIDE = 1.0
"""Echoes per beam outside of a side's line that make it doubtful that the line is the net."""

ROUGH = 0.6
"""A side whose line is rougher than this (m, root mean square) near its widest is no netting."""

SEABED_SECTOR, SEABED_BEAMS, SEABED_WHITE = math.radians(35.0), 8, 0.8
"""Within this sector, a straight line through so many beams, of this share of white at least, is
the seabed."""

SEABED_TILTS = (0.0, 0.05, -0.05, 0.1, -0.1, 0.15, -0.15, 0.2, -0.2)
"""Slopes of such a line, the likeliest first: the headrope hangs level but for a turn."""

_FEWEST = 6
"""Least number of beams with clear echoes for the reading of a side."""

_AROUND = 3
"""Number of beams on either side of the widest place through which a curve is fitted."""


@dataclass(frozen=True)
class Openings:
    """Openings read from an image (m), NaN if they cannot be read.

    ``height`` is from the sonar down to the footrope, ``width`` from side to side of the net.
    """

    height: float
    width: float


def read_openings(image: ByteArray, grid: Grid) -> Openings:
    """Read the openings from an image.

    Parameters
    ----------
    image
        Shape (beams, cells), uint8.
    grid
        Meaning of its rows, columns and brightness.
    """
    level = contrast(image, grid)
    level = np.where(grid.ranges < _seabed(image, level, grid)[:, None], level, 0.0)
    halves = [_half_width(level[rows], angles, grid) for rows, angles in _sides(grid)]
    # If neither side can be distinguished from its surroundings, neither can the footrope.
    height = math.nan if np.isnan(halves).all() else _height(level, grid)
    return Openings(height, sum(halves))


def _sides(grid: Grid) -> list[tuple[IntArray, FloatArray]]:
    """Return the rows of the port and the starboard side, upward, and their angles outward."""
    found = []
    for outward in (1.0, -1.0):
        rows = np.argsort(outward * grid.angles)
        angles = outward * grid.angles[rows]
        found.append((rows[angles > SIDE_SECTOR], angles[angles > SIDE_SECTOR]))
    return found


def _height(level: FloatArray, grid: Grid) -> float:
    """Return the height (m) from the lowest clear echo below the sonar; NaN without one."""
    rows = np.flatnonzero(np.abs(grid.angles) < LOW_SECTOR)
    there = level[rows] >= CLEAR
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
    return math.nan if begins.sum() > CROWD else lowest


def _half_width(level: FloatArray, angles: FloatArray, grid: Grid) -> float:
    """Return the half width (m) of a side, from a curve through the widest part of its line."""
    line = follow(level, LineSearch())
    beams = np.arange(len(line))
    seen = level[beams, line] >= CLEAR
    if seen.sum() < _FEWEST:
        return math.nan
    netting = seen & (angles > NETTING_SECTOR)
    beside = (level >= CLEAR) & (grid.ranges > grid.ranges[line][:, None] + 2.0) & netting[:, None]
    if (beside[:, 1:] & ~beside[:, :-1]).sum() > CROWD_BESIDE * max(netting.sum(), 1):
        return math.nan
    at = angles[seen]
    out = np.array([_middle(level[k], line[k], grid) for k in beams[seen]]) * np.sin(at)
    smooth = running_median(out, 3)
    widest = int(np.argmax(smooth))
    near = slice(max(widest - _AROUND, 0), widest + _AROUND + 1)
    fits = np.abs(out[near] - smooth[near]) < 1.5
    place, way = at[near][fits] - at[widest], out[near][fits]
    if len(way) < 4:
        return math.nan
    curve = np.polynomial.Polynomial.fit(place, way, 2)
    if np.sqrt(np.mean((curve(place) - way) ** 2)) > ROUGH:
        return math.nan
    return float(curve(np.linspace(place.min(), place.max(), 25)).max())


def _middle(level: FloatArray, column: int, grid: Grid) -> float:
    """Return the range (m) of the echo's centre in one beam at a column."""
    around = np.arange(max(column - 3, 0), min(column + 3, grid.cells - 1) + 1)
    weight = np.maximum(level[around] - 0.5 * CLEAR, 0.0) ** 2
    if weight.sum() == 0.0:
        return float(grid.ranges[column])
    return float(weight @ grid.ranges[around] / weight.sum())


def _seabed(image: ByteArray, level: FloatArray, grid: Grid) -> FloatArray:
    """Return the range (beams,) from which on a beam may receive the seabed, else infinity.

    The seabed is in view if the brightest echoes of many beams, nearly white, lie on one straight
    line.
    """
    none = np.full(grid.beams, math.inf)
    brightest = np.argmax(level, axis=1)
    each = np.arange(grid.beams)
    rows = np.flatnonzero(
        (np.abs(grid.angles) < SEABED_SECTOR)
        & (level[each, brightest] >= CLEAR)
        & (image[each, brightest] > SEABED_WHITE * BRIGHTEST)
    )
    if len(rows) < SEABED_BEAMS:
        return none
    away = grid.ranges[brightest[rows]]
    down, out = away * np.cos(grid.angles[rows]), away * np.sin(grid.angles[rows])
    depth, slope, most = 0.0, 0.0, 0
    for tilt in SEABED_TILTS:
        under = down - tilt * out
        on = np.abs(under[:, None] - under) < 1.0
        count = on.sum(axis=1)
        if count.max() > most:
            most, slope = count.max(), tilt
            depth = float(np.median(under[on[np.argmax(count)]]))
    if most < SEABED_BEAMS:
        return none
    fall = np.cos(grid.angles) - slope * np.sin(grid.angles)
    along = np.where(fall > 0.05, depth / np.maximum(fall, 0.05), math.inf)
    # A beam receives echoes from the directions of its neighbours too.
    return running_least(along, 7) - 1.0


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
