# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Properties of the water for instruments: pressure, and the speed of sound."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import gsw
import numpy as np

PressureAt = Callable[[float], float]
"""Absolute pressure (Pa) at a depth (m), as `trawl_ros.model.water.Water.pressure`."""

SURFACE_PRESSURE = 101_325.0
DECIBAR = 1e4
DEEPEST = 11_000.0
"""Depth (m) of the deepest ocean, up to which TEOS-10 is valid."""

DEPTH_STEP = 1.0
"""Step (m) of the depths at which the sound speed is computed; it changes by some cm/s over it."""


@dataclass(frozen=True)
class Surroundings:
    """Properties of the water around instruments.

    ``pressure_at`` gives absolute pressure (Pa) at a depth (m). ``temperatures`` are pairs of depth
    (m, rising) and in-situ temperature (°C), straight lines between them; ``salinity`` is
    absolute, g/kg.
    """

    pressure_at: PressureAt
    temperatures: Sequence[tuple[float, float]] = ((0.0, 8.0),)
    salinity: float = 35.0

    def temperature(self, depth: float) -> float:
        """Return the temperature (°C) at a depth (m)."""
        depths, values = zip(*self.temperatures, strict=True)
        return float(np.interp(depth, depths, values))

    def sound_speed(self, depth: float) -> float:
        """Return the speed of sound (m/s) at a depth (m), by TEOS-10, no deeper than `DEEPEST`."""
        if not np.isfinite(depth):
            return float('nan')
        level = DEPTH_STEP * round(min(max(depth, 0.0), DEEPEST) / DEPTH_STEP)
        gauge = (self.pressure_at(level) - SURFACE_PRESSURE) / DECIBAR
        return _sound_speed(self.salinity, self.temperature(level), round(gauge, 3))

    def mean_sound_speed(self, upper: float, lower: float) -> float:
        """Return the mean speed of sound (m/s) on a straight path from one depth (m) to another."""
        levels = np.linspace(upper, lower, 11)
        # Time adds up along the way, so it is the slowness whose mean counts.
        return float(1.0 / np.mean([1.0 / self.sound_speed(level) for level in levels]))


@lru_cache(maxsize=4096)
def _sound_speed(salinity: float, temperature: float, gauge: float) -> float:
    conservative = gsw.CT_from_t(salinity, temperature, gauge)
    return float(gsw.sound_speed(salinity, conservative, gauge))
