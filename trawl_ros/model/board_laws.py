# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Laws of boards: eq. 14, eq. 14 with lift against heel, a polar with stall, a table.

A law owns its parameters. It turns their values, the angles of the flow and the board's tilt into
the six coefficients of eq. 12. Derivatives by all of these come from the complex step.

To add a law, write its formula here, and its parameters in `trawl_ros.gear.board_parameters`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import radians
from types import MappingProxyType
from typing import Protocol

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.board_parameters import CORRECTED, PARAMETERS_OF_KIND, BoardParameters
from trawl_ros.gear.polars import Polar, Tilt
from trawl_ros.model.board_law import (
    LAW_RANGE,
    SLIP_LIMIT_RAD,
    fill_coefficients,
    smooth_clip,
    smoothstep_window,
)
from trawl_ros.model.compiled import (
    as_kind,
    compiled,
    njit_device,
    promote_dtypes,
    stepped_among,
)

STALL_RANGE = (0.0, radians(60.0))
"""Attack angles (rad) for which the polar with stall holds unchanged."""

STALL_WIDTH_RAD = radians(3.0)
"""Scale of the logistic function of the stall; assumed."""


class BoardLaw(Protocol):
    """Law of a board with its own parameters."""

    @property
    def parameters(self) -> BoardParameters:
        """Names, units and default prior of its q parameters."""
        ...

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest angle of attack (rad) for which the law holds unchanged."""
        ...

    def __call__(
        self,
        values: FloatArray,
        attack: FloatArray | float,
        slip: FloatArray | float,
        lean: FloatArray | float = 0.0,
        rise: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Return the six force and moment coefficients of eq. 12.

        Parameters
        ----------
        values : (q,) array
            Values of the parameters.
        attack, slip : (...) arrays
            α and β, rad.
        lean, rise : (...) arrays
            Vertical parts of the outward normal and of the forward axis: the sines of heel and
            trim.

        Returns
        -------
        (..., 6) array
            C_x^F, C_y^F, C_z^F, C_x^M, C_y^M, C_z^M.
        """
        ...


@dataclass(frozen=True)
class FormulaLaw:
    """Law by a formula.

    Outside its range lift, moments and the part of the slip fade; drag stays constant. Outside
    ±40° of slip its part stays constant.

    Attributes
    ----------
    kind
        Key of `PARAMETERS_OF_KIND`: ``eq14``, ``heel`` or ``stall``.
    """

    kind: str

    @property
    def parameters(self) -> BoardParameters:
        """Names, units and default prior of its q parameters."""
        return PARAMETERS_OF_KIND[self.kind]

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest angle of attack (rad) for which the law holds unchanged."""
        return STALL_RANGE if self.kind == 'stall' else LAW_RANGE

    def __call__(
        self,
        values: FloatArray,
        attack: FloatArray | float,
        slip: FloatArray | float,
        lean: FloatArray | float = 0.0,
        rise: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Return the six coefficients (..., 6) as `BoardLaw` does."""
        angles = np.broadcast_arrays(attack, slip, lean, rise)
        given = values, *(angle.ravel() for angle in angles[:3])
        coefficients = np.empty((angles[0].size, 6), complex)
        point, alpha, beta, sine = as_kind(complex, *given)
        FORMULAS[self.kind](point, alpha, beta, sine, coefficients)
        return real_like(given, coefficients).reshape(*angles[0].shape, 6)


EQ14 = FormulaLaw('eq14')
"""Straight lines of eq. 14."""


def real_like(given: tuple[FloatArray, ...], found: FloatArray) -> FloatArray:
    """Return the result of a law, which is compiled for complex numbers, real for real input."""
    return found if stepped_among(*given) else found.real


def _fill_eq14(
    values: FloatArray,
    attack: FloatArray,
    slip: FloatArray,
    _lean: FloatArray,
    coefficients: FloatArray,
) -> None:
    fill_coefficients(values, attack, slip, coefficients)


@compiled
def _fill_heeled(
    values: FloatArray,
    attack: FloatArray,
    slip: FloatArray,
    lean: FloatArray,
    coefficients: FloatArray,
) -> None:
    fill_coefficients(values, attack, slip, coefficients)
    h2, h3 = values[12], values[13]
    for n in range(len(attack)):
        fade = smoothstep_window(attack[n], LAW_RANGE[0], LAW_RANGE[1])
        coefficients[n, 1] += h2 * lean[n] * fade
        coefficients[n, 2] += h3 * lean[n] * fade


@compiled
def _fill_stalling(
    values: FloatArray,
    attack: FloatArray,
    slip: FloatArray,
    _lean: FloatArray,
    coefficients: FloatArray,
) -> None:
    # Below its stall a board has the lift of a straight line, and induced drag by its square. Far
    # above it the board is a flat plate, whose force 2 k sin α is normal to it.
    lift_slope, zero_lift_angle, stall_angle = values[0], values[1], values[2]
    plate_lift, base_drag, induced_drag = values[3], values[4], values[5]
    centre_ahead, span_force_slope = values[6], values[7]
    roll_slope, roll, pitch_slope = values[8], values[9], values[10]
    low, high = STALL_RANGE
    for n in range(len(attack)):
        fade = smoothstep_window(attack[n], low, high)
        alpha = smooth_clip(attack[n], low, high)
        beta = smooth_clip(slip[n], -SLIP_LIMIT_RAD, SLIP_LIMIT_RAD)
        stalled = 1.0 / (1.0 + np.exp((stall_angle - alpha) / STALL_WIDTH_RAD))
        line = lift_slope * (alpha - zero_lift_angle)
        plate = 2.0 * plate_lift * np.sin(alpha)
        lift = (1.0 - stalled) * line + stalled * plate * np.cos(alpha)
        drag = (1.0 - stalled) * induced_drag * line**2 + stalled * plate * np.sin(alpha)
        drag += base_drag
        normal = lift * np.cos(alpha) + drag * np.sin(alpha)
        coefficients[n, 0] = drag
        coefficients[n, 1] = lift * fade
        coefficients[n, 2] = span_force_slope * beta * fade
        coefficients[n, 3] = (roll_slope * alpha + roll) * fade
        coefficients[n, 4] = pitch_slope * beta * fade
        # C_z^M of eq. 12 has the opposite sign of the moment of a force ahead of the centre.
        coefficients[n, 5] = -centre_ahead * normal * fade


Formula = Callable[[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray], None]
FORMULAS: Mapping[str, Formula] = MappingProxyType(
    {'eq14': _fill_eq14, 'heel': _fill_heeled, 'stall': _fill_stalling}
)
"""Kind of a law → its formula of values (q,), α, β and sine of the heel (n,), which fills in the
coefficients (n, 6)."""


@dataclass(frozen=True, eq=False)
class TableLaw:
    """Law of a board from its polar: lift, drag and centre of pressure over the attack angle.

    It is interpolated by monotone cubics: they add no peak between points and have a derivative
    everywhere. Straight lines of eq. 14 are corrections to it. Outside the table lift and moments
    fade and drag stays constant.

    Loads of a tilted board are measured along the axes of a flume tank. Most of the upward C_Z is
    the force normal to the board, which tilts with it. So the loads are rotated into the board's
    axes, and the remainder acts along the span. The tilt is the board's attitude, as in the tank.
    """

    polar: Polar

    @property
    def parameters(self) -> BoardParameters:
        """Corrections to the table."""
        return CORRECTED

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest angle of attack (rad) of the table."""
        return float(self.polar.attack[0]), float(self.polar.attack[-1])

    @cached_property
    def cubics(self) -> FloatArray:
        """Cubics (n, 3, 4) of lift, drag and centre of pressure above each point."""
        values = np.stack([self.polar.lift, self.polar.drag, self.polar.ahead], 1)
        return _cubics(self.polar.attack, values)

    @cached_property
    def tilts(self) -> tuple[FloatArray, ...]:
        """Knots (m,) and cubics (m, 5, 4) of heel, then of trim."""
        return *_tilt_table(self.polar.heel), *_tilt_table(self.polar.trim)

    def __call__(
        self,
        values: FloatArray,
        attack: FloatArray | float,
        slip: FloatArray | float,
        lean: FloatArray | float = 0.0,
        rise: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Return force and moment coefficients (..., 6) as `BoardLaw` does."""
        given = attack, slip, lean, rise
        shape = np.broadcast_shapes(*map(np.shape, given))
        values, *angles = promote_dtypes(
            values, *(np.broadcast_to(part, shape).ravel() for part in given)
        )
        coefficients = np.empty((*angles[0].shape, 6), values.dtype)
        _fill_tabled(self.polar.attack, self.cubics, *self.tilts, values, *angles, coefficients)
        return coefficients.reshape(*shape, 6)


def _tilt_table(tilt: Tilt) -> tuple[FloatArray, FloatArray]:
    """Return knots and cubics over the sine of a tilt t.

    Columns are the factor of lift, cos t - 1, sin t, C_Z sin t and C_Z cos t. They have zero slope
    at both ends, so that the derivative is continuous there.
    """
    sine, upward = tilt.sine, tilt.upward
    cosine = np.sqrt(1 - sine**2)
    values = np.stack([tilt.lift_factor, cosine - 1, sine, upward * sine, upward * cosine], 1)
    knots = np.concatenate([[sine[0] - 1], sine, [sine[-1] + 1]])
    return knots, _cubics(knots, np.pad(values, ((1, 1), (0, 0)), 'edge'))


def _cubics(knots: FloatArray, values: FloatArray) -> FloatArray:
    """Return monotone cubics (n, columns, 4) above each knot; the last one is constant."""
    # Imported here: the import is slow, and boards by formula do not need it.
    from scipy.interpolate import PchipInterpolator

    pieces = PchipInterpolator(knots, values).c
    last = np.zeros((1, values.shape[1], 4))
    last[0, :, 3] = values[-1]
    return np.concatenate([np.moveaxis(pieces, 0, -1), last])


@njit_device
def _piece(knots: FloatArray, cubics: FloatArray, which: int, alpha: float) -> float:
    """Return a column of the table at an angle; it is constant below the first point."""
    place = 0
    while place + 1 < len(knots) and knots[place + 1] <= alpha.real:
        place += 1
    along = alpha - knots[place] if alpha.real > knots[0] else 0 * alpha
    c = cubics[place, which]
    value: float = ((c[0] * along + c[1]) * along + c[2]) * along + c[3]
    return value


@njit_device
def _turned(
    knots: FloatArray, cubics: FloatArray, sine: float, force: float
) -> tuple[float, float]:
    """Return the change of a force by a tilt, and the force along the span."""
    own = force * _piece(knots, cubics, 1, sine) + _piece(knots, cubics, 3, sine)
    return own, _piece(knots, cubics, 4, sine) - force * _piece(knots, cubics, 2, sine)


@compiled
def _fill_tabled(
    knots: FloatArray,
    cubics: FloatArray,
    heel: FloatArray,
    heeled: FloatArray,
    trim: FloatArray,
    trimmed: FloatArray,
    values: FloatArray,
    attack: FloatArray,
    slip: FloatArray,
    lean: FloatArray,
    rise: FloatArray,
    coefficients: FloatArray,
) -> None:
    low, high = knots[0], knots[-1]
    for n in range(len(attack)):
        alpha = smooth_clip(attack[n], low, high)
        beta = smooth_clip(slip[n], -SLIP_LIMIT_RAD, SLIP_LIMIT_RAD)
        fade = smoothstep_window(attack[n], low, high)
        lift = _piece(knots, cubics, 0, alpha) + values[2] * alpha + values[3]
        # Drag is the same for flow on either face.
        folded = alpha if attack[n].real >= 0.0 else smooth_clip(-attack[n], low, high)
        drag = _piece(knots, cubics, 1, folded) + values[0] * folded + values[1]
        ahead = _piece(knots, cubics, 2, alpha)
        lift *= _piece(heel, heeled, 0, lean[n]) * _piece(trim, trimmed, 0, rise[n])
        cosine, sine = np.cos(alpha), np.sin(alpha)
        # Heel rotates the force normal to the board, trim the force forward along its chord.
        outward, span = _turned(heel, heeled, lean[n], lift * cosine + drag * sine)
        forward, more = _turned(trim, trimmed, rise[n], lift * sine - drag * cosine)
        lift += outward * cosine + forward * sine
        drag += (outward * sine - forward * cosine) * fade
        span += more
        across = lift * cosine + drag * sine
        coefficients[n, 0] = drag if drag.real > 0.0 else 0 * drag
        coefficients[n, 1] = lift * fade
        # Loads of eq. 12 act downward.
        coefficients[n, 2] = (values[4] * beta - span) * fade + values[5]
        coefficients[n, 3] = (values[6] * alpha + values[7]) * fade
        coefficients[n, 4] = values[8] * beta * fade + values[9]
        # C_z^M of eq. 12 has the opposite sign of the moment of a force ahead of the centre.
        turning = -ahead * across + values[10] * alpha + values[11]
        coefficients[n, 5] = turning * fade
