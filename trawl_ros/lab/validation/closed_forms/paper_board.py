# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loads on one otter board, coded separately from the paper and the continuation of its law.

It shares no code with `trawl_ros.model.board`. The axes come from the board's three vertices (eq.
7-11) instead of a rotation matrix, and each side has its own handedness. Outside the law's range
the coefficients are integrated from slopes.
"""

from dataclasses import dataclass
from math import asin, copysign, cos, hypot, pi, radians, sqrt

import numpy as np
from scipy.interpolate import BPoly, PPoly, make_interp_spline

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.boards import BoardRecord

INNER, OUTER = radians(-40.0), radians(90.0)
"""Attack angles at which lift and moments are gone."""

FULL = radians(40.0)
"""Largest attack and slip at which eq. 14 holds unchanged."""

ROUNDING = radians(4.0)


def _sloping(angles: list[float], slopes: list[float]) -> PPoly:
    """Return a curve through the origin whose slope is piecewise linear between given angles."""
    curve = PPoly.from_spline(make_interp_spline(angles, slopes, k=1)).antiderivative()
    curve.c[-1] -= float(curve(0.0))
    return curve


RESTING_ATTACK = _sloping(
    [-pi, -ROUNDING, 0.0, FULL, FULL + ROUNDING, pi], [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]
)
RESTING_SLIP = _sloping(
    [-pi, -FULL - ROUNDING, -FULL, FULL, FULL + ROUNDING, pi], [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]
)
FACING = _sloping([-pi, -ROUNDING, 0.0, pi], [-1.0, -1.0, 1.0, 1.0])
"""Attack angle for drag: mirrored for flow on the inner face."""

FADING = BPoly.from_derivatives(
    [-pi, INNER, 0.0, FULL, OUTER, pi],
    [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
)


@dataclass(frozen=True)
class PaperBoard:
    """Board in motion, in the paper's terms.

    ``a``, ``b``, ``c``: places (3,) of the vertices where warp, upper and lower bridle are
    fastened, m, ``va``, ``vb``, ``vc`` their velocities, m/s; ``rate`` rad/s; ``water`` its
    velocity there, m/s; ``density`` kg/m³. ``port`` says which side.
    """

    record: BoardRecord
    port: bool
    a: FloatArray
    b: FloatArray
    c: FloatArray
    va: FloatArray
    vb: FloatArray
    vc: FloatArray
    rate: FloatArray
    water: FloatArray
    density: float
    gravity: float

    @property
    def k_d(self) -> float:
        """Handedness of the frame: 1 on starboard (left-handed), -1 on port (eq. 8)."""
        return -1.0 if self.port else 1.0

    def axes(self) -> list[FloatArray]:
        """Axes x, y, z of the board in fixed axes (eq. 7-11).

        The turn between model frame and board is that of the vertices in the gear file.
        """
        points = self.record.fastening
        home = _model_axes(
            np.array(points.warp_m),
            np.array(points.upper_bridle_m),
            np.array(points.lower_bridle_m),
            -1.0,
        )
        here = _model_axes(self.a, self.b, self.c, self.k_d)
        return [
            here[0] * home[0][i] + here[1] * home[1][i] + here[2] * home[2][i] for i in range(3)
        ]

    def relative_flow(self) -> tuple[float, float, float]:
        """Relative flow u_x, u_y, u_z of the water against the board (eq. 3, 4)."""
        relative = self.water - (self.va + self.vb + self.vc) / 3.0
        x, y, z = (float(relative @ axis) for axis in self.axes())
        return x, y, z

    def load(self) -> tuple[FloatArray, FloatArray]:
        """Force (3,) N and moment (3,) N m in fixed axes: eq. 12-14, 19, and turning."""
        record, n = self.record, self.axes()
        ux, uy, uz = self.relative_flow()
        u = sqrt(ux * ux + uy * uy + uz * uz)
        cx, cy, cz, cmx, cmy, cmz = coefficients(record, attack(ux, uy), attack(ux, uz))
        part = (ux * ux + uy * uy) / (u * u) / cos(FULL) ** 2
        spanwise = 1.0 if part >= 1.0 else part * (2.0 - part)
        pressure = 0.5 * self.density * record.area_m2 * u * u * spanwise
        plane = hypot(ux, uy)
        along = (ux * n[0] + uy * n[1]) / plane
        outside = (uy * n[0] - ux * n[1]) / plane
        force = pressure * (cx * along + cy * outside - cz * n[2])
        force = force - (record.mass_kg - record.volume_m3 * self.density) * np.array(
            [0.0, 0.0, self.gravity]
        )
        b, chord = record.span_m, record.chord_m
        # Loads have axes aft, outward, down: the half turn about y of n. A positive turn about
        # left-handed axes is a left-hand screw.
        screw = -cmx * b * n[0] + cmy * hypot(b, chord) * n[1] - cmz * chord * n[2]
        strips = self._strips(u)
        slowing = [strips[i] * float(self.rate @ n[i]) * n[i] for i in range(3)]
        return force, -self.k_d * pressure * screw - slowing[0] - slowing[1] - slowing[2]

    def _strips(self, u: float) -> tuple[float, float, float]:
        """Damping about x, y, z, N m s, summed over strips of the board.

        The attack angle of a strip at r changes by ω r / u, and the slope of its lift damps the
        rotation.
        """
        lift = 0.5 * self.density * u * u * self.record.rotary_slope
        places, shares = np.polynomial.legendre.leggauss(4)

        def about(width: float, other: float) -> float:
            r, dr = 0.5 * width * places, 0.5 * width * shares
            return float(np.sum(lift * (r / u) * r * other * dr))

        b, chord = self.record.span_m, self.record.chord_m
        return about(b, chord), 0.0, about(chord, b)


def _model_axes(a: FloatArray, b: FloatArray, c: FloatArray, k_d: float) -> list[FloatArray]:
    """Axes x, y, z of the model frame from its vertices (eq. 7-10)."""
    ac, bc = a - c, b - c
    z = bc / np.linalg.norm(bc)
    normal = np.cross(ac, bc)
    y = k_d * normal / np.linalg.norm(normal)
    return [k_d * np.cross(z, y), y, z]


def attack(ux: float, other: float) -> float:
    """Attack angle of eq. 1 (with u_y) and slip of eq. 2 (with u_z), continued beyond 90°."""
    angle = asin(other / sqrt(ux * ux + other * other))
    return angle if ux < 0.0 else copysign(pi, other) - angle


def coefficients(record: BoardRecord, alpha: float, beta: float) -> tuple[float, ...]:
    """The six coefficients of eq. 14, and their stated continuation outside 0-40°."""
    a1, c1, a2, c2, b3, c3, a4, c4, b5, c5, a6, c6 = map(float, record.coefficients.array())
    if 0.0 <= alpha <= FULL and abs(beta) <= FULL:
        return (
            a1 * alpha + c1,
            a2 * alpha + c2,
            b3 * beta + c3,
            a4 * alpha + c4,
            b5 * beta + c5,
            a6 * alpha + c6,
        )
    fade = float(FADING(alpha))
    rest, slip = float(RESTING_ATTACK(alpha)), float(RESTING_SLIP(beta))
    drag = a1 * float(RESTING_ATTACK(FACING(alpha))) + c1
    return (
        max(drag, 0.0),
        fade * (a2 * rest + c2),
        fade * b3 * slip + c3,
        fade * (a4 * rest + c4),
        fade * b5 * slip + c5,
        fade * (a6 * rest + c6),
    )
