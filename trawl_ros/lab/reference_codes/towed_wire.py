# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Towed wire of the comparisons: its properties and its steady state."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class TowedWire:
    """Wire towed at its upper end with a lump at its lower end.

    Attributes
    ----------
    length
        Unstretched, m.
    diameter
        m.
    weight_in_water
        N/m.
    stiffness
        EA, N.
    damping_time
        Inner damping as a time, s: tension grows by EA times this per 1/s of strain rate.
    normal_drag, tangential_drag
        On the frontal area d and the wetted surface π d.
    added_normal
        Added mass across the wire, share of the displaced mass; there is none along it.
    lump_mass, lump_volume, lump_drag_area, lump_added
        kg, m³, C_D A in m², and added mass as a share of the displaced mass.
    density, gravity
        Of the water, kg/m³, and m/s².
    speed
        Of the tow, m/s.
    """

    length: float = 600.0
    diameter: float = 0.032
    weight_in_water: float = 28.0
    stiffness: float = 4e7
    damping_time: float = 0.001
    normal_drag: float = 1.2
    tangential_drag: float = 0.02
    added_normal: float = 1.0
    lump_mass: float = 2000.0
    lump_volume: float = 0.25
    lump_drag_area: float = 12.0
    lump_added: float = 0.5
    density: float = 1025.0
    gravity: float = 9.80665
    speed: float = 2.0

    @property
    def area(self) -> float:
        """Cross-section that displaces water, m²."""
        return pi / 4 * self.diameter**2

    @property
    def mass(self) -> float:
        """Mass in air, kg/m."""
        return self.weight_in_water / self.gravity + self.density * self.area


WIRE = TowedWire()


@dataclass(frozen=True)
class WireSteadyState:
    """Steady state: lump's place, m below and astern of the block, and tension there, N."""

    depth: float
    lag: float
    tension: float


UNITS: Mapping[str, str] = {'depth': 'm', 'lag': 'm', 'tension': 'N'}
"""Unit of each number of a steady state."""

INTEGRATED = WireSteadyState(depth=335.307, lag=498.191, tension=41_042.0)
"""Steady state of `WIRE` by integration of the equation of an elastic wire."""
