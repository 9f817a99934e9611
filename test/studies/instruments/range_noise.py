"""Noise of a range sensor against the distance, from three readings in a row."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from studies.instruments.survey import Series
from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.windows.statistics import MAD_TO_STD

EDGES_M = (0.0, 2.0, 4.0, 8.0, 12.0, 16.0, 20.0, 40.0)
"""Edges of the classes of distance."""

WITHIN_S = 8.0
"""Three readings further apart say more of the course than of the noise."""

FEWEST = 50
"""Readings of a class, at least."""


def noise_at(hauls: Sequence[Series]) -> list[tuple[float, int]]:
    """Return the robust standard deviation (m) of noise, and the number of readings, per class.

    Each reading is compared with the line through those before and after it, so that a steady
    change does not count; NaN where there are fewer than `FEWEST`.
    """
    pairs = [_residuals(series) for series in hauls]
    level, residual = (np.concatenate(side) for side in zip(*pairs, strict=True))
    found = []
    for low, high in pairwise(EDGES_M):
        here = np.abs(residual[(level >= low) & (level < high)])
        enough = len(here) >= FEWEST
        found.append((MAD_TO_STD * float(np.median(here)) if enough else np.nan, len(here)))
    return found


def _residuals(series: Series) -> tuple[FloatArray, FloatArray]:
    time, value = series.time, series.value
    near = time[2:] - time[:-2] <= WITHIN_S
    later = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
    residual = value[1:-1] - (1.0 - later) * value[:-2] - later * value[2:]
    # Of independent errors of the same size.
    residual /= np.sqrt(1.0 + later**2 + (1.0 - later) ** 2)
    level = np.median([value[:-2], value[1:-1], value[2:]], axis=0)
    return level[near], residual[near]
