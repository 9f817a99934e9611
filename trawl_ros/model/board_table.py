"""The law of a board from a table: lift, drag and centre of pressure over the angle of attack.

Between its points the table follows monotone cubics, so that it has no peak that was not measured
and a derivative everywhere. The straight lines of eq. 14 are added as corrections, which
identification refits. Outside the table lift and moments fade and drag stays, as those of
`board_law` do outside the range of eq. 14.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.polars import Polar
from trawl_ros.model.board_law import SLIP_LIMIT, fading, settled
from trawl_ros.model.compiled import alike, compiled, inner


@dataclass(frozen=True, eq=False)
class TableLaw:
    """Law of a board that follows a polar."""

    polar: Polar

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest angle of attack (rad) of the table."""
        return float(self.polar.attack[0]), float(self.polar.attack[-1])

    @cached_property
    def cubics(self) -> FloatArray:
        """Polynomials (n, 3, 4) of lift, drag and centre of pressure behind each point, the last
        being constant.
        """
        # Imported here: it takes long, and boards by formula have no use for it.
        from scipy.interpolate import PchipInterpolator

        values = np.stack([self.polar.lift, self.polar.drag, self.polar.ahead], 1)
        pieces = PchipInterpolator(self.polar.attack, values).c
        last = np.zeros((1, 3, 4))
        last[0, :, 3] = values[-1]
        return np.concatenate([np.moveaxis(pieces, 0, -1), last])

    def __call__(self, values: FloatArray, attack: FloatArray, slip: FloatArray) -> FloatArray:
        """Force and moment coefficients (..., 6), as `board.coefficients_at` has them."""
        shape = np.broadcast_shapes(np.shape(attack), np.shape(slip))
        values, *angles = alike(
            values, *(np.broadcast_to(given, shape).ravel() for given in (attack, slip))
        )
        coefficients = np.empty((*angles[0].shape, 6), values.dtype)
        _fill(self.polar.attack, self.cubics, values, *angles, coefficients)
        return coefficients.reshape(*shape, 6)


@inner
def _piece(knots: FloatArray, cubics: FloatArray, which: int, alpha: float) -> float:
    """A column of the table at an angle; constant ahead of its first point."""
    place = 0
    while place + 1 < len(knots) and knots[place + 1] <= alpha.real:
        place += 1
    along = alpha - knots[place] if alpha.real > knots[0] else 0 * alpha
    c = cubics[place, which]
    value: float = ((c[0] * along + c[1]) * along + c[2]) * along + c[3]
    return value


@compiled
def _fill(
    knots: FloatArray,
    cubics: FloatArray,
    values: FloatArray,
    attack: FloatArray,
    slip: FloatArray,
    coefficients: FloatArray,
) -> None:
    low, high = knots[0], knots[-1]
    for n in range(len(attack)):
        alpha = settled(attack[n], low, high)
        beta = settled(slip[n], -SLIP_LIMIT, SLIP_LIMIT)
        fade = fading(attack[n], low, high)
        lift = _piece(knots, cubics, 0, alpha) + values[2] * alpha + values[3]
        # Flow on the inner face meets as much board as on the outer.
        folded = alpha if attack[n].real >= 0.0 else settled(-attack[n], low, high)
        drag = _piece(knots, cubics, 1, folded) + values[0] * folded + values[1]
        ahead = _piece(knots, cubics, 2, alpha)
        across = lift * np.cos(alpha) + drag * np.sin(alpha)
        coefficients[n, 0] = drag if drag.real > 0.0 else 0 * drag
        coefficients[n, 1] = lift * fade
        coefficients[n, 2] = values[4] * beta * fade + values[5]
        coefficients[n, 3] = (values[6] * alpha + values[7]) * fade
        coefficients[n, 4] = values[8] * beta * fade + values[9]
        # C_z^M of eq. 12 turns the other way than a force ahead of the centre of gravity does.
        turning = -ahead * across + values[10] * alpha + values[11]
        coefficients[n, 5] = turning * fade
