"""One pass over the nodes of a gear: knots, floats and weights (eq. 22, 28) and their slopes."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.bar import STILL
from trawl_ros.model.bar_pass import WaterTable
from trawl_ros.model.compiled import compiled
from trawl_ros.model.current import current_at


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
    density, gradient, gravity, knots, cubics = water
    flow, shear = np.empty(3, x.dtype), np.empty(3)
    for n in range(len(force)):
        here = density - gradient * x[n, 2]
        current_at(knots, cubics, x[n, 2], flow, shear)
        square = STILL**2 + 0 * here
        for i in range(3):
            flow[i] -= v[n, i]
            square += flow[i] ** 2
        speed = np.sqrt(square)
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
    density, gradient, gravity, knots, cubics = water
    flow, shear = np.empty(3), np.empty(3)
    stiffness[:] = 0.0
    for n in range(len(stiffness)):
        here = density - gradient * x[n, 2]
        current_at(knots, cubics, x[n, 2], flow, shear)
        square = STILL**2
        for i in range(3):
            flow[i] -= v[n, i]
            square += flow[i] ** 2
        speed = np.sqrt(square)
        viscous = viscous_area[n] * np.sqrt(speed)
        factor = 0.5 * here * (drag_area[n] * speed + viscous)
        # Slope of this factor by the flow, over the flow.
        growth = 0.5 * here * (drag_area[n] * speed + 0.5 * viscous) / square
        for i in range(3):
            by_height = -gradient / here * factor * flow[i]
            for j in range(3):
                by_flow = factor * (i == j) + growth * flow[i] * flow[j]
                damping[n, i, j] = by_flow
                by_height += by_flow * shear[j]
            stiffness[n, i, 2] = -by_height
        stiffness[n, 2, 2] += gravity * gradient * volume[n]
