"""Rigging of the boards: installation angles beside those of the gear file."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

BOTH, PORT, STARBOARD = (0, 1), (0,), (1,)


@dataclass(frozen=True)
class BoardRigging(Effect):
    """Turn of boards on ``sides`` against their rigging, beside the installation angles."""

    sides: tuple[int, ...] = BOTH

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with boards that hang otherwise in their rigging."""
        turned = np.array(model.board.rerigged)
        turned[list(self.sides)] += values
        port, starboard = (tuple(map(float, own)) for own in turned)
        return model.with_board(rerigged=(port, starboard))


def _rigging(name: str, who: str, sides: tuple[int, ...]) -> BoardRigging:
    return BoardRigging(
        name=name,
        sentence=f'{who} in the rigging otherwise than the gear file says, by these angles.',
        parameters=(
            Parameter('epsilon', 'rad', 0.0, -0.2, 0.2, 0.03),
            Parameter('zeta', 'rad', 0.0, -0.2, 0.2, 0.03),
            Parameter('eta', 'rad', 0.0, -0.2, 0.2, 0.03),
        ),
        excited_by='any tow, beside a baseline of the earlier rigging',
        confused_with=('net_drag', 'spread_sensor', 'board_damage'),
        direct='Hold both boards against the rigging sheet: holes of warp and backstrops, lengths '
        'of the backstrops, wear of the shoes.',
        causes='a shackle in another hole of the warp bracket (ε), an upper or lower backstrop '
        'that was shortened or has stretched (ζ, η), a worn or a new shoe (η).',
        sides=sides,
    )


EFFECTS = (
    _rigging('board_rigging', 'Both boards hang', BOTH),
    _rigging('port_board_rigging', 'The port board hangs', PORT),
    _rigging('starboard_board_rigging', 'The starboard board hangs', STARBOARD),
)
