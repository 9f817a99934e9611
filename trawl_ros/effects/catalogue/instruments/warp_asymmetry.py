"""Asymmetry of the warps that the counters do not show."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation


class WarpAsymmetry(Effect):
    """Port warp longer than shown, and starboard warp shorter by as much."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """True warp lengths beside the speed."""
        true: FloatArray = inputs + 0.5 * values[0] * np.array([1.0, -1.0, 0.0])
        return true


EFFECT = WarpAsymmetry(
    name='warp_asymmetry',
    sentence='One warp is longer than the other, though the counters do not show it.',
    parameters=(Parameter('port_longer', 'm', 0.0, -15.0, 15.0, 3.0),),
    excited_by='any tow, short warps most',
    confused_with=('cross_current',),
    direct='Pay out both warps to marks of the same distance and compare the counters.',
    causes='warps that stretched unequally, one that was cut back, marks set wrongly.',
)
