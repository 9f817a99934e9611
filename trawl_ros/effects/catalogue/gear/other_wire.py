"""Warps of another wire than the gear file has."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


@dataclass(frozen=True)
class OtherWire(Effect):
    """Share by which the warps are thicker, and their weight in water with its square."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with warps of another diameter, and as much steel in it."""
        factor = np.where(model.warp_side >= 0, 1.0 + values[0], 1.0)
        bars = model.bars
        thicker = replace(
            bars,
            mass=factor**2 * bars.mass,
            volume=factor**2 * bars.volume,
            stiffness=factor**2 * bars.stiffness,
            normal_area=factor * bars.normal_area,
            wet_area=factor * bars.wet_area,
        )
        return replace(model, bars=thicker)


EFFECT = OtherWire(
    name='other_wire',
    sentence='The warps are of a thicker or thinner wire than the gear file has.',
    parameters=(Parameter('diameter', '', 0.0, -0.3, 0.5, 0.1),),
    excited_by='warp length; low speed shows the weight, high speed the drag',
    confused_with=('warp_strumming', 'counter_scale', 'current_shear'),
    direct='Measure the diameter of both warps with a calliper, and look up the weight per metre.',
    causes='another wire on the drums, one that is worn, or new where the file has the old one.',
)
