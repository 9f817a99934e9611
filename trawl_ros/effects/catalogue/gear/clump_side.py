"""Clump that is lighter on one side: lost, or another one."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


@dataclass(frozen=True)
class ClumpSide(Effect):
    """Additional weight in water at the lower wing tip of one side."""

    side: int = 0

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with another clump on this side; its volume stays."""
        mass = model.lump_mass.copy()
        tip = model.layout.footrope[(0, -1)[self.side]]
        mass[tip] += values[0] / model.water.gravity
        return replace(model, lump_mass=mass)


def _clump(side: int, word: str) -> ClumpSide:
    return ClumpSide(
        name=f'{word}_clump',
        sentence=f'The {word} clump is heavier or lighter in water than the gear file has it.',
        parameters=(Parameter('weight', 'N', 0.0, -15000.0, 7500.0, 2000.0),),
        excited_by='low speed; the doors of both sides come to different depths',
        confused_with=('gear_weight', 'warp_asymmetry', f'{word}_bridle_length'),
        direct='Compare the clumps of both sides on deck, and weigh them.',
        causes='a clump or a length of chain lost, one shackled on that belongs to another gear.',
        side=side,
    )


EFFECTS = (_clump(0, 'port'), _clump(1, 'starboard'))
