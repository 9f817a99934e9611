"""Board stall: loss of lift at high angles of attack."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation
from trawl_ros.model.hooks import LIFT

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

ONSET = np.radians(15.0)
"""Angle of attack (rad) from which lift is lost, with the square of what is above it."""


@dataclass(frozen=True)
class Stalled:
    """Coefficient modifier: lift below its straight line (eq. 14) at high attack."""

    loss: float

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Subtract the loss from C_y^F; drag does not grow by it."""
        above = np.where(np.real(attack) > ONSET, attack - ONSET, 0.0)
        bent = coefficients + 0.0 * attack[..., None]
        bent[..., LIFT] -= self.loss * above**2
        return bent


class BoardStall(Effect):
    """Less lift above 15° of attack."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with boards that stall."""
        return model.with_modifier(Stalled(float(values[0])))


EFFECT = BoardStall(
    name='board_stall',
    sentence='The boards stall: above 15° of attack lift stays behind its straight line.',
    parameters=(Parameter('loss', '1/rad²', 0.0, -4.0, 12.0, 2.0),),
    excited_by='high angles of attack: low speed, long warps',
    direct='Hold the angle of the boards against the rigging sheet, and look at their edges.',
    causes='boards set at a large attack, a worn or bent leading edge, too little weight in the '
    'shoes.',
)
