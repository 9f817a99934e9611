"""Cross-current below the surface layer."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

ABOVE, BELOW = 20.0, 60.0
"""The surface layer ends between these depths, m."""


class CrossCurrent(Effect):
    """A current across the track, the same below the surface layer and nothing in it."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model in a current to the left of the track."""
        across = values[0] * at.across
        water = model.water.with_more_current(
            np.array([0.0, ABOVE, BELOW]), np.stack([np.zeros(2), np.zeros(2), across])
        )
        return replace(model, water=water)


EFFECT = CrossCurrent(
    name='cross_current',
    sentence="The water below the surface layer moves across the ship's track.",
    parameters=(Parameter('across', 'm/s', 0.0, -0.5, 0.5, 0.1),),
    excited_by='any tow; reciprocal tracks reverse it',
    confused_with=('warp_asymmetry',),
    direct='Look at a current profiler, or at a forecast of currents by depth.',
    causes='a current across the track below the surface layer.',
)
