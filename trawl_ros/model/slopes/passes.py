# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Passes over bars: derivatives of forces and of M a, the force that accelerates them; compiled.

Ends, properties, water and slots are those of `trawl_ros.model.bar_pass`. The ropes at blocks and
boards are a `BarGroup`, whose points are numbered as in `trawl_ros.model.gear_model`; they take one
complex step per direction, all of them in one pass.
"""

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.model.bar import mass_at
from trawl_ros.model.bar_pass import WaterTable, add_bar_forces
from trawl_ros.model.compiled import compiled, njit_device
from trawl_ros.model.numerics import STEP


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
    """Add half of the bars' mass times the acceleration of the points (p, 3) at both ends.

    The mass includes the added mass.
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
    """Add the derivatives of `add_bar_inertia` by the positions, for the plain bars ``wanted``.

    As a bar of vector r and unit vector t turns, its added mass changes by that of t tᵀ a:
    ∂(t tᵀ a)/∂r = (t aᵀ + (t · a) I - 2 (t · a) t tᵀ) / |r|.
    """
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
                # Added mass goes with the density, which falls with the mean height of both ends.
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


@njit_device
def _step_lengths(
    sides: IntArray, lengths: FloatArray, segments: float, values: FloatArray, there: FloatArray
) -> None:
    """Fill in the values of bars with a complex step along those of their warps (2,)."""
    for n in range(len(values)):
        longer = lengths[sides[n]] / segments if sides[n] >= 0 else 0.0
        there[n] = values[n] + 1j * STEP * longer


@njit_device
def _add_gathered(
    points: IntArray,
    arms: FloatArray,
    total: FloatArray,
    sign: float,
    into: FloatArray,
    column: int,
) -> None:
    """Add the derivatives of generalised forces to a column, from stepped loads (p, 3) of points.

    ``arms`` (2, 3, 3) to the fastening points have a complex step too.
    """
    count = (len(into) - 12) // 3
    for k in range(len(points)):
        point, load = points[k], total[k]
        if point < count:
            for i in range(3):
                into[3 * point + i, column] += sign * load[i].imag / STEP
        elif point < count + 6:
            side, own = (point - count) // 3, (point - count) % 3
            arm, first = arms[side, own], 3 * count + 6 * side
            for i in range(3):
                j1, j2 = (i + 1) % 3, (i + 2) % 3
                moment = arm[j1] * load[j2] - arm[j2] * load[j1]
                into[first + i, column] += sign * load[i].imag / STEP
                into[first + 3 + i, column] += sign * moment.imag / STEP


@compiled
def add_warp_forces(
    points: IntArray,
    ends: IntArray,
    sides: IntArray,
    segments: float,
    x: FloatArray,
    v: FloatArray,
    arms: FloatArray,
    rest: FloatArray,
    rest_rate: FloatArray,
    bars: tuple[FloatArray, ...],
    water: WaterTable,
    boundary: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    into: FloatArray,
) -> None:
    """Add the derivatives of the forces by the towing boundary to those ``into`` (dof, m).

    Parameters
    ----------
    points, ends, sides, segments
        Points (p,), ends (k, 2) among them and warps (k,) of bars, and the bars of a warp.
    x, v, arms
        Positions and velocities (p, 3), and arms (2, 3, 3) of the fastening points.
    rest, rest_rate, bars
        Unstretched lengths (k,) of the bars, their rates, and properties.
    boundary
        Derivatives in the order of `TowSlopes`.
    """
    blocks, block_velocities, lengths, length_rates = boundary
    hung = (len(into) - 12) // 3 + 6
    there, speed, total = np.empty((3, len(points), 3), np.complex128)
    lever = arms + 0j
    cut, cut_rate = np.empty((2, len(rest)), np.complex128)
    for column in range(into.shape[1]):
        moving = False
        for side in range(2):
            moving = moving or lengths[column, side] != 0.0 or length_rates[column, side] != 0.0
            for i in range(3):
                moving = moving or blocks[column, side, i] != 0.0
                moving = moving or block_velocities[column, side, i] != 0.0
        if not moving:
            continue
        for k in range(len(points)):
            for i in range(3):
                there[k, i], speed[k, i], total[k, i] = x[k, i], v[k, i], 0.0
                if points[k] >= hung:
                    there[k, i] += 1j * STEP * blocks[column, points[k] - hung, i]
                    speed[k, i] += 1j * STEP * block_velocities[column, points[k] - hung, i]
        _step_lengths(sides, lengths[column], segments, rest, cut)
        _step_lengths(sides, length_rates[column], segments, rest_rate, cut_rate)
        add_bar_forces(ends, there, speed, cut, cut_rate, bars, water, total)
        _add_gathered(points, lever, total, 1.0, into, column)


@compiled
def subtract_inertia(
    points: IntArray,
    ends: IntArray,
    sides: IntArray,
    segments: float,
    x: FloatArray,
    arms: FloatArray,
    rest: FloatArray,
    bars: tuple[FloatArray, ...],
    water: WaterTable,
    body_masses: FloatArray,
    acceleration: FloatArray,
    nodes: FloatArray,
    boards: FloatArray,
    blocks: FloatArray,
    lengths: FloatArray,
    into: FloatArray,
) -> None:
    """Subtract the derivatives of M a of these bars and of both boards from ``into`` (dof, m).

    Parameters
    ----------
    points, ends, sides, segments, x, arms, rest, bars
        As in `add_warp_forces`.
    body_masses
        Added mass and inertia (2, 2, 3, 3) of both boards in fixed axes.
    acceleration
        Generalised acceleration (dof,), held.
    nodes, boards, blocks, lengths
        Directions of `RiggingDirections`.
    """
    count = (len(into) - 12) // 3
    there, held, total = np.empty((3, len(points), 3), np.complex128)
    lever, cut = np.empty(arms.shape, np.complex128), np.empty(len(rest), np.complex128)
    move, turn, pull, turned = np.empty((4, 3))
    for column in range(into.shape[1]):
        for side in range(2):
            for own in range(3):
                for i in range(3):
                    j1, j2 = (i + 1) % 3, (i + 2) % 3
                    turn[:] = boards[6 * side + 3 : 6 * side + 6, column]
                    across = turn[j1] * arms[side, own, j2] - turn[j2] * arms[side, own, j1]
                    lever[side, own, i] = arms[side, own, i] + 1j * STEP * across
        row = 0
        for k in range(len(points)):
            point = points[k]
            for i in range(3):
                there[k, i], held[k, i], total[k, i] = x[k, i], 0.0, 0.0
                if point < count:
                    there[k, i] += 1j * STEP * nodes[row, column]
                    held[k, i] = acceleration[3 * point + i]
                    row += 1
                elif point < count + 6:
                    side, own = (point - count) // 3, (point - count) % 3
                    j1, j2, at = (i + 1) % 3, (i + 2) % 3, 6 * side
                    arm, body = lever[side, own], acceleration[3 * count + at : 3 * count + at + 6]
                    there[k, i] += 1j * STEP * boards[at + i, column] + (arm[i] - arm[i].real)
                    held[k, i] = body[i] + body[3 + j1] * arm[j2] - body[3 + j2] * arm[j1]
                else:
                    there[k, i] += 1j * STEP * blocks[column, point - count - 6, i]
        _step_lengths(sides, lengths[column], segments, rest, cut)
        add_bar_inertia(ends, there, held, cut, bars, water, total)
        _add_gathered(points, lever, total, -1.0, into, column)
        for side in range(2):
            for part in range(2):
                mass, first = body_masses[side, part], 3 * count + 6 * side + 3 * part
                own_turn = boards[6 * side + 3 : 6 * side + 6, column]
                for i in range(3):
                    move[i], turn[i] = acceleration[first + i], own_turn[i]
                # M turns with the board: its change by δθ is S(δθ) M - M S(δθ).
                _times(mass, move, pull)
                for i in range(3):
                    j1, j2 = (i + 1) % 3, (i + 2) % 3
                    turned[i] = turn[j1] * move[j2] - turn[j2] * move[j1]
                    into[first + i, column] -= turn[j1] * pull[j2] - turn[j2] * pull[j1]
                _times(mass, turned, pull)
                for i in range(3):
                    into[first + i, column] += pull[i]


@njit_device
def _times(matrix: FloatArray, vector: FloatArray, product: FloatArray) -> None:
    for i in range(3):
        product[i] = 0.0
        for j in range(3):
            product[i] += matrix[i, j] * vector[j]
