"""Damage of the boards: lift and drag beside those of the boards as they were."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation
from trawl_ros.effects.catalogue.boards.board_rigging import BOTH, PORT, STARBOARD
from trawl_ros.model.hooks import DRAG, LIFT

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


@dataclass(frozen=True)
class Damaged:
    """Coefficient modifier: factors (2, 6) on the coefficients of port and starboard board."""

    factors: FloatArray

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Multiply the coefficients."""
        bent: FloatArray = (coefficients + 0.0 * attack[..., None]) * self.factors
        return bent


@dataclass(frozen=True)
class BoardDamage(Effect):
    """Share of lift and of drag that boards on ``sides`` have beside their law."""

    sides: tuple[int, ...] = BOTH

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with boards of more or less lift and drag."""
        factors = np.ones((2, 6))
        factors[np.ix_(self.sides, (LIFT, DRAG))] += values
        return model.with_modifier(Damaged(factors))


def _damage(name: str, who: str, sides: tuple[int, ...]) -> BoardDamage:
    return BoardDamage(
        name=name,
        sentence=f'{who} another lift or drag than before: bent, torn, or with something on it.',
        parameters=(
            Parameter('lift', '', 0.0, -0.6, 0.6, 0.1),
            Parameter('drag', '', 0.0, -0.6, 1.0, 0.15),
        ),
        excited_by='any tow, beside a baseline of the sound board',
        confused_with=('board_rigging', 'spread_sensor', 'net_drag'),
        direct='Look at the boards when they are up: bent or missing slats, dents, weed, a rope.',
        causes='a bent or missing slat, a dent, a fouled board, one that was exchanged.',
        sides=sides,
    )


EFFECTS = (
    _damage('board_damage', 'Both boards have', BOTH),
    _damage('port_board_damage', 'The port board has', PORT),
    _damage('starboard_board_damage', 'The starboard board has', STARBOARD),
)
