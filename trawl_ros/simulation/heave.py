# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Heave of the ship in waves, as a sum of sines."""

import math
from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import FloatArray

COMPONENTS = 100
"""Number of sines of an irregular heave.

They have equal energy and random frequencies, so that the heave does not repeat itself.
"""

HIGHEST_TO_PEAK_FREQUENCY = 2.0
"""Highest frequency of an irregular heave over that of the spectrum's peak.

Shorter waves do not lift a ship of usual length.
"""


@dataclass(frozen=True)
class Heave:
    """Height of the towing blocks above their mean, as a function of time.

    Its sines have ``amplitudes`` (m), ``frequencies`` (rad/s) and ``phases`` (rad) of shape (n,); a
    calm sea has none. It begins at ``begin`` (s since the start of the trial) and grows to its full
    size in ``growth`` s. Growth is smooth to the second derivative, so that it does not jerk the
    warps.
    """

    amplitudes: FloatArray = field(default_factory=lambda: np.empty(0))
    frequencies: FloatArray = field(default_factory=lambda: np.empty(0))
    phases: FloatArray = field(default_factory=lambda: np.empty(0))
    begin: float = 0.0
    growth: float = 30.0

    @property
    def shortest_period(self) -> float:
        """Shortest period of its sines, s; infinite in a calm sea."""
        return 2 * math.pi / float(self.frequencies.max()) if len(self.frequencies) else math.inf

    def at(self, time: float) -> tuple[float, float]:
        """Return height (m) and vertical velocity (m/s) at a time (s since the trial's start)."""
        x = (time - self.begin) / self.growth
        if x <= 0.0 or not len(self.frequencies):
            return 0.0, 0.0
        angles = self.frequencies * (time - self.begin) + self.phases
        height = float(self.amplitudes @ np.sin(angles))
        rate = float((self.amplitudes * self.frequencies) @ np.cos(angles))
        if x >= 1.0:
            return height, rate
        grown = x**3 * (10 - 15 * x + 6 * x**2)
        growing = 30 * x**2 * (1 - x) ** 2 / self.growth
        return grown * height, grown * rate + growing * height


def regular_heave(height: float, period: float, *, begin: float, growth: float) -> Heave:
    """Return one sine of a ``height`` from trough to crest (m) and a ``period`` (s)."""
    return Heave(
        np.array([0.5 * height]), np.array([2 * math.pi / period]), np.zeros(1), begin, growth
    )


def irregular_heave(
    height: float, period: float, draws: np.random.Generator, *, begin: float, growth: float
) -> Heave:
    """Return a heave with the spectrum of Bretschneider (1959), as used by ITTC and ISSC.

    S(ω) = (5/16) H² ω_p⁴ ω⁻⁵ exp(−1.25 (ω_p/ω)⁴); the part of the energy below ω is
    exp(−1.25 (ω_p/ω)⁴). The spectrum ends at `HIGHEST_TO_PEAK_FREQUENCY` ω_p; the remainder is
    scaled to the given height.

    Parameters
    ----------
    height
        Significant height of the heave (m): four standard deviations.
    period
        Period at the spectrum's peak as encountered by the ship, s.
    draws
        Generator of frequencies and phases.
    begin, growth
        Times as in `Heave`.
    """
    # One random frequency in each of equal parts of the cumulative energy.
    below = (np.arange(COMPONENTS) + draws.random(COMPONENTS)) / COMPONENTS
    below *= math.exp(-1.25 / HIGHEST_TO_PEAK_FREQUENCY**4)
    return Heave(
        amplitudes=np.full(COMPONENTS, 0.25 * height * math.sqrt(2 / COMPONENTS)),
        frequencies=2 * math.pi / period * (1.25 / -np.log(below)) ** 0.25,
        phases=draws.uniform(0.0, 2 * math.pi, COMPONENTS),
        begin=begin,
        growth=growth,
    )
