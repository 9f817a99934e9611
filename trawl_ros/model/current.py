# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Current of the water at a height, for compiled loops."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.compiled import compiled, njit_device


@njit_device
def current_at(
    knots: FloatArray, cubics: FloatArray, z: float, flow: FloatArray, slope: FloatArray
) -> None:
    """Fill in the current (3,) at one height and its derivative by height, from `Water.profile`."""
    depth, place = -z.real, 0
    inside = knots[0] < depth < knots[-1]
    while place + 1 < len(knots) and knots[place + 1] <= depth:
        place += 1
    along = depth - knots[place] if inside else 0.0
    for axis in range(2):
        c3, c2 = cubics[place, axis, 0], cubics[place, axis, 1]
        c1, c0 = cubics[place, axis, 2], cubics[place, axis, 3]
        slope[axis] = -((3.0 * c3 * along + 2.0 * c2) * along + c1) if inside else 0.0
        flow[axis] = ((c3 * along + c2) * along + c1) * along + c0 + slope[axis] * (z - z.real)
    flow[2] = slope[2] = 0.0


@compiled
def fill_currents(
    knots: FloatArray, cubics: FloatArray, z: FloatArray, flow: FloatArray, slope: FloatArray
) -> None:
    """Fill in currents (n, 3) at heights (n,) and their derivatives by height."""
    for n in range(len(z)):
        current_at(knots, cubics, z[n], flow[n], slope[n])


@compiled
def fill_cubics(depths: FloatArray, currents: FloatArray, cubics: FloatArray) -> None:
    """Fill in cubics (k - 1, 2, 4) of currents (k, 2) between k ≥ 2 depths.

    They are the monotone PCHIP of Fritsch and Butland (1984), as in scipy. Scipy's interpolator
    takes 0.1 ms to build, which is too slow where each iteration changes the current.
    """
    last = len(depths) - 1
    wide = np.diff(depths)
    for axis in range(2):
        steep = (currents[1:, axis] - currents[:-1, axis]) / wide
        slope = np.zeros(last + 1)
        for k in range(1, last):
            before, behind = steep[k - 1], steep[k]
            if before * behind > 0.0:
                first, second = 2.0 * wide[k] + wide[k - 1], wide[k] + 2.0 * wide[k - 1]
                slope[k] = (first + second) / (first / before + second / behind)
        if last == 1:
            slope[:] = steep[0]
        else:
            slope[0] = _end_slope(wide[0], wide[1], steep[0], steep[1])
            slope[last] = _end_slope(wide[-1], wide[-2], steep[-1], steep[-2])
        for k in range(last):
            bend = (slope[k] + slope[k + 1] - 2.0 * steep[k]) / wide[k]
            cubics[k, axis, 0] = bend / wide[k]
            cubics[k, axis, 1] = (steep[k] - slope[k]) / wide[k] - bend
            cubics[k, axis, 2] = slope[k]
            cubics[k, axis, 3] = currents[k, axis]


@njit_device
def _end_slope(wide: float, next_wide: float, steep: float, next_steep: float) -> float:
    """Return the slope at an end: that of the parabola through three points, if monotone."""
    slope = ((2.0 * wide + next_wide) * steep - wide * next_steep) / (wide + next_wide)
    if np.sign(slope) != np.sign(steep):
        return 0.0
    if np.sign(steep) != np.sign(next_steep) and abs(slope) > 3.0 * abs(steep):
        return 3.0 * steep
    return slope
