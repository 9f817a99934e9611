"""One pass over bars for M a, the force that accelerates them, and its slopes; compiled.

Ends, properties, water and slots are those of `trawl_ros.model.bar_pass`.
"""

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.model.bar import mass_at
from trawl_ros.model.bar_pass import WaterTable
from trawl_ros.model.compiled import compiled


@compiled
def add_bar_inertia(
    ends: IntArray,
    x: FloatArray,
    a: FloatArray,
    rest: FloatArray,
    bars: tuple[FloatArray, ...],
    water: WaterTable,
    total: FloatArray,
) -> None:
    """Add to the points (p, 3) at both ends of the bars half of their mass, with the added one,
    times the point's acceleration.
    """
    mass, volume, added_normal, added_tangential = bars[2], bars[3], bars[8], bars[9]
    vector, matrix = np.empty(3, x.dtype), np.empty((3, 3), x.dtype)
    for n in range(len(ends)):
        start, end = ends[n, 0], ends[n, 1]
        for i in range(3):
            vector[i] = x[end, i] - x[start, i]
        height = 0.5 * (x[start, 2] + x[end, 2])
        displaced = 0.5 * (water[0] - water[1] * height) * volume[n] * rest[n]
        normal, tangential = displaced * added_normal[n], displaced * added_tangential[n]
        mass_at(0.5 * mass[n] * rest[n], normal, tangential, vector, matrix)
        for i in range(3):
            for j in range(3):
                total[start, i] += matrix[i, j] * a[start, j]
                total[end, i] += matrix[i, j] * a[end, j]


@compiled
def add_bar_inertia_slopes(
    ends: IntArray,
    plain: IntArray,
    wanted: BoolArray,
    x: FloatArray,
    a: FloatArray,
    rest: FloatArray,
    bars: tuple[FloatArray, ...],
    water: WaterTable,
    slots: IntArray,
    data: FloatArray,
) -> None:
    """Add the slopes of that by the positions of both ends, for the plain bars that are wanted."""
    volume, added_normal, added_tangential = bars[3], bars[8], bars[9]
    along = np.empty(3)
    for number in range(len(plain)):
        n = plain[number]
        if not wanted[n]:
            continue
        start, end = ends[n, 0], ends[n, 1]
        square = 0.0
        for i in range(3):
            along[i] = x[end, i] - x[start, i]
            square += along[i] ** 2
        span = np.sqrt(square)
        for i in range(3):
            along[i] /= span
        density = water[0] - water[1] * 0.5 * (x[start, 2] + x[end, 2])
        displaced = 0.5 * density * volume[n] * rest[n]
        more = displaced * (added_tangential[n] - added_normal[n])
        for side in range(2):
            point = end if side else start
            share = 0.0
            for i in range(3):
                share += along[i] * a[point, i]
            for i in range(3):
                # Added mass falls with the density, and that with the mean height of both ends.
                sunk = displaced * added_normal[n] * a[point, i] + more * share * along[i]
                sunk *= -0.5 * water[1] / density
                for j in range(3):
                    turned = along[i] * (a[point, j] - 2.0 * share * along[j])
                    if i == j:
                        turned += share
                    turned *= more / span
                    at = 36 * number + 6 * (3 * side + i) + j
                    data[slots[at]] -= turned
                    data[slots[at + 3]] += turned
                data[slots[36 * number + 6 * (3 * side + i) + 2]] += sunk
                data[slots[36 * number + 6 * (3 * side + i) + 5]] += sunk
