"""Forces on a straight bar of rope, warp or netting (eq. 20-24, 26, 28).

A numerical bar may stand for many real ones side by side; its stiffness, projected and
wetted area and volume are their sums. All properties are per metre of unstretched length,
so that a warp may change its length.
"""

from dataclasses import dataclass, fields

import numpy as np

from trawl_ros.model.numerics import dot, length, outer
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
    """Where bars are: vector from end i to end j (n, 3), both ends' relative velocity
    ``stretching`` = v_j - v_i, mean velocity and mean height of the two ends, unstretched
    length ``rest`` (n,) and its rate of change ``rest_rate``.
    """

    vector: np.ndarray
    stretching: np.ndarray
    velocity: np.ndarray
    height: np.ndarray
    rest: np.ndarray
    rest_rate: np.ndarray


def taut(strain: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positive part of the strain with a rounded corner, and its first two derivatives."""
    w = SLACK_WIDTH
    real = np.real(strain)
    inside = np.abs(real) < w
    above = real >= w
    value = np.where(above, strain, np.where(inside, (strain + w) ** 2 / (4 * w), 0.0))
    slope = np.where(above, 1.0, np.where(inside, (strain + w) / (2 * w), 0.0))
    curve = np.where(inside, 1 / (2 * w), 0.0)
    return value, slope, curve


def tension(bars: BarProperties, motion: BarMotion) -> tuple[np.ndarray, np.ndarray]:
    """Tension (n,) in N, positive in pull, and unit vector (n, 3) along the bar (eq. 20, 21).

    The damping of eq. 21 acts on the rate of strain, so that paying out does not brake, and
    fades with the elastic force, so that a slack rope does not push.
    """
    span = length(motion.vector)
    along = motion.vector / span[..., None]
    value, slope, _ = taut(span / motion.rest - 1.0)
    rate = (dot(along, motion.stretching) - motion.rest_rate * span / motion.rest) / motion.rest
    return bars.stiffness * (value + bars.damping_time * slope * rate), along


def drag(bars: BarProperties, motion: BarMotion, along: np.ndarray, water: Water) -> np.ndarray:
    """Hydrodynamic force (n, 3) in N on whole bars (eq. 23, 24)."""
    density = water.density_at(motion.height)
    flow = water.current(motion.height) - motion.velocity
    tangential = dot(flow, along)
    normal = flow - tangential[..., None] * along
    speed = length(normal, STILL)
    sliding = np.sqrt(tangential**2 + STILL**2)
    half = 0.5 * density * motion.rest
    across = half * bars.normal_drag * bars.normal_area * speed
    lengthwise = half * bars.friction * bars.wet_area * sliding * tangential
    return across[..., None] * normal + lengthwise[..., None] * along


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
    """Pull, load and their exact derivatives: the analytic form of the functions above."""
    span = length(motion.vector)
    along = motion.vector / span[:, None]
    value, slope, curve = taut(span / motion.rest - 1.0)
    rate = (dot(along, motion.stretching) - motion.rest_rate * span / motion.rest) / motion.rest
    force = bars.stiffness * (value + bars.damping_time * slope * rate)
    identity = np.eye(3)
    tangent = outer(along, along)
    across = (identity - tangent) / span[:, None, None]

    rate_by_vector = (
        np.einsum('nij,nj->ni', across, motion.stretching)
        - (motion.rest_rate / motion.rest)[:, None] * along
    ) / motion.rest[:, None]
    elastic = slope + bars.damping_time * curve * rate
    force_by_vector = bars.stiffness[:, None] * (
        (elastic / motion.rest)[:, None] * along
        + (bars.damping_time * slope)[:, None] * rate_by_vector
    )
    pull_by_vector = outer(along, force_by_vector) + force[:, None, None] * across
    viscous = bars.stiffness * bars.damping_time * slope / motion.rest
    pull_by_stretching = viscous[:, None, None] * tangent

    density = water.density_at(motion.height)
    flow = water.current(motion.height) - motion.velocity
    tangential = dot(flow, along)
    normal = flow - tangential[:, None] * along
    speed = length(normal, STILL)
    sliding = np.sqrt(tangential**2 + STILL**2)
    normal_factor = 0.5 * bars.normal_drag * bars.normal_area * motion.rest
    sliding_factor = 0.5 * bars.friction * bars.wet_area * motion.rest
    hydro = density[:, None] * (
        (normal_factor * speed)[:, None] * normal
        + (sliding_factor * sliding * tangential)[:, None] * along
    )

    by_normal = (density * normal_factor)[:, None, None] * (
        speed[:, None, None] * identity + outer(normal, normal) / speed[:, None, None]
    )
    by_sliding = density * sliding_factor * (sliding + tangential**2 / sliding)
    by_flow = by_normal @ (identity - tangent) + by_sliding[:, None, None] * tangent
    turned = -by_normal @ (outer(along, flow) + tangential[:, None, None] * identity)
    turned += by_sliding[:, None, None] * outer(along, flow)
    turned += (density * sliding_factor * sliding * tangential)[:, None, None] * identity
    by_height = np.einsum('nij,nj->ni', by_flow, water.current_slope(motion.height))
    by_height -= (water.density_gradient / density)[:, None] * hydro
    by_height[:, 2] -= water.gravity * water.density_gradient * bars.volume * motion.rest

    load = hydro
    load[:, 2] += weight(bars, motion, water)
    return BarSlopes(
        pull=force[:, None] * along,
        load=load,
        pull_by_vector=pull_by_vector,
        pull_by_stretching=pull_by_stretching,
        load_by_vector=turned @ across,
        load_by_velocity=-by_flow,
        load_by_height=by_height,
    )


def mass(bars: BarProperties, motion: BarMotion, water: Water) -> np.ndarray:
    """Mass and added mass of whole bars as matrices (n, 3, 3) in kg (eq. 25, 26)."""
    span = length(motion.vector)
    tangent = outer(motion.vector, motion.vector) / (span**2)[:, None, None]
    displaced = water.density_at(motion.height) * bars.volume * motion.rest
    normal = displaced * bars.added_normal
    tangential = displaced * bars.added_tangential
    plain = bars.mass * motion.rest + normal
    return plain[:, None, None] * np.eye(3) + (tangential - normal)[:, None, None] * tangent
