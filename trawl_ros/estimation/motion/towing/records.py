"""Records of a tow in motion: means of short stretches, and what the gear was towed with."""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.estimation.motion.towing.inputs import TowInputs

SETTLING_S = 300.0
"""Time that a tow which is begun anew is given before its stretches count: by then the slowest
motion, which is unknown there, has faded."""


@dataclass(frozen=True)
class LeftOut:
    """Stretches that were left out: from ``begin`` to ``end`` (s since the tow began), and why."""

    begin: float
    end: float
    why: str


@dataclass(frozen=True)
class MovingTow:
    """Tow in n stretches of equal length, each a whole number s of the steps it is towed in.

    Attributes
    ----------
    name
        For people.
    start_ns
        Stamp of its beginning.
    step_s, stretch_s
        Step in which it is towed; length of a stretch.
    channels
        Names of the k measured channels.
    means : (n, k) array
        Means of the readings (SI), NaN where a stretch has none that can be used.
    noise : (n, k) array
        Standard errors of the means from the scatter within the stretch, NaN as above.
    counts : (n, k) int array
        Readings in the means.
    weights : (n, k, s + 1) array
        Weights of the instants of a stretch in the mean of its readings, which come at their own
        times; they sum to 1.
    inputs
        Warp lengths and speed.
    left_out
        Stretches without any mean, and why.
    fallen
        Numbers of the stretches in which a board has fallen; they do not count.
    swell
        Swing of the tension within stretches, in std over its mean; 0 where no swell is felt.
    """

    name: str
    start_ns: int
    step_s: float
    stretch_s: float
    channels: tuple[str, ...]
    means: FloatArray
    noise: FloatArray
    counts: IntArray
    weights: FloatArray
    inputs: TowInputs
    left_out: tuple[LeftOut, ...] = ()
    fallen: tuple[int, ...] = ()
    swell: float = 0.0

    def __len__(self) -> int:
        return len(self.means)

    @property
    def steps(self) -> int:
        """Steps in a stretch."""
        return int(self.weights.shape[2]) - 1

    @property
    def standing(self) -> BoolArray:
        """Flags (n,) of the stretches in which no board has fallen, nor shortly before."""
        flags = np.ones(len(self), dtype=np.bool_)
        for stretch in self.fallen:
            flags[stretch : stretch + 1 + math.ceil(SETTLING_S / self.stretch_s)] = False
        return flags

    @property
    def middles(self) -> FloatArray:
        """Middles (n,) of the stretches, s since the tow began."""
        return np.asarray((np.arange(len(self)) + 0.5) * self.stretch_s, np.float64)
