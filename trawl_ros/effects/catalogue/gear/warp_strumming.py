"""Warp strumming: vortex-induced vibration that raises the drag of the warps."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


class WarpStrumming(Effect):
    """Additional normal drag of the warps."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with scaled normal drag of the warps."""
        factor = np.where(model.warp_side >= 0, values[0], 1.0)
        bars = replace(model.bars, normal_drag=factor * model.bars.normal_drag)
        return replace(model, bars=bars)


EFFECT = WarpStrumming(
    name='warp_strumming',
    sentence='The warps vibrate in the flow, or are fouled, and meet more drag across them.',
    parameters=(Parameter('factor', '', 1.0, 0.7, 2.5, 0.3),),
    excited_by='warp length',
    confused_with=('counter_scale', 'counter_offset', 'current_shear'),
    direct='Lay a hand on the warps at the blocks: strumming is felt; look for weed and grease as '
    'they come in.',
    causes='warps that strum, weed or jellyfish on them, broken strands.',
)
