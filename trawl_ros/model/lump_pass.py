# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One pass over the nodes of a gear: lumps, sheets of netting, and their derivatives.

Lumps are knots, floats and weights (eq. 22, 28). The lift of a sheet by its solidity is added to
the loads of its bars. With the area a of the sheet of a node (a vector normal to it), its twine A,
the flow u and the coefficient κ,

    F = ½ ρ κ A² / (|a|² + A²) (u · a / |a|) (|u| a - (a · u) u / |u|)

is a load across the flow of ½ ρ κ S² / (1 + S²) |a| |u|² sin θ cos θ, with the solidity
S = A / |a|. The area is d₁ × d₂. Both sides d are weighted sums of the positions of the node and of
its neighbours, so that its derivatives lie on the pattern of the bars.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.bar import SPEED_ROUNDING_M_S
from trawl_ros.model.bar_pass import WaterTable
from trawl_ros.model.compiled import compiled, njit_device
from trawl_ros.model.current import current_at

MIN_SHEET_AREA_M2 = 1e-4
"""Area below which that of a sheet is rounded off, so that its direction has a derivative."""


@njit_device
def flow_past(
    x: FloatArray, v: FloatArray, n: int, water: WaterTable, flow: FloatArray, shear: FloatArray
) -> float:
    """Fill in the flow (3,) past a node and its change with height; return its rounded square."""
    current_at(water[3], water[4], x[n, 2], flow, shear)
    square: float = SPEED_ROUNDING_M_S**2 + 0 * x[n, 2]
    for i in range(3):
        flow[i] -= v[n, i]
        square += flow[i] ** 2
    return square


@compiled
def fill_lump_forces(
    x: FloatArray,
    v: FloatArray,
    mass: FloatArray,
    volume: FloatArray,
    drag_area: FloatArray,
    viscous_area: FloatArray,
    water: WaterTable,
    force: FloatArray,
) -> None:
    """Fill in drag, weight and buoyancy (n, 3) of the lumps."""
    density, gradient, gravity, _, _ = water
    flow, shear = np.empty(3, x.dtype), np.empty(3)
    for n in range(len(force)):
        here = density - gradient * x[n, 2]
        speed = np.sqrt(flow_past(x, v, n, water, flow, shear))
        factor = 0.5 * here * (drag_area[n] * speed + viscous_area[n] * np.sqrt(speed))
        for i in range(3):
            force[n, i] = factor * flow[i]
        force[n, 2] -= (mass[n] - here * volume[n]) * gravity


@compiled
def fill_lump_slopes(
    x: FloatArray,
    v: FloatArray,
    volume: FloatArray,
    drag_area: FloatArray,
    viscous_area: FloatArray,
    water: WaterTable,
    stiffness: FloatArray,
    damping: FloatArray,
) -> None:
    """Fill in K = -∂F/∂x and C = -∂F/∂v (n, 3, 3) of the lumps."""
    density, gradient, gravity, _, _ = water
    flow, shear = np.empty(3), np.empty(3)
    stiffness[:] = 0.0
    for n in range(len(stiffness)):
        here = density - gradient * x[n, 2]
        square = flow_past(x, v, n, water, flow, shear)
        speed = np.sqrt(square)
        viscous = viscous_area[n] * np.sqrt(speed)
        factor = 0.5 * here * (drag_area[n] * speed + viscous)
        # Derivative of this factor by the flow, over the flow.
        growth = 0.5 * here * (drag_area[n] * speed + 0.5 * viscous) / square
        for i in range(3):
            by_height = -gradient / here * factor * flow[i]
            for j in range(3):
                by_flow = factor * (i == j) + growth * flow[i] * flow[j]
                damping[n, i, j] = by_flow
                by_height += by_flow * shear[j]
            stiffness[n, i, 2] = -by_height
        stiffness[n, 2, 2] += gravity * gradient * volume[n]


@njit_device
def area_at(
    x: FloatArray,
    around: IntArray,
    weights: FloatArray,
    n: int,
    long: FloatArray,
    wide: FloatArray,
    area: FloatArray,
) -> None:
    """Fill in both sides (3,) of the n-th sheet and its area (3,)."""
    long[:], wide[:] = 0.0, 0.0
    for m in range(around.shape[1]):
        node, first, second = around[n, m], weights[n, 0, m], weights[n, 1, m]
        for i in range(3):
            long[i] += first * x[node, i]
            wide[i] += second * x[node, i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        area[i] = long[j] * wide[k] - long[k] * wide[j]


@compiled
def add_sheet_forces(
    x: FloatArray,
    v: FloatArray,
    around: IntArray,
    weights: FloatArray,
    lift: FloatArray,
    twine: FloatArray,
    water: WaterTable,
    total: FloatArray,
) -> None:
    """Add the lift of sheets to their own nodes ``around[:, 0]``."""
    density, gradient, _, _, _ = water
    flow, shear = np.empty(3, x.dtype), np.empty(3)
    long, wide, area = np.empty(3, x.dtype), np.empty(3, x.dtype), np.empty(3, x.dtype)
    for n in range(len(around)):
        node = around[n, 0]
        area_at(x, around, weights, n, long, wide, area)
        square = flow_past(x, v, node, water, flow, shear)
        through = 0 * x[node, 2]
        size = MIN_SHEET_AREA_M2**2 + through
        for i in range(3):
            through += flow[i] * area[i]
            size += area[i] ** 2
        speed, size = np.sqrt(square), np.sqrt(size)
        solidity = twine[n] ** 2 / (size**2 + twine[n] ** 2)
        scale = 0.5 * (density - gradient * x[node, 2]) * lift[n] * solidity * through / size
        for i in range(3):
            total[node, i] += scale * (speed * area[i] - through / speed * flow[i])


@compiled
def add_sheet_slopes(
    x: FloatArray,
    v: FloatArray,
    around: IntArray,
    weights: FloatArray,
    lift: FloatArray,
    twine: FloatArray,
    water: WaterTable,
    slots: IntArray,
    total: FloatArray,
    stiffness_data: FloatArray,
    damping_data: FloatArray,
) -> None:
    """Add lift as `add_sheet_forces` does, with K = -∂F/∂x and C = -∂F/∂v of the sheets.

    ``slots`` (n, m, 3, 3) are those of the blocks of the own node's force by the positions of all
    nodes around it.
    """
    density, gradient, _, _, _ = water
    flow, shear, force = np.empty(3), np.empty(3), np.empty(3)
    long, wide, area = np.empty(3), np.empty(3), np.empty(3)
    by_area, by_flow, turned = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    for n in range(len(around)):
        node = around[n, 0]
        area_at(x, around, weights, n, long, wide, area)
        here = density - gradient * x[node, 2]
        square = flow_past(x, v, node, water, flow, shear)
        through, size = 0.0, MIN_SHEET_AREA_M2**2
        for i in range(3):
            through += flow[i] * area[i]
            size += area[i] ** 2
        speed, size = np.sqrt(square), np.sqrt(size)
        square_sum = size**2 + twine[n] ** 2
        scale = 0.5 * here * lift[n] * twine[n] ** 2 / square_sum
        # F = scale (p a - q u)
        p, q = through * speed / size, through**2 / (size * speed)
        for i in range(3):
            force[i] = scale * (p * area[i] - q * flow[i])
            total[node, i] += force[i]
            for j in range(3):
                p_area = speed / size * flow[j] - p / size**2 * area[j]
                q_area = 2.0 * through / (size * speed) * flow[j] - q / size**2 * area[j]
                p_flow = speed / size * area[j] + through / (size * speed) * flow[j]
                q_flow = 2.0 * through / (size * speed) * area[j] - q / square * flow[j]
                by_area[i, j] = scale * (p * (i == j) + area[i] * p_area - flow[i] * q_area)
                by_area[i, j] -= 2.0 * force[i] * area[j] / square_sum
                by_flow[i, j] = scale * (area[i] * p_flow - flow[i] * q_flow - q * (i == j))
        for m in range(around.shape[1]):
            first, second = weights[n, 0, m], weights[n, 1, m]
            if first == 0.0 and second == 0.0:
                continue
            # The area changes by turned × dx.
            for i in range(3):
                turned[i] = second * long[i] - first * wide[i]
            for i in range(3):
                a, b, c = by_area[i, 0], by_area[i, 1], by_area[i, 2]
                stiffness_data[slots[n, m, i, 0]] -= b * turned[2] - c * turned[1]
                stiffness_data[slots[n, m, i, 1]] -= c * turned[0] - a * turned[2]
                stiffness_data[slots[n, m, i, 2]] -= a * turned[1] - b * turned[0]
        for i in range(3):
            by_height = -gradient / here * force[i]
            for j in range(3):
                by_height += by_flow[i, j] * shear[j]
                damping_data[slots[n, 0, i, j]] += by_flow[i, j]
            stiffness_data[slots[n, 0, i, 2]] -= by_height
