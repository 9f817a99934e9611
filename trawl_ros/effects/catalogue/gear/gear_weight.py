"""Weight of boards and clumps beside the stated one."""

from dataclasses import replace
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


class GearWeight(Effect):
    """Additional weight in water at each board and at each lower wing tip."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with heavier boards and clumps; their volume stays."""
        board, clump = values / model.water.gravity
        mass = model.lump_mass.copy()
        foot = model.layout.footrope
        mass[[foot[0], foot[-1]]] += clump
        heavier = model.with_board(mass=model.board.mass + board)
        return replace(heavier, lump_mass=mass)


EFFECT = GearWeight(
    name='gear_weight',
    sentence='Boards or clumps are heavier or lighter in water than the gear file has them.',
    parameters=(
        Parameter('board', 'N', 0.0, -7500.0, 7500.0, 1000.0),
        Parameter('clump', 'N', 0.0, -7500.0, 7500.0, 1000.0),
    ),
    excited_by='low speed',
    confused_with=('depth_sensor',),
    direct='Weigh the clumps, and compare the boards with their drawing: shoes, plates, water in '
    'hollow parts.',
    causes='clumps or chains of another weight, weights bolted to the boards or lost, flooded '
    'hollow boards.',
)
