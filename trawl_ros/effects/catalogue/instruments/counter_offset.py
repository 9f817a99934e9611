"""Offset of the warp counters."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation


class CounterOffset(Effect):
    """Offset of both counters against the warp out, m."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Warp lengths without the offset."""
        true: FloatArray = inputs - values[0] * np.array([1.0, 1.0, 0.0])
        return true


EFFECT = CounterOffset(
    name='counter_offset',
    sentence='The winch counters show too much or too little warp, by the same number of metres.',
    parameters=(Parameter('offset', 'm', 0.0, -50.0, 50.0, 10.0),),
    excited_by='warp length',
    confused_with=('counter_scale', 'warp_strumming'),
    direct='Pay out warp to a mark of known distance and read the counters.',
    instrument='counters',
    causes='counters zeroed at another mark, warp that was cut back and not told to the counter.',
)
