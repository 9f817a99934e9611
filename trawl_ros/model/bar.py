# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One straight bar: tension, drag, added mass and their derivatives (eq. 20-24, 26), compiled.

`trawl_ros.model.line` has tension and drag for arrays of bars, `trawl_ros.model.bar_pass` sums
everything over a gear. Vectors are arrays (3,); outputs are arrays to be filled in. Numbers are
real, or complex for a complex step in functions without derivatives.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.compiled import compiled, njit_device

SLACK_WIDTH = 1e-4
"""Half the range of strain over which the kink of eq. 20, from slack to taut, is rounded."""

SLACKEST_STRAIGHT = 1.0 - SLACK_WIDTH
"""Length over rest length above which a bar counts as straight: where the rounding ends."""

NEWTON_STEP_TOLERANCE = 1e-8
"""Relative step of Newton's method after which it ends.

Convergence is quadratic: the next step would be about its square, below rounding.
"""

SPEED_ROUNDING_M_S = 1e-6
"""Speed below which quadratic drag is rounded off, so that its derivative exists."""


@njit_device
def between(
    x: FloatArray,
    v: FloatArray,
    start: int,
    end: int,
    vector: FloatArray,
    stretching: FloatArray,
    velocity: FloatArray,
) -> float:
    """Fill in the motion of a bar between two points and return its mean height."""
    for i in range(3):
        vector[i] = x[end, i] - x[start, i]
        stretching[i] = v[end, i] - v[start, i]
        velocity[i] = 0.5 * (v[start, i] + v[end, i])
    height: float = 0.5 * (x[start, 2] + x[end, 2])
    return height


@njit_device
def bowed_at(strain: float, bow: float) -> tuple[float, float, float]:
    """Return the elastic strain of a bar that sags under a load across it, with two derivatives.

    The sag shortens the bar by (Q / T)² / 24 of its length, with the whole load Q and the tension
    T. So the elastic strain e = T / EA is the root of e - bow / e² = strain, bow = (Q / EA)² / 24.
    """
    # Start below the root: from there Newton's method converges monotonically.
    root, real = bow ** (1.0 / 3.0), strain.real
    e = max(real, root) if real > 0.0 else np.sqrt(bow / (root - real))
    step = e
    while step > NEWTON_STEP_TOLERANCE * e:
        square = e * e
        step = e * ((real - e) * square + bow) / (e * square + 2.0 * bow)
        e += step
    slope = 1.0 / (1.0 + 2.0 * bow / e**3)
    curve = 6.0 * bow / e**4 * slope**3
    # The imaginary part is a complex step: its first-order term is exact to rounding.
    imaginary = strain - strain.real
    return e + slope * imaginary, slope + curve * imaginary, curve


@njit_device
def taut_at(strain: float, bow: float) -> tuple[float, float, float]:
    """Return the elastic strain of a bar and its first two derivatives.

    It is the positive part of the strain with a rounded corner, or `bowed_at` if the bar sags.
    """
    if bow > 0.0:
        return bowed_at(strain, bow)
    w = SLACK_WIDTH
    if strain.real >= w:
        return strain, 0 * strain + 1.0, 0.0
    if strain.real > -w:
        return (strain + w) ** 2 / (4 * w), (strain + w) / (2 * w), 1 / (2 * w)
    return 0 * strain, 0 * strain, 0.0


@njit_device
def tension_at(
    stiffness: float,
    damping_time: float,
    bow: float,
    vector: FloatArray,
    stretching: FloatArray,
    rest: float,
    rest_rate: float,
    along: FloatArray,
) -> tuple[float, float]:
    """Return the tension of a bar (eq. 20, 21) and the slope of its elastic strain.

    ``along`` gets the unit vector of the bar. Damping is added to the strain before the positive
    part is taken. So tension rises with strain and strain rate everywhere, and a bar never pushes,
    however quickly it shortens.
    """
    span: float = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    closing = -rest_rate * span / rest
    for i in range(3):
        along[i] = vector[i] / span
        closing += along[i] * stretching[i]
    value, slope, _ = taut_at(span / rest - 1.0 + damping_time * closing / rest, bow.real)
    return stiffness * value, slope


@njit_device
def spanned_at(vector: FloatArray, rest: float) -> float:
    """Return the distance of a bar's ends over its straight length, at most 1.

    A slack twine hangs in a loop. Its drag across the flow goes with ∫ sin³θ ds over the loop, at
    most with ∫ sin θ ds, which is the distance of its ends.
    """
    span: float = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    straight = SLACKEST_STRAIGHT * rest
    if span.real < straight.real:
        return span / straight
    return 1.0 + 0 * span


@njit_device
def drag_at(
    normal_area: float,
    sliding_area: float,
    normal_viscous: float,
    friction_viscous: float,
    rest: float,
    density: float,
    flow: FloatArray,
    along: FloatArray,
    force: FloatArray,
) -> None:
    """Fill in the drag on a bar (eq. 23, 24); the areas include their coefficients.

    Both coefficients grow as the normal component u_n of the flow falls: |u| becomes
    |u| + viscous √|u_n| (docs/model.md, Netting).
    """
    tangential = 0 * rest
    for i in range(3):
        tangential += flow[i] * along[i]
    square = SPEED_ROUNDING_M_S**2 + 0 * rest
    for i in range(3):
        square += (flow[i] - tangential * along[i]) ** 2
    half = 0.5 * density * rest
    speed = np.sqrt(square)
    root = np.sqrt(speed)
    across = half * normal_area * (speed + normal_viscous * root)
    sliding = np.sqrt(tangential**2 + SPEED_ROUNDING_M_S**2) + friction_viscous * root
    lengthwise = half * sliding_area * sliding * tangential
    for i in range(3):
        normal = flow[i] - tangential * along[i]
        force[i] = across * normal + lengthwise * along[i]


@compiled
def weight_at(mass: float, volume: float, rest: float, density: float, gravity: float) -> float:
    """Return weight and buoyancy of a bar (eq. 28), up positive."""
    return -gravity * (mass - density * volume) * rest


@njit_device
def pull_slopes_at(
    stiffness: float,
    damping_time: float,
    slope: float,
    vector: FloatArray,
    stretching: FloatArray,
    rest: float,
    rest_rate: float,
    force: float,
    along: FloatArray,
    by_vector: FloatArray,
    by_stretching: FloatArray,
) -> None:
    """Fill in the derivatives (3, 3) of a bar's tension T times its unit vector t.

    By the bar's vector r they are t (∂T/∂r)ᵀ + T (I - t tᵀ) / |r|: tension changes, and t turns.
    ``force`` and ``slope`` are the results of `tension_at`.
    """
    span = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    closing = 0.0
    for i in range(3):
        closing += along[i] * stretching[i]
    elastic = slope / rest
    viscous = stiffness * damping_time * slope / rest
    for j in range(3):
        # Change of tension as the far end moves along axis j.
        turning = (stretching[j] - closing * along[j]) / span
        rate_j = (turning - rest_rate / rest * along[j]) / rest
        force_j = stiffness * (elastic * along[j] + damping_time * slope * rate_j)
        for i in range(3):
            across = ((i == j) - along[i] * along[j]) / span
            by_vector[i, j] = along[i] * force_j + force * across
            by_stretching[i, j] = viscous * along[i] * along[j]


@njit_device
def load_slopes_at(
    normal_area: float,
    sliding_area: float,
    normal_viscous: float,
    friction_viscous: float,
    rest: float,
    density: float,
    flow: FloatArray,
    vector: FloatArray,
    along: FloatArray,
    by_vector: FloatArray,
    by_velocity: FloatArray,
) -> None:
    """Fill in the derivatives (3, 3) of `drag_at` by the bar's vector and by its velocity.

    The derivative by the velocity is minus that by the flow.
    """
    span = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    tangential = 0.0
    for i in range(3):
        tangential += flow[i] * along[i]
    square = SPEED_ROUNDING_M_S**2
    for i in range(3):
        square += (flow[i] - tangential * along[i]) ** 2
    speed = np.sqrt(square)
    root = np.sqrt(speed)
    sliding = np.sqrt(tangential**2 + SPEED_ROUNDING_M_S**2)
    half = 0.5 * density * rest
    across, lengthwise = half * normal_area, half * sliding_area
    # F = factor n + pull t, with the normal component n of the flow and the bar's unit vector t.
    factor = across * (speed + normal_viscous * root)
    growth = across * (1.0 + 0.5 * normal_viscous / root) / speed
    viscous = lengthwise * friction_viscous * root
    by_tangential = lengthwise * (sliding + tangential**2 / sliding) + viscous
    by_normal = 0.5 * tangential * viscous / square
    # As the bar turns by δt, n changes by -(δt · u) t - (u · t) δt; δt is normal to t.
    turning = (by_tangential - factor - by_normal * tangential) / span
    swinging = tangential * (lengthwise * sliding + viscous - factor) / span
    bending = -tangential * growth / span
    for i in range(3):
        normal_i = flow[i] - tangential * along[i]
        for j in range(3):
            normal_j = flow[j] - tangential * along[j]
            plane = (i == j) - along[i] * along[j]
            both = normal_i * normal_j
            by_velocity[i, j] = -factor * plane - growth * both
            by_velocity[i, j] -= along[i] * (by_tangential * along[j] + by_normal * normal_j)
            by_vector[i, j] = turning * along[i] * normal_j + swinging * plane + bending * both


@compiled
def mass_at(
    own: float, normal: float, tangential: float, vector: FloatArray, matrix: FloatArray
) -> None:
    """Fill in the mass and added mass (3, 3) of a bar (eq. 25, 26).

    With its unit vector t it is ``own`` I + ``normal`` (I - t tᵀ) + ``tangential`` t tᵀ.
    """
    square = vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2
    for i in range(3):
        for j in range(3):
            matrix[i, j] = (tangential - normal) * vector[i] * vector[j] / square
        matrix[i, i] += own + normal
