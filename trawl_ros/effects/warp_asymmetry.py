"""Warps that are not equally long though their counters say so."""

import numpy as np

from trawl_ros.effects.effect import Effect, Parameter, Situation


class WarpAsymmetry(Effect):
    """The port warp is longer than shown, and the starboard one shorter by as much."""

    def towed(self, values: np.ndarray, inputs: np.ndarray, at: Situation) -> np.ndarray:
        """The warps that are out."""
        return inputs + 0.5 * values[0] * np.array([1.0, -1.0, 0.0])


EFFECT = WarpAsymmetry(
    name='warp_asymmetry',
    sentence='One warp is longer than the other, though the counters do not show it.',
    parameters=(Parameter('port_longer', 'm', 0.0, -15.0, 15.0, 3.0),),
    excited_by='any tow, short warps most',
    confused_with=('cross_current',),
    direct='Pay out both warps to marks of the same distance and compare the counters.',
)
