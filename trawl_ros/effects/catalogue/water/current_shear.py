"""Current shear along the ship's track."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

PER = 100.0
"""Depth (m) over which a shear is stated."""

DEEP = 2000.0
"""Below this depth (m) the current stays what it is."""


class CurrentShear(Effect):
    """Current linear in depth, zero at the surface."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model in a sheared current along the track."""
        bottom = values[0] * DEEP / PER * at.along
        water = model.water.with_more_current(
            np.array([0.0, DEEP]), np.stack([np.zeros(2), bottom])
        )
        return replace(model, water=water)


EFFECT = CurrentShear(
    name='current_shear',
    sentence="The water moves along the ship's track, and the faster, the deeper it is.",
    parameters=(Parameter('along', 'm/s per 100 m', 0.0, -0.2, 0.2, 0.03),),
    excited_by='warp length and speed; reciprocal tracks reverse it',
    confused_with=('warp_strumming', 'counter_scale'),
    direct='Look at a current profiler, or at a forecast of currents by depth.',
    causes='a current that differs with depth, as below a thermocline or over a slope.',
)
