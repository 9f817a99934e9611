"""Scale and bias of the speed log."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation


class SpeedLogError(Effect):
    """Speed log that shows (1 + scale) times the speed, and a bias."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Speed without scale and bias, beside both warp lengths."""
        scale, bias = values
        port, starboard, speed = inputs
        return np.array([port, starboard, (speed - bias) / (1.0 + scale)])


EFFECT = SpeedLogError(
    name='speed_log',
    sentence='The log shows too much or too little speed through the water.',
    parameters=(
        Parameter('scale', '', 0.0, -0.4, 0.4, 0.05),
        Parameter('bias', 'm/s', 0.0, -0.8, 0.8, 0.1),
    ),
    excited_by='speed',
    confused_with=('net_drag', 'heave'),
    direct='Run a measured mile in slack water, or compare with speed over ground on reciprocal '
    'tracks.',
    causes='growth on the log, a log that was calibrated for another ship or speed.',
)
