"""Floats that are lost or flooded."""

from dataclasses import replace
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


class LostFloats(Effect):
    """Share of all floats that is gone, with their drag."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with fewer floats, or more."""
        mass, volume, drag_area, added = values[0] * model.floats
        return replace(
            model,
            lump_mass=model.lump_mass - mass,
            lump_volume=model.lump_volume - volume,
            lump_drag_area=model.lump_drag_area - drag_area,
            lump_added=model.lump_added - added,
        )


EFFECT = LostFloats(
    name='floats',
    sentence='Some of the floats are gone, or more were set than the gear file has.',
    parameters=(Parameter('lost', '', 0.0, -0.6, 1.0, 0.15),),
    excited_by='the opening; low speed shows it most',
    confused_with=('gear_weight', 'bridle_length', 'kite'),
    direct='Count the floats on deck, and weigh one in each hand: flooded ones are heavy.',
    causes='floats torn off, crushed or flooded in deep tows, others of another size.',
)
