"""Leeway of the ship: she goes to one side of where she heads."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

SURFACE = 5.0
"""Blocks go with the water at the very surface; from here down (m) it goes by askew."""


class Leeway(Effect):
    """Angle by which the ship's way through the water lies to port of her heading."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model behind a ship that the water passes askew, on either course."""
        aside = at.speed * np.tan(values[0])
        current = aside * np.array([np.sin(at.heading), -np.cos(at.heading)])
        water = model.water.with_more_current(
            np.array([0.0, SURFACE]), np.stack([np.zeros(2), current])
        )
        return replace(model, water=water)


EFFECT = Leeway(
    name='leeway',
    sentence='The ship goes through the water to one side of where she heads.',
    parameters=(Parameter('angle', 'rad', 0.0, -0.3, 0.3, 0.05),),
    excited_by='any tow; the block of one side then lies ahead of the other',
    confused_with=('warp_asymmetry', 'cross_current'),
    direct='Compare the course made good in slack water with the heading, and look at the rudder.',
    causes='wind on the beam, rudder held to one side, one warp that pulls more.',
)
