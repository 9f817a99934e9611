"""Added mass of the boards."""

from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


class BoardAddedMass(Effect):
    """Added mass across the board's face, as a share of the water in a cylinder around it."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with the boards' added mass."""
        board = model.board
        cylinder = 0.25 * np.pi * model.water.density * board.chord**2 * board.span
        return model.with_board(added_mass=board.added_mass + values[0] * cylinder * np.eye(3)[1])


EFFECT = BoardAddedMass(
    name='board_added_mass',
    sentence='The boards carry water along when they are accelerated.',
    parameters=(Parameter('part', '', 0.0, 0.0, 2.0, 0.5),),
    excited_by='turns and hauling; no steady tow shows it',
    dynamic=True,
)
