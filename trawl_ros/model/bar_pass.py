# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One pass over the bars of a gear: forces, derivatives and masses, summed up where they act.

Ends of bars are numbered as in `trawl_ros.model.gear_model`; properties of bars are
`BarProperties.columns`, those of the water `water_of`. Slots are those of the pattern, 36 for each
plain bar; the caller rotates and places the 6 × 6 blocks of the other bars.

Both loops over forces begin with the same lines. A common function for them would take all these
arrays; it made `forces` 1.8 times as slow.
"""

from typing import TypeAlias

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.bar import (
    SLACKEST_STRAIGHT,
    between,
    drag_at,
    load_slopes_at,
    mass_at,
    pull_slopes_at,
    spanned_at,
    tension_at,
    weight_at,
)
from trawl_ros.model.compiled import compiled
from trawl_ros.model.current import current_at
from trawl_ros.model.water import Water

WaterTable: TypeAlias = tuple[float, float, float, FloatArray, FloatArray]


def water_of(water: Water) -> WaterTable:
    """Return the water for compiled loops: density, its gradient, gravity, profile of currents."""
    return (
        float(water.density),
        float(water.density_gradient),
        float(water.gravity),
        *water.profile,
    )


@compiled
def add_bar_forces(
    ends: IntArray,
    x: FloatArray,
    v: FloatArray,
    rest: FloatArray,
    rest_rate: FloatArray,
    bars: tuple[FloatArray, ...],
    water: WaterTable,
    total: FloatArray,
) -> None:
    """Add the tension of the bars, and half of their load, to the points (p, 3) at both ends."""
    stiffness, damping_time, mass, volume, normal_area, wet_area, normal_drag, friction = bars[:8]
    bow, normal_viscous, friction_viscous = bars[10:]
    density, gradient, gravity, knots, cubics = water
    vector, stretching, velocity = np.empty(3, x.dtype), np.empty(3, x.dtype), np.empty(3, x.dtype)
    along, flow, load = np.empty(3, x.dtype), np.empty(3, x.dtype), np.empty(3, x.dtype)
    shear = np.empty(3)
    for n in range(len(ends)):
        start, end = ends[n, 0], ends[n, 1]
        height = between(x, v, start, end, vector, stretching, velocity)
        force, _ = tension_at(
            stiffness[n], damping_time[n], bow[n], vector, stretching, rest[n], rest_rate[n], along
        )
        here = density - gradient * height
        current_at(knots, cubics, height, flow, shear)
        for i in range(3):
            flow[i] -= velocity[i]
        spanned = spanned_at(vector, rest[n])
        areas = spanned * normal_drag[n] * normal_area[n], friction[n] * wet_area[n]
        viscous = normal_viscous[n], friction_viscous[n]
        drag_at(areas[0], areas[1], viscous[0], viscous[1], rest[n], here, flow, along, load)
        load[2] += weight_at(mass[n], volume[n], rest[n], here, gravity)
        for i in range(3):
            total[start, i] += force * along[i] + 0.5 * load[i]
            total[end, i] += 0.5 * load[i] - force * along[i]


@compiled
def add_bar_blocks(
    ends: IntArray,
    order: IntArray,
    x: FloatArray,
    v: FloatArray,
    rest: FloatArray,
    rest_rate: FloatArray,
    bars: tuple[FloatArray, ...],
    water: WaterTable,
    slots: IntArray,
    total: FloatArray,
    stiffness_data: FloatArray,
    damping_data: FloatArray,
    k_others: FloatArray,
    c_others: FloatArray,
    start_force: FloatArray,
) -> None:
    """Add forces as `add_bar_forces` does, with K = -∂F/∂q and C = -∂F/∂v of the bars.

    ``order`` has the plain bars first, whose blocks are added to the data of both matrices. For
    the r other bars the blocks (r, 6, 6) and the forces (r, 3) at their starts are filled in.
    """
    stiffness, damping_time, mass, volume, normal_area, wet_area, normal_drag, friction = bars[:8]
    bow, normal_viscous, friction_viscous = bars[10:]
    density, gradient, gravity, knots, cubics = water
    plain = len(order) - len(k_others)
    vector, stretching, velocity = np.empty(3), np.empty(3), np.empty(3)
    along, flow, load = np.empty(3), np.empty(3), np.empty(3)
    shear, by_height, own = np.empty(3), np.empty(3), np.empty(3)
    by_vector, by_stretching = np.empty((3, 3)), np.empty((3, 3))
    load_by_vector, load_by_velocity = np.empty((3, 3)), np.empty((3, 3))
    k, c = np.empty((6, 6)), np.empty((6, 6))
    for number in range(len(order)):
        n = order[number]
        start, end = ends[n, 0], ends[n, 1]
        height = between(x, v, start, end, vector, stretching, velocity)
        force, slope = tension_at(
            stiffness[n], damping_time[n], bow[n], vector, stretching, rest[n], rest_rate[n], along
        )
        here = density - gradient * height
        current_at(knots, cubics, height, flow, shear)
        for i in range(3):
            flow[i] -= velocity[i]
        spanned = spanned_at(vector, rest[n])
        areas = spanned * normal_drag[n] * normal_area[n], friction[n] * wet_area[n]
        viscous = normal_viscous[n], friction_viscous[n]
        drag_at(areas[0], areas[1], viscous[0], viscous[1], rest[n], here, flow, along, load)
        pull_slopes_at(
            stiffness[n],
            damping_time[n],
            slope,
            vector,
            stretching,
            rest[n],
            rest_rate[n],
            force,
            along,
            by_vector,
            by_stretching,
        )
        load_slopes_at(
            areas[0],
            areas[1],
            viscous[0],
            viscous[1],
            rest[n],
            here,
            flow,
            vector,
            along,
            load_by_vector,
            load_by_velocity,
        )
        if spanned < 1.0:
            # The normal drag of a slack bar goes with the distance of its ends.
            whole = normal_drag[n] * normal_area[n] / SLACKEST_STRAIGHT
            drag_at(whole, 0.0, viscous[0], 0.0, 1.0, here, flow, along, own)
            for i in range(3):
                for j in range(3):
                    load_by_vector[i, j] += own[i] * along[j]
        for i in range(3):
            by_height[i] = -gradient / here * load[i]
            for j in range(3):
                by_height[i] -= load_by_velocity[i, j] * shear[j]
        by_height[2] -= gravity * gradient * volume[n] * rest[n]
        load[2] += weight_at(mass[n], volume[n], rest[n], here, gravity)
        for i in range(3):
            total[start, i] += force * along[i] + 0.5 * load[i]
            total[end, i] += 0.5 * load[i] - force * along[i]
            for j in range(3):
                pull, turned = by_vector[i, j], 0.5 * load_by_vector[i, j]
                # Each end contributes half of the bar's mean height and velocity.
                sunk = 0.25 * by_height[i] if j == 2 else 0.0
                k[i, j] = pull + turned - sunk
                k[i, 3 + j] = -pull - turned - sunk
                k[3 + i, j] = -pull + turned - sunk
                k[3 + i, 3 + j] = pull - turned - sunk
                damp, slowed = by_stretching[i, j], 0.25 * load_by_velocity[i, j]
                c[i, j] = c[3 + i, 3 + j] = damp - slowed
                c[i, 3 + j] = c[3 + i, j] = -damp - slowed
        if number < plain:
            at = 36 * number
            for i in range(6):
                for j in range(6):
                    stiffness_data[slots[at]] += k[i, j]
                    damping_data[slots[at]] += c[i, j]
                    at += 1
        else:
            for i in range(6):
                for j in range(6):
                    k_others[number - plain, i, j] = k[i, j]
                    c_others[number - plain, i, j] = c[i, j]
            for i in range(3):
                start_force[number - plain, i] = force * along[i] + 0.5 * load[i]


@compiled
def add_bar_masses(
    ends: IntArray,
    order: IntArray,
    x: FloatArray,
    rest: FloatArray,
    bars: tuple[FloatArray, ...],
    water: WaterTable,
    slots: IntArray,
    data: FloatArray,
    others: FloatArray,
) -> None:
    """Add half of the mass of the plain bars at either end, as `add_bar_blocks` does.

    For the r other bars one half (r, 3, 3) is filled in.
    """
    mass, volume, added_normal, added_tangential = bars[2], bars[3], bars[8], bars[9]
    plain = len(order) - len(others)
    vector, matrix = np.empty(3), np.empty((3, 3))
    for number in range(len(order)):
        n = order[number]
        start, end = ends[n, 0], ends[n, 1]
        for i in range(3):
            vector[i] = x[end, i] - x[start, i]
        height = 0.5 * (x[start, 2] + x[end, 2])
        displaced = 0.5 * (water[0] - water[1] * height) * volume[n] * rest[n]
        normal, tangential = displaced * added_normal[n], displaced * added_tangential[n]
        mass_at(0.5 * mass[n] * rest[n], normal, tangential, vector, matrix)
        if number < plain:
            for i in range(3):
                for j in range(3):
                    data[slots[36 * number + 6 * i + j]] += matrix[i, j]
                    data[slots[36 * number + 6 * (3 + i) + 3 + j]] += matrix[i, j]
        else:
            for i in range(3):
                for j in range(3):
                    others[number - plain, i, j] = matrix[i, j]
