# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Acoustic geometry of schools of fish."""

import math

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.records.truth import SchoolTruth


def inside(
    school: SchoolTruth, position: FloatArray, ways: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the distances at which straight lines enter and leave a school.

    Parameters
    ----------
    school
        An ellipsoid with axes along those of ``map``.
    position : (3,) array
        Common start of the lines, m.
    ways : (n, 3) array
        Unit vectors along the lines.

    Returns
    -------
    near, far : (n,) arrays
        Distances, m, negative behind the start; infinite for lines that miss the school.
    """
    start = 2 * (position - school.position) / school.size
    move = 2 * ways / school.size
    a, b, c = (move**2).sum(1), move @ start, start @ start - 1
    root = b * b - a * c
    met = root > 0
    half = np.sqrt(np.where(met, root, 0.0))
    return np.where(met, (-b - half) / a, np.inf), np.where(met, (-b + half) / a, np.inf)


def fish_in(school: SchoolTruth) -> float:
    """Return the number of fish in a school."""
    return school.density * math.pi / 6 * float(np.prod(school.size))
