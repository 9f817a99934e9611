# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Law of a board from a table: lift, drag and centre of pressure over the angle of attack.

The table is interpolated by monotone cubics: they add no peak between its points and have a
derivative everywhere. The straight lines of eq. 14 are corrections to the table, which
identification fits. Outside the table lift and moments fade and drag stays constant, as in
`board_law` outside the range of eq. 14.

Loads of a tilted board are measured along the axes of a flume tank. Most of the upward C_Z is the
force normal to the board, which tilts with it. So the loads are rotated into the board's axes, and
the remainder acts along the span. The tilt is the board's attitude, as in the tank.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.polars import Polar, Tilt
from trawl_ros.model.board_law import SLIP_LIMIT_RAD, smooth_clip, smoothstep_window
from trawl_ros.model.compiled import compiled, njit_device, promote_dtypes


@dataclass(frozen=True, eq=False)
class TableLaw:
    """Law of a board from its polar."""

    polar: Polar

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
        attack: FloatArray,
        slip: FloatArray,
        lean: FloatArray | float = 0.0,
        rise: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Return force and moment coefficients (..., 6) as `board.coefficients_at` does.

        ``lean`` and ``rise`` (...) are the vertical parts of the outward normal and the forward
        axis, the sines of heel and trim.
        """
        given = attack, slip, lean, rise
        shape = np.broadcast_shapes(*map(np.shape, given))
        values, *angles = promote_dtypes(
            values, *(np.broadcast_to(part, shape).ravel() for part in given)
        )
        coefficients = np.empty((*angles[0].shape, 6), values.dtype)
        _fill(self.polar.attack, self.cubics, *self.tilts, values, *angles, coefficients)
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
def _fill(
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
