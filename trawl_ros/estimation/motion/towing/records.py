# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of a tow in motion: means of short stretches, and what the gear was towed with."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.core.files import finite
from trawl_ros.estimation.motion.towing.inputs import TowInputs
from trawl_ros.estimation.motion.towing.linearisation import SLOW_MOTIONS

QUIET_RANGES = np.array([0.3, 0.3, 0.06])
"""Largest ranges of warp lengths (m) and smoothed speed (m/s) through a minute in which they are
held; the log's noise alone makes 0.04 m/s."""


@dataclass(frozen=True)
class LeftOut:
    """Stretches that were left out: from ``begin`` to ``end`` (s since the tow began), and why."""

    begin: float
    end: float
    why: str


@dataclass(frozen=True)
class Oscillation:
    """Oscillation of a channel in a part of a tow.

    Attributes
    ----------
    std
        Standard deviation of the readings about a line through each stretch, SI.
    period_s
        Dominant period, s; NaN if none stands out of white noise.
    """

    std: float
    period_s: float


@dataclass(frozen=True)
class PartStatistics:
    """Statistics of a part of a tow, from ``begin_s`` to ``end_s`` after the tow began."""

    begin_s: float
    end_s: float
    steady: bool
    channels: Mapping[str, Oscillation]

    def record(self) -> dict[str, object]:
        """Record for JSON."""
        return {
            'begin_s': self.begin_s,
            'end_s': self.end_s,
            'steady': self.steady,
            'channels': {
                name: {'std': own.std, 'period_s': finite(own.period_s)}
                for name, own in self.channels.items()
            },
        }


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
    held_s : (n,) array
        Time (s) for which the inputs have been held at the end of each steady stretch, in which the
        gear has settled but for its slowest motion; 0 of moving stretches, and where not given.
    steady_only
        True if moving stretches are not predicted.
    statistics
        Statistics of its steady and moving parts; none where they were not asked for.
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
    held_s: FloatArray = field(default_factory=lambda: np.zeros(0))
    steady_only: bool = False
    statistics: tuple[PartStatistics, ...] = ()

    def __post_init__(self) -> None:
        if not len(self.held_s):
            object.__setattr__(self, 'held_s', np.zeros(len(self)))

    def __len__(self) -> int:
        return len(self.means)

    @property
    def steps(self) -> int:
        """Steps in a stretch."""
        return int(self.weights.shape[2]) - 1

    @property
    def steady(self) -> BoolArray:
        """Flags (n,) of the steady stretches."""
        return np.asarray(self.held_s > 0.0, np.bool_)

    def only_steady(self) -> 'MovingTow':
        """Return the tow without its moving stretches, which are not predicted either."""
        means = np.where(self.steady[:, None], self.means, np.nan)
        return replace(self, means=means, steady_only=True)

    @property
    def starts(self) -> int:
        """Number of slow motions with which its parts may begin: the first, and each steady one."""
        return SLOW_MOTIONS * (1 + int(self.steady_part[-1]) if len(self) else 1)

    @property
    def steady_part(self) -> IntArray:
        """Number (n,) of steady parts that have begun up to each stretch."""
        before = np.concatenate(([False], self.steady[:-1]))
        return np.asarray(np.cumsum(self.steady & ~before), np.int64)

    def is_quiet(self, stretch: int) -> bool:
        """Return True if the inputs are held in a stretch and in the one before."""
        size = self.stretch_s / self.inputs.grid_s
        own = slice(round(max(stretch - 1, 0) * size), round((stretch + 1) * size) + 1)
        ranges = np.ptp(self.inputs.values[own], axis=0)
        return stretch > 0 and bool(np.all(ranges <= QUIET_RANGES))

    def steps_of(self, stretch: int) -> tuple[float, FloatArray]:
        """Step (s) in which a moving stretch is integrated, and weights (k, s + 1) of its instants.

        While inputs are held steps are twice as long: depths change by less than the noise of their
        means for it, and derivatives by 0.5 %.
        """
        weights = self.weights[stretch]
        if self.steps % 2 or not self.is_quiet(stretch):
            return self.step_s, weights
        coarse, between = weights[:, ::2].copy(), 0.5 * weights[:, 1::2]
        coarse[:, :-1] += between
        coarse[:, 1:] += between
        return 2.0 * self.step_s, coarse

    @property
    def middles(self) -> FloatArray:
        """Middles (n,) of the stretches, s since the tow began."""
        return np.asarray((np.arange(len(self)) + 0.5) * self.stretch_s, np.float64)
