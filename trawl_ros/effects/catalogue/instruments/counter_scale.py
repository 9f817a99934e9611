"""Scale error of the warp counters."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation


class CounterScale(Effect):
    """Counters that show (1 + scale) times the warp out, at port more of it than at starboard."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Warp lengths without the scale error."""
        scale, port_more = values
        shown = 1.0 + scale + 0.5 * port_more * np.array([1.0, -1.0])
        return np.append(inputs[:2] / shown, inputs[2])


EFFECT = CounterScale(
    name='counter_scale',
    sentence='The winch counters show too much or too little warp, by a part of it that may differ '
    'between the sides.',
    parameters=(
        Parameter('scale', '', 0.0, -0.2, 0.2, 0.03),
        Parameter('port_more', '', 0.0, -0.05, 0.05, 0.005),
    ),
    excited_by='warp length',
    confused_with=('warp_strumming', 'counter_offset'),
    direct='Pay out warp past marks of known distance and read the counters.',
    instrument='counters',
    causes='a worn or other counting sheave, another wire diameter, layers miscounted on the drum.',
)
