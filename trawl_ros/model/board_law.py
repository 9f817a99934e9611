# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The law of the otter board (eq. 1-4, 12-14, 19), compiled, one board after another.

Arrays are those of `trawl_ros.model.board`, flattened to ``n`` boards. Numbers are complex, for
the complex step. There are only two boards: a second compiled form for real numbers would take
longer to compile than it saves.
"""

from math import atan2, cos, radians

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.bar_pass import WaterTable
from trawl_ros.model.compiled import compiled, njit_device
from trawl_ros.model.current import current_at
from trawl_ros.model.numerics import ROOT_FLOOR

LAW_RANGE = (0.0, radians(40.0))
"""Attack angles (rad) for which eq. 14 holds unchanged."""

LAW_FADED_RAD = (radians(-40.0), radians(90.0))
"""Attack angles below and above `LAW_RANGE` at which lift and moments have faded to zero."""

SLIP_LIMIT_RAD = radians(40.0)
"""Slip angle beyond which its part of eq. 14 stays constant."""

LEAST_IN_PLANE_FRACTION = cos(SLIP_LIMIT_RAD) ** 2
"""Part of the squared flow in the board's x-y plane below which forces and moments fade.

There the flow runs along the span, and the attack angle is badly defined.
"""

ANGLE_ROUNDING_RAD = radians(4.0)
"""Width over which an angle becomes constant outside its range."""


@njit_device
def angle_at(y: float, x: float) -> float:
    """Return ``arctan2`` with the derivative along a complex step."""
    square = x.real**2 + y.real**2
    inverse = 1.0 / square if square > 0.0 else 0.0
    slope = x.real * (y - y.real) - y.real * (x - x.real)
    return atan2(y.real, x.real) + slope * inverse


@njit_device
def smooth_clip(value: float, low: float, high: float) -> float:
    """Saturate the angle smoothly: unchanged inside [low, high], constant well outside."""
    if value.real > high:
        if value.real - high < ANGLE_ROUNDING_RAD:
            return value - (value - high) ** 2 / (2 * ANGLE_ROUNDING_RAD)
        return 0 * value + high + ANGLE_ROUNDING_RAD / 2
    if value.real < low:
        if low - value.real < ANGLE_ROUNDING_RAD:
            return value + (value - low) ** 2 / (2 * ANGLE_ROUNDING_RAD)
        return 0 * value + low - ANGLE_ROUNDING_RAD / 2
    return value


@njit_device
def smoothstep_window(attack: float, low: float, high: float) -> float:
    """Return the fade factor of a law: 1 inside [low, high], smoothly 0 at `LAW_FADED_RAD`."""
    share = 0 * attack
    if attack.real > high:
        share = (attack - high) / (LAW_FADED_RAD[1] - high)
    elif attack.real < low:
        share = (attack - low) / (LAW_FADED_RAD[0] - low)
    if share.real > 1.0:
        share = 0 * attack + 1.0
    return 1.0 - share**2 * (3.0 - 2.0 * share)


@njit_device
def _folded(attack: float) -> float:
    """Return the attack angle for drag, which is the same for flow on either face."""
    if attack.real >= 0.0:
        return attack
    if attack.real > -ANGLE_ROUNDING_RAD:
        return attack * (1.0 + attack / ANGLE_ROUNDING_RAD)
    return -attack - ANGLE_ROUNDING_RAD


@njit_device
def _across(flow: FloatArray) -> float:
    """Return the fade factor of α, which vanishes where the flow runs along the span."""
    plane = flow[0] ** 2 + flow[1] ** 2
    part: float = plane / (plane + flow[2] ** 2 + ROOT_FLOOR) / LEAST_IN_PLANE_FRACTION
    return part * (2.0 - part) if part.real < 1.0 else 0 * part + 1.0


@compiled
def fill_coefficients(
    values: FloatArray, attack: FloatArray, slip: FloatArray, coefficients: FloatArray
) -> None:
    """Fill in the coefficients (n, 6) of eq. 14, with the range of its angles bounded."""
    a1, c1, a2, c2, b3, c3 = values[0], values[1], values[2], values[3], values[4], values[5]
    a4, c4, b5, c5, a6, c6 = values[6], values[7], values[8], values[9], values[10], values[11]
    for n in range(len(attack)):
        fade = smoothstep_window(attack[n], LAW_RANGE[0], LAW_RANGE[1])
        alpha = smooth_clip(attack[n], LAW_RANGE[0], LAW_RANGE[1])
        beta = smooth_clip(slip[n], -SLIP_LIMIT_RAD, SLIP_LIMIT_RAD)
        resistance = a1 * smooth_clip(_folded(attack[n]), LAW_RANGE[0], LAW_RANGE[1]) + c1
        # A negative drag would push the board forward.
        coefficients[n, 0] = resistance if resistance.real > 0.0 else 0 * resistance
        coefficients[n, 1] = (a2 * alpha + c2) * fade
        coefficients[n, 2] = b3 * beta * fade + c3
        coefficients[n, 3] = (a4 * alpha + c4) * fade
        coefficients[n, 4] = b5 * beta * fade + c5
        coefficients[n, 5] = (a6 * alpha + c6) * fade


@compiled
def fill_flow(
    middle: FloatArray,
    outward: FloatArray,
    rotation: FloatArray,
    water_less_velocity: FloatArray,
    rate: FloatArray,
    flow: FloatArray,
    attack: FloatArray,
    slip: FloatArray,
) -> None:
    """Fill in the flow (n, 3) in the outward frame and its angles (n,), eq. 1-4."""
    arm, relative = np.empty(3, flow.dtype), np.empty(3, flow.dtype)
    for n in range(len(flow)):
        turn, spin = rotation[n], rate[n]
        for i in range(3):
            arm[i] = turn[i, 0] * middle[n, 0] + turn[i, 2] * middle[n, 2]
            arm[i] += outward[n] * turn[i, 1] * middle[n, 1]
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            relative[i] = water_less_velocity[n, i] - (spin[j] * arm[k] - spin[k] * arm[j])
        for i in range(3):
            sign = outward[n] if i == 1 else 0 * outward[n] + 1.0
            flow[n, i] = sign * (
                turn[0, i] * relative[0] + turn[1, i] * relative[1] + turn[2, i] * relative[2]
            )
        attack[n] = angle_at(flow[n, 1], -flow[n, 0])
        slip[n] = angle_at(flow[n, 2], -flow[n, 0])


@compiled
def fill_loads(
    area: float,
    levers: FloatArray,
    density: FloatArray,
    flow: FloatArray,
    coefficients: FloatArray,
    force: FloatArray,
    moment: FloatArray,
) -> None:
    """Fill in force and moment (n, 3) in the outward frame (eq. 12).

    The paper's loads act along axes aft (with the flow), outward and down. These axes are
    left-handed, as the outward frame of the starboard board is. A half turn about y transforms one
    into the other, and the vector product of eq. 17 changes the sign of moments about x and z.
    """
    for n in range(len(flow)):
        across, down = flow[n, 0] ** 2 + flow[n, 1] ** 2, flow[n, 2] ** 2
        pressure = 0.5 * density[n] * area * (across + down) * _across(flow[n])
        c, plane = coefficients[n], np.sqrt(across + ROOT_FLOOR)
        # Drag along the flow in the board's x-y plane, lift across it.
        ahead, aside = flow[n, 0] / plane, flow[n, 1] / plane
        force[n, 0] = pressure * (c[0] * ahead + c[1] * aside)
        force[n, 1] = pressure * (c[0] * aside - c[1] * ahead)
        force[n, 2] = -pressure * c[2]
        moment[n, 0] = -pressure * c[3] * levers[0]
        moment[n, 1] = pressure * c[4] * levers[1]
        moment[n, 2] = -pressure * c[5] * levers[2]


@compiled
def fill_total(
    inertia: FloatArray,
    slowing: FloatArray,
    heavy: FloatArray,
    outward: FloatArray,
    rotation: FloatArray,
    rate: FloatArray,
    density: FloatArray,
    flow: FloatArray,
    force: FloatArray,
    moment: FloatArray,
    total: FloatArray,
) -> None:
    """Fill in the whole load (n, 6) in fixed axes, with weight and moments of a turning board.

    ``slowing`` (3,) is `Board.rotary_resistance`, ``heavy`` (n,) the weights in water.
    """
    turning, twist = np.empty(3, total.dtype), np.empty(3, total.dtype)
    spin = np.empty(3, total.dtype)
    for n in range(len(total)):
        turn, side = rotation[n], outward[n]
        speed = np.sqrt(flow[n, 0] ** 2 + flow[n, 1] ** 2 + flow[n, 2] ** 2 + ROOT_FLOOR)
        for i in range(3):
            # In the outward frame; a rate is an axial vector like a moment.
            along = turn[0, i] * rate[n, 0] + turn[1, i] * rate[n, 1] + turn[2, i] * rate[n, 2]
            turning[i] = along if i == 1 else side * along
        for i in range(3):
            # Rotation adds ω r / u to the attack angle of a strip at the distance r.
            twist[i] = moment[n, i] - 0.5 * density[n] * speed * slowing[i] * turning[i]
        for i in range(3):
            total[n, i] = turn[i, 0] * force[n, 0] + turn[i, 2] * force[n, 2]
            total[n, i] += side * turn[i, 1] * force[n, 1]
            # An axial vector is mirrored with the determinant of the reflection.
            total[n, 3 + i] = side * (turn[i, 0] * twist[0] + turn[i, 2] * twist[2])
            total[n, 3 + i] += turn[i, 1] * twist[1]
            spin[i] = 0 * speed
            for j in range(3):
                lever = turn[i, j] if j == 1 else side * turn[i, j]
                for k in range(3):
                    spin[i] += lever * inertia[j, k] * turning[k]
        total[n, 2] -= heavy[n]
        # Gyroscopic moment -ω × Iω.
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            total[n, 3 + i] -= rate[n, j] * spin[k] - rate[n, k] * spin[j]


@compiled
def fill_own_loads(
    mass: float,
    volume: float,
    area: float,
    levers: FloatArray,
    inertia: FloatArray,
    slowing: FloatArray,
    values: FloatArray,
    middle: FloatArray,
    outward: FloatArray,
    position: FloatArray,
    rotation: FloatArray,
    velocity: FloatArray,
    rate: FloatArray,
    water: WaterTable,
    total: FloatArray,
) -> None:
    """Fill in the whole load (n, 6) of boards from their motion, in all of the steps above."""
    surface_density, gradient, gravity, knots, cubics = water
    relative, flow = np.empty_like(position), np.empty_like(position)
    force, moment = np.empty_like(position), np.empty_like(position)
    density, attack = np.empty_like(outward), np.empty_like(outward)
    slip, heavy = np.empty_like(outward), np.empty_like(outward)
    coefficients, shear = np.empty_like(total), np.empty(3)
    for n in range(len(total)):
        density[n] = surface_density - gradient * position[n, 2]
        heavy[n] = (mass - density[n] * volume) * gravity
        current_at(knots, cubics, position[n, 2], relative[n], shear)
        for i in range(3):
            relative[n, i] -= velocity[n, i]
    fill_flow(middle, outward, rotation, relative, rate, flow, attack, slip)
    fill_coefficients(values, attack, slip, coefficients)
    fill_loads(area, levers, density, flow, coefficients, force, moment)
    fill_total(
        inertia, slowing, heavy, outward, rotation, rate, density, flow, force, moment, total
    )
