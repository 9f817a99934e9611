"""Readings of the net's openings off an image of the trawl sonar, as its operator would take them.

Nothing goes in but the image and what its rows, columns and brightness stand for. The net shows
as a line of echoes from side to side, with the footrope as its lowest point; fish between the
ropes are nearer than the footrope and off the line. A seabed in view is a straight, very bright
line, and all below it is left out. Where fish around the net hide the line, nothing is read.
"""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import ByteArray, FloatArray, IntArray
from trawl_ros.instruments.sonar.detection import CLEAR, contrast
from trawl_ros.instruments.sonar.image import BRIGHTEST, Grid
from trawl_ros.instruments.sonar.running import running_least, running_median
from trawl_ros.instruments.sonar.seam import follow

LOW_SECTOR = math.radians(30.0)
"""The footrope's lowest point is looked for within this of straight down."""

SIDE_SECTOR = math.radians(10.0)
"""A side of the net is looked for beyond this; its netting is in view beyond `NETTING_SECTOR`."""

NETTING_SECTOR = math.radians(40.0)

CROWD = 20
"""Echoes about as low as the lowest that make it doubtful which of them is the footrope. The
ropes themselves are fewer than ten."""

CROWD_BESIDE = 22.0
"""Echoes per radian outside of a side's line that make it doubtful that the line is the net."""

ROUGH = 0.6
"""A side whose line is rougher than this (m, root mean square) near its widest is no netting."""

SEABED_SECTOR, SEABED_BEAMS, SEABED_WHITE = math.radians(35.0), 8, 0.8
"""Within this sector, a straight line through so many beams, of this share of white at least, is
the seabed."""

SEABED_TILTS = (0.0, 0.05, -0.05, 0.1, -0.1, 0.15, -0.15, 0.2, -0.2)
"""Slopes of such a line, the likeliest first: the headrope hangs level but for a turn."""

_FEWEST = 6
"""A side with clear echoes in fewer beams than this is not read."""

_AROUND = 3
"""The widest place is fitted through so many beams to either side."""


@dataclass(frozen=True)
class Openings:
    """Openings read off an image (m), NaN where they cannot be read.

    ``height`` is from the sonar down to the footrope, ``width`` from side to side of the net.
    """

    height: float
    width: float


def read_openings(image: ByteArray, grid: Grid) -> Openings:
    """Read the openings off an image.

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
    # Where neither side can be told from what is around it, no footrope can.
    height = math.nan if np.isnan(halves).all() else _height(level, grid)
    return Openings(height, sum(halves))


def _sides(grid: Grid) -> list[tuple[IntArray, FloatArray]]:
    """Rows of the port and of the starboard side from below upward, and their angles outward."""
    found = []
    for outward in (1.0, -1.0):
        rows = np.argsort(outward * grid.angles)
        angles = outward * grid.angles[rows]
        found.append((rows[angles > SIDE_SECTOR], angles[angles > SIDE_SECTOR]))
    return found


def _height(level: FloatArray, grid: Grid) -> float:
    """Height (m) by the lowest clear echo below the sonar; NaN where there is none."""
    rows = np.flatnonzero(np.abs(grid.angles) < LOW_SECTOR)
    there = level[rows] >= CLEAR
    if not there.any():
        return math.nan
    down = grid.ranges * np.cos(grid.angles[rows])[:, None]
    row, column = np.nonzero(there & (down > down[there].max() - 1.0))
    # The middle of each echo that low, not its lower end.
    lowest = max(
        _middle(level[rows[k]], column[row == k][-1], grid) * math.cos(grid.angles[rows[k]])
        for k in np.unique(row)
    )
    begins = there[:, 1:] & ~there[:, :-1] & (down[:, 1:] > 0.85 * lowest)
    return math.nan if begins.sum() > CROWD else lowest


def _half_width(level: FloatArray, angles: FloatArray, grid: Grid) -> float:
    """Half width (m) of one side of the net, by a curve through the widest part of its line."""
    line = follow(level)
    beams = np.arange(len(line))
    seen = level[beams, line] >= CLEAR
    if seen.sum() < _FEWEST:
        return math.nan
    netting = seen & (angles > NETTING_SECTOR)
    beside = (level >= CLEAR) & (grid.ranges > grid.ranges[line][:, None] + 2.0) & netting[:, None]
    looked = grid.angle_increment * max(netting.sum(), 1)
    if (beside[:, 1:] & ~beside[:, :-1]).sum() > CROWD_BESIDE * looked:
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
    """Range (m) of the echo's centre in one beam at a column."""
    around = np.arange(max(column - 3, 0), min(column + 3, grid.cells - 1) + 1)
    weight = np.maximum(level[around] - 0.5 * CLEAR, 0.0) ** 2
    if weight.sum() == 0.0:
        return float(grid.ranges[column])
    return float(weight @ grid.ranges[around] / weight.sum())


def _seabed(image: ByteArray, level: FloatArray, grid: Grid) -> FloatArray:
    """Range (beams,) from which on a beam may hear the seabed, infinite without one in view.

    It is where the brightest echoes of many beams, nearly white, lie on one straight line.
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
    # A beam hears what its neighbours look at, too.
    return running_least(along, 7) - 1.0
