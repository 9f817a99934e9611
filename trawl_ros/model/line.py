# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Straight bars of rope, warp or netting: properties, motion, tension and drag (eq. 20-24).

A numerical bar may stand for many real ones side by side; its stiffness, projected and
wetted area and volume are their sums. All properties are per metre of unstretched length,
so that a warp may change its length.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.bar import drag_at, spanned_at, taut_at, tension_at
from trawl_ros.model.compiled import compiled, promote_dtypes
from trawl_ros.model.water import Water


@dataclass(frozen=True)
class BarProperties:
    """Properties of ``n`` bars, each an array (n,).

    Attributes
    ----------
    stiffness, damping_time
        EA (N) and c_l l0 / EA (s).
    mass, volume
        Mass (kg/m) and volume (m³/m).
    normal_area, wet_area
        S_N and S_f (m²/m).
    normal_drag, friction
        C_N90 and C_f.
    added_normal, added_tangential
        C_mn = C_mb and C_mt of eq. 26.
    bow
        Dimensionless sag of `bar.bowed_at`; 0 for bars that stay straight.
    normal_viscous, friction_viscous
        Viscous parts (√(m/s)) of `bar.drag_at`; 0 for constant coefficients.
    """

    stiffness: FloatArray
    damping_time: FloatArray
    mass: FloatArray
    volume: FloatArray
    normal_area: FloatArray
    wet_area: FloatArray
    normal_drag: FloatArray
    friction: FloatArray
    added_normal: FloatArray
    added_tangential: FloatArray
    bow: FloatArray
    normal_viscous: FloatArray
    friction_viscous: FloatArray

    def __post_init__(self) -> None:
        for name, values in zip(vars(self), promote_dtypes(*self.columns), strict=True):
            object.__setattr__(self, name, values)

    @property
    def columns(self) -> tuple[FloatArray, ...]:
        """All properties in the order above."""
        return tuple(vars(self).values())

    def chosen(self, bars: IntArray) -> 'BarProperties':
        """Return the properties of some of the bars."""
        return BarProperties(*(values[bars] for values in self.columns))


@dataclass(frozen=True)
class BarGroup:
    """Group of k bars.

    Attributes
    ----------
    bars
        Their numbers (k,).
    points
        Numbers of the points at which they end.
    ends
        Ends (k, 2) as places among ``points``.
    properties
        Their properties.
    """

    bars: IntArray
    points: IntArray
    ends: IntArray
    properties: BarProperties

    def rows(self, nodes: int) -> IntArray:
        """Return the degrees of freedom of the points that are nodes, in a gear of ``nodes``."""
        free = self.points[self.points < nodes]
        every: IntArray = (3 * free[:, None] + np.arange(3)).ravel()
        return every


@dataclass(frozen=True)
class BarMotion:
    """Motion of ``n`` bars from end i to end j.

    Attributes
    ----------
    vector, stretching : (n, 3) arrays
        Vector from i to j (m), and relative velocity v_j - v_i (m/s).
    velocity : (n, 3) array
        Mean velocity of both ends, m/s.
    height : (n,) array
        Mean height of both ends, m.
    rest, rest_rate : (n,) arrays
        Unstretched length (m) and its rate (m/s).
    """

    vector: FloatArray
    stretching: FloatArray
    velocity: FloatArray
    height: FloatArray
    rest: FloatArray
    rest_rate: FloatArray


def taut(strain: FloatArray, bow: float = 0.0) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the results of `taut_at` for an array of strains."""
    (flat,) = promote_dtypes(np.ravel(strain))
    value, slope, curve = np.empty_like(flat), np.empty_like(flat), np.empty(flat.shape)
    _taut(flat, bow, value, slope, curve)
    shape = np.shape(strain)
    return value.reshape(shape), slope.reshape(shape), curve.reshape(shape)


@compiled
def _taut(
    strain: FloatArray, bow: float, value: FloatArray, slope: FloatArray, curve: FloatArray
) -> None:
    for n in range(len(strain)):
        value[n], slope[n], curve[n] = taut_at(strain[n], bow)


def tension(bars: BarProperties, motion: BarMotion) -> tuple[FloatArray, FloatArray]:
    """Return tension (n,) in N, and unit vector (n, 3) along the bar (eq. 20, 21).

    The damping of eq. 21 acts on the strain rate, so that paying out causes no damping force. A
    rope is slack if strain and damping together are negative, so that it never pushes.
    """
    given = promote_dtypes(
        bars.stiffness,
        bars.damping_time,
        bars.bow,
        motion.vector,
        motion.stretching,
        motion.rest,
        motion.rest_rate,
    )
    force, along = np.empty_like(given[0]), np.empty_like(given[3])
    _tension(*given, force, along)
    return force, along


@compiled
def _tension(
    stiffness: FloatArray,
    damping_time: FloatArray,
    bow: FloatArray,
    vector: FloatArray,
    stretching: FloatArray,
    rest: FloatArray,
    rest_rate: FloatArray,
    force: FloatArray,
    along: FloatArray,
) -> None:
    for n in range(len(rest)):
        force[n], _ = tension_at(
            stiffness[n],
            damping_time[n],
            bow[n],
            vector[n],
            stretching[n],
            rest[n],
            rest_rate[n],
            along[n],
        )


def drag(bars: BarProperties, motion: BarMotion, along: FloatArray, water: Water) -> FloatArray:
    """Return the hydrodynamic force (n, 3) in N on whole bars (eq. 23, 24)."""
    given = promote_dtypes(
        bars.normal_drag * bars.normal_area,
        bars.friction * bars.wet_area,
        bars.normal_viscous,
        bars.friction_viscous,
        motion.rest,
        motion.vector,
        water.density_at(motion.height),
        water.current(motion.height) - motion.velocity,
        along,
    )
    force = np.empty_like(given[-1])
    _drag(*given, force)
    return force


@compiled
def _drag(
    normal_area: FloatArray,
    sliding_area: FloatArray,
    normal_viscous: FloatArray,
    friction_viscous: FloatArray,
    rest: FloatArray,
    vector: FloatArray,
    density: FloatArray,
    flow: FloatArray,
    along: FloatArray,
    force: FloatArray,
) -> None:
    for n in range(len(rest)):
        drag_at(
            spanned_at(vector[n], rest[n]) * normal_area[n],
            sliding_area[n],
            normal_viscous[n],
            friction_viscous[n],
            rest[n],
            density[n],
            flow[n],
            along[n],
            force[n],
        )
