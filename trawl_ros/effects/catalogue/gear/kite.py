"""Kite that is torn, gone or exchanged."""

from dataclasses import replace
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


class TornKite(Effect):
    """Share of the kite's area that is gone."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with a smaller kite, or a larger one."""
        kite = replace(model.kite, area=model.kite.area * (1.0 - values[0]))
        return replace(model, kite=kite)


EFFECT = TornKite(
    name='kite',
    sentence='The kite is torn or gone, or larger than the gear file has it.',
    parameters=(Parameter('lost', '', 0.0, -2.0, 1.0, 0.3),),
    excited_by='the opening; high speed shows it most',
    confused_with=('floats',),
    direct='Look at the kite on deck: seams, lacing and setting ropes.',
    causes='a torn kite, one that has twisted, parted lacing, another kite.',
)
