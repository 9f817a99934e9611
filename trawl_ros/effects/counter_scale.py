"""Counters that show more or less than the warp that is out, by a part of it."""

import numpy as np

from trawl_ros.effects.effect import Effect, Parameter, Situation


class CounterScale(Effect):
    """Shows (1 + scale) times the warp out, on both sides."""

    def towed(self, values: np.ndarray, inputs: np.ndarray, at: Situation) -> np.ndarray:
        """The warp that is out."""
        port, starboard, speed = inputs
        return np.array([port / (1.0 + values[0]), starboard / (1.0 + values[0]), speed])


EFFECT = CounterScale(
    name='counter_scale',
    sentence='The winch counters show too much or too little warp, by a part of it.',
    parameters=(Parameter('scale', '', 0.0, -0.2, 0.2, 0.03),),
    excited_by='warp length',
    confused_with=('warp_strumming', 'counter_offset'),
    direct='Pay out warp past marks of known distance and read the counters.',
)
