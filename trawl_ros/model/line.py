"""Forces on a straight bar of rope, warp or netting (eq. 20-24, 26, 28).

A numerical bar may stand for many real ones side by side; its stiffness, projected and
wetted area and volume are their sums. All properties are per metre of unstretched length,
so that a warp may change its length.

The loops over bars are compiled. They take real numbers, and complex ones for a complex step.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from trawl_ros.model.compiled import alike, compiled
from trawl_ros.model.water import Water

SLACK_WIDTH = 1e-4
"""Half the range of strain over which slack passes smoothly into taut; eq. 20 has a kink."""

STILL = 1e-6
"""Speed (m/s) below which quadratic drag is rounded off, so that its derivative exists."""


@dataclass(frozen=True)
class BarProperties:
    """Properties of ``n`` bars, each an array (n,).

    ``stiffness`` EA (N); ``damping_time`` c_l l0 / EA (s); ``mass`` (kg/m); ``volume`` (m²,
    that is m³/m); ``normal_area`` S_N and ``wet_area`` S_f (m²/m); ``normal_drag`` C_N90 and
    ``friction`` C_f; ``added_normal`` C_mn = C_mb and ``added_tangential`` C_mt of eq. 26.
    """

    stiffness: np.ndarray
    damping_time: np.ndarray
    mass: np.ndarray
    volume: np.ndarray
    normal_area: np.ndarray
    wet_area: np.ndarray
    normal_drag: np.ndarray
    friction: np.ndarray
    added_normal: np.ndarray
    added_tangential: np.ndarray

    def chosen(self, bars: np.ndarray | slice) -> 'BarProperties':
        """The properties of some of the bars."""
        if isinstance(bars, slice) and bars == slice(None):
            return self
        return BarProperties(*(getattr(self, field.name)[bars] for field in fields(self)))


@dataclass(frozen=True)
class BarMotion:
    """Motion of bars: vector from end i to end j (n, 3), both ends' relative velocity
    ``stretching`` = v_j - v_i, mean velocity and mean height of the two ends, unstretched
    length ``rest`` (n,) and its rate of change ``rest_rate``.
    """

    vector: np.ndarray
    stretching: np.ndarray
    velocity: np.ndarray
    height: np.ndarray
    rest: np.ndarray
    rest_rate: np.ndarray


@compiled
def taut_at(strain: Any) -> Any:
    """Positive part of one strain with a rounded corner, and its first two derivatives."""
    w = SLACK_WIDTH
    if strain.real >= w:
        return strain, 0 * strain + 1.0, 0.0
    if strain.real > -w:
        return (strain + w) ** 2 / (4 * w), (strain + w) / (2 * w), 1 / (2 * w)
    return 0 * strain, 0 * strain, 0.0


def taut(strain: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`taut_at` for an array of strains."""
    (flat,) = alike(np.ravel(strain))
    value, slope, curve = np.empty_like(flat), np.empty_like(flat), np.empty(flat.shape)
    _taut(flat, value, slope, curve)
    shape = np.shape(strain)
    return value.reshape(shape), slope.reshape(shape), curve.reshape(shape)


@compiled
def _taut(strain: np.ndarray, value: np.ndarray, slope: np.ndarray, curve: np.ndarray) -> None:
    for n in range(len(strain)):
        value[n], slope[n], curve[n] = taut_at(strain[n])


def tension(bars: BarProperties, motion: BarMotion) -> tuple[np.ndarray, np.ndarray]:
    """Tension (n,) in N, positive in pull, and unit vector (n, 3) along the bar (eq. 20, 21).

    The damping of eq. 21 acts on the rate of strain, so that paying out does not brake, and
    fades with the elastic force, so that a slack rope does not push.
    """
    given = alike(
        bars.stiffness,
        bars.damping_time,
        motion.vector,
        motion.stretching,
        motion.rest,
        motion.rest_rate,
    )
    force, along = np.empty_like(given[0]), np.empty_like(given[2])
    _tension(*given, force, along)
    return force, along


@compiled
def _tension(
    stiffness: np.ndarray,
    damping_time: np.ndarray,
    vector: np.ndarray,
    stretching: np.ndarray,
    rest: np.ndarray,
    rest_rate: np.ndarray,
    force: np.ndarray,
    along: np.ndarray,
) -> None:
    for n in range(len(rest)):
        span = np.sqrt(vector[n, 0] ** 2 + vector[n, 1] ** 2 + vector[n, 2] ** 2)
        closing = -rest_rate[n] * span / rest[n]
        for i in range(3):
            along[n, i] = vector[n, i] / span
            closing += along[n, i] * stretching[n, i]
        value, slope, _ = taut_at(span / rest[n] - 1.0)
        force[n] = stiffness[n] * (value + damping_time[n] * slope * closing / rest[n])


def drag(bars: BarProperties, motion: BarMotion, along: np.ndarray, water: Water) -> np.ndarray:
    """Hydrodynamic force (n, 3) in N on whole bars (eq. 23, 24)."""
    given = alike(
        bars.normal_drag * bars.normal_area,
        bars.friction * bars.wet_area,
        motion.rest,
        water.density_at(motion.height),
        water.current(motion.height) - motion.velocity,
        along,
    )
    force = np.empty_like(given[-1])
    _drag(*given, force)
    return force


@compiled
def _drag(
    normal_area: np.ndarray,
    sliding_area: np.ndarray,
    rest: np.ndarray,
    density: np.ndarray,
    flow: np.ndarray,
    along: np.ndarray,
    force: np.ndarray,
) -> None:
    for n in range(len(rest)):
        tangential = 0 * rest[n]
        for i in range(3):
            tangential += flow[n, i] * along[n, i]
        square = STILL**2 + 0 * rest[n]
        for i in range(3):
            square += (flow[n, i] - tangential * along[n, i]) ** 2
        half = 0.5 * density[n] * rest[n]
        across = half * normal_area[n] * np.sqrt(square)
        sliding = np.sqrt(tangential**2 + STILL**2)
        lengthwise = half * sliding_area[n] * sliding * tangential
        for i in range(3):
            normal = flow[n, i] - tangential * along[n, i]
            force[n, i] = across * normal + lengthwise * along[n, i]


def weight(bars: BarProperties, motion: BarMotion, water: Water) -> np.ndarray:
    """Vertical force of weight and buoyancy (n,) in N, up positive (eq. 28)."""
    net = bars.mass - water.density_at(motion.height) * bars.volume
    return -water.gravity * net * motion.rest


@dataclass(frozen=True)
class BarSlopes:
    """Derivatives of a bar's pull (tension times unit vector) and of its load (drag and
    weight of the whole bar), each (n, 3, 3), and of the load by height, (n, 3).
    """

    pull: np.ndarray
    load: np.ndarray
    pull_by_vector: np.ndarray
    pull_by_stretching: np.ndarray
    load_by_vector: np.ndarray
    load_by_velocity: np.ndarray
    load_by_height: np.ndarray


def linearised(bars: BarProperties, motion: BarMotion, water: Water) -> BarSlopes:
    """Pull, load and their exact derivatives."""
    force, along = tension(bars, motion)
    hydro = drag(bars, motion, along, water)
    count = len(force)
    by_vector, by_stretching, load_by_vector, load_by_velocity = np.empty((4, count, 3, 3))
    _pull_slopes(
        *alike(bars.stiffness, bars.damping_time, motion.vector, motion.stretching),
        *alike(motion.rest, motion.rest_rate, force, along),
        by_vector,
        by_stretching,
    )
    density = water.density_at(motion.height)
    _load_slopes(
        *alike(bars.normal_drag * bars.normal_area, bars.friction * bars.wet_area, motion.rest),
        *alike(density, water.current(motion.height) - motion.velocity, motion.vector),
        load_by_vector,
        load_by_velocity,
    )
    by_height = -np.einsum('nij,nj->ni', load_by_velocity, water.current_slope(motion.height))
    by_height -= (water.density_gradient / density)[:, None] * hydro
    by_height[:, 2] -= water.gravity * water.density_gradient * bars.volume * motion.rest
    load = hydro
    load[:, 2] += weight(bars, motion, water)
    return BarSlopes(
        pull=force[:, None] * along,
        load=load,
        pull_by_vector=by_vector,
        pull_by_stretching=by_stretching,
        load_by_vector=load_by_vector,
        load_by_velocity=load_by_velocity,
        load_by_height=by_height,
    )


@compiled
def _pull_slopes(
    stiffness: np.ndarray,
    damping_time: np.ndarray,
    vector: np.ndarray,
    stretching: np.ndarray,
    rest: np.ndarray,
    rest_rate: np.ndarray,
    force: np.ndarray,
    along: np.ndarray,
    by_vector: np.ndarray,
    by_stretching: np.ndarray,
) -> None:
    """Slopes of `_tension` times the unit vector."""
    for n in range(len(rest)):
        span = np.sqrt(vector[n, 0] ** 2 + vector[n, 1] ** 2 + vector[n, 2] ** 2)
        closing = 0.0
        for i in range(3):
            closing += along[n, i] * stretching[n, i]
        rate = (closing - rest_rate[n] * span / rest[n]) / rest[n]
        _, slope, curve = taut_at(span / rest[n] - 1.0)
        elastic = (slope + damping_time[n] * curve * rate) / rest[n]
        viscous = stiffness[n] * damping_time[n] * slope / rest[n]
        for j in range(3):
            # How force changes as the far end moves along axis j.
            turning = (stretching[n, j] - closing * along[n, j]) / span
            rate_j = (turning - rest_rate[n] / rest[n] * along[n, j]) / rest[n]
            force_j = stiffness[n] * (elastic * along[n, j] + damping_time[n] * slope * rate_j)
            for i in range(3):
                across = ((i == j) - along[n, i] * along[n, j]) / span
                by_vector[n, i, j] = along[n, i] * force_j + force[n] * across
                by_stretching[n, i, j] = viscous * along[n, i] * along[n, j]


@compiled
def _load_slopes(
    normal_area: np.ndarray,
    sliding_area: np.ndarray,
    rest: np.ndarray,
    density: np.ndarray,
    flow: np.ndarray,
    vector: np.ndarray,
    by_vector: np.ndarray,
    by_velocity: np.ndarray,
) -> None:
    """Slopes of `_drag` by the bar's vector and by its velocity, which is minus the flow's."""
    along, normal = np.empty(3), np.empty(3)
    by_along = np.empty((3, 3))
    for n in range(len(rest)):
        span = np.sqrt(vector[n, 0] ** 2 + vector[n, 1] ** 2 + vector[n, 2] ** 2)
        tangential = 0.0
        for i in range(3):
            along[i] = vector[n, i] / span
            tangential += flow[n, i] * along[i]
        square = STILL**2
        for i in range(3):
            normal[i] = flow[n, i] - tangential * along[i]
            square += normal[i] ** 2
        speed = np.sqrt(square)
        sliding = np.sqrt(tangential**2 + STILL**2)
        across = 0.5 * density[n] * rest[n] * normal_area[n]
        lengthwise = 0.5 * density[n] * rest[n] * sliding_area[n]
        by_sliding = lengthwise * (sliding + tangential**2 / sliding)
        for i in range(3):
            for j in range(3):
                # normal · (I - t tᵀ) is normal itself, for it has no part along the bar.
                plane = (i == j) - along[i] * along[j]
                by_flow = across * (speed * plane + normal[i] * normal[j] / speed)
                by_velocity[n, i, j] = -by_flow - by_sliding * along[i] * along[j]
                # δ normal = -(along · flow + t · flow along) as the bar turns.
                by_along[i, j] = -across * (
                    speed * along[i] * flow[n, j]
                    + tangential * (speed * (i == j) + normal[i] * normal[j] / speed)
                )
                by_along[i, j] += by_sliding * along[i] * flow[n, j]
                by_along[i, j] += lengthwise * sliding * tangential * (i == j)
        for i in range(3):
            for j in range(3):
                total = 0.0
                for k in range(3):
                    total += by_along[i, k] * ((k == j) - along[k] * along[j]) / span
                by_vector[n, i, j] = total


def mass(bars: BarProperties, motion: BarMotion, water: Water) -> np.ndarray:
    """Mass and added mass of whole bars as matrices (n, 3, 3) in kg (eq. 25, 26)."""
    displaced = water.density_at(motion.height) * bars.volume * motion.rest
    matrices = np.empty((len(displaced), 3, 3))
    _mass(
        *alike(
            bars.mass * motion.rest,
            displaced * bars.added_normal,
            displaced * bars.added_tangential,
            motion.vector,
        ),
        matrices,
    )
    return matrices


@compiled
def _mass(
    own: np.ndarray,
    normal: np.ndarray,
    tangential: np.ndarray,
    vector: np.ndarray,
    matrices: np.ndarray,
) -> None:
    for n in range(len(own)):
        square = vector[n, 0] ** 2 + vector[n, 1] ** 2 + vector[n, 2] ** 2
        for i in range(3):
            for j in range(3):
                along = vector[n, i] * vector[n, j] / square
                matrices[n, i, j] = (tangential[n] - normal[n]) * along
            matrices[n, i, i] += own[n] + normal[n]
