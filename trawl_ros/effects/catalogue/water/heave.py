"""Mean drag increase by the ship's heave."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation


class HeaveEffect(Effect):
    """Increase of mean drag, which goes with the mean of the squared speed."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Root-mean-square speed through the water beside both warp lengths."""
        port, starboard, speed = inputs
        return np.array([port, starboard, np.sqrt(speed**2 + values[0])])


EFFECT = HeaveEffect(
    name='heave',
    sentence='Waves pull the gear to and fro, which adds to its mean drag.',
    parameters=(Parameter('variance', 'm²/s²', 0.0, 0.0, 1.5, 0.2),),
    excited_by='a sea; low speed shows it most',
    confused_with=('speed_log',),
    direct="Look up the sea state of the day, or the record of the ship's motion.",
    causes='a swell, a ship that surges on her warps.',
)
