# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sea water: density and current as functions of depth."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.records import GearRecord

ATMOSPHERE_PA = 101_325.0
"""Pressure at the surface, Pa."""


@dataclass(frozen=True)
class Water:
    """Density and current of the water.

    Parameters
    ----------
    density : float
        Density at the surface, kg/m³.
    density_gradient : float
        Increase of the density with depth, kg/m⁴.
    gravity : float
        m/s².
    depths : (n,) array
        Depths of the current profile, m, rising; empty for still water.
    currents : (n, 2) array
        Current to the east and north at these depths, m/s. It is interpolated by monotone cubics,
        and constant outside them.
    """

    density: float = 1025.0
    density_gradient: float = 0.0
    gravity: float = 9.80665
    depths: FloatArray = field(default_factory=lambda: np.empty(0))
    currents: FloatArray = field(default_factory=lambda: np.empty((0, 2)))

    @cached_property
    def profile(self) -> tuple[FloatArray, FloatArray]:
        """Current for compiled loops: depths (k,), and cubics (k, 2, 4) of both currents.

        Each cubic is a function of the depth below its own, highest power first.
        """
        # Imported here: instruments need pressures and depths only, and should not load numba.
        from trawl_ros.model.current import fill_cubics

        knots = np.zeros(1) if len(self.depths) == 0 else np.ascontiguousarray(self.depths, float)
        cubics = np.zeros((len(knots), 2, 4))
        cubics[: len(self.currents), :, 3] = self.currents
        if len(self.depths) > 1:
            fill_cubics(knots, np.ascontiguousarray(self.currents, float), cubics[:-1])
        return knots, cubics

    def with_more_current(self, depths: FloatArray, currents: FloatArray) -> 'Water':
        """Return the same sea with another current added to its own.

        Parameters
        ----------
        depths
            Depths of the added current (n,), m, rising; it is constant above and below.
        currents
            Current to the east and north at these depths (n, 2), m/s.
        """
        together = np.union1d(self.depths, depths)
        more = np.column_stack([np.interp(together, depths, column) for column in currents.T])
        return replace(self, depths=together, currents=self.current(-together)[:, :2] + more)

    def density_at(self, z: FloatArray) -> FloatArray:
        """Return the density at height ``z`` (m, up, negative below the surface), kg/m³."""
        return self.density - self.density_gradient * z

    def pressure(self, depth: float) -> float:
        """Return the absolute pressure (Pa) at a depth (m)."""
        column = self.density * depth + 0.5 * self.density_gradient * depth**2
        return ATMOSPHERE_PA + self.gravity * column

    def depth(self, pressure: float) -> float:
        """Return the depth (m) at an absolute pressure (Pa), the inverse of `pressure`."""
        column = (pressure - ATMOSPHERE_PA) / self.gravity
        root = np.sqrt(self.density**2 + 2.0 * self.density_gradient * column)
        return float(2.0 * column / (self.density + root))

    def current(self, z: FloatArray) -> FloatArray:
        """Return the velocity of the water at heights ``z``, shape (..., 3), m/s in ``map``."""
        return self._currents_at(z)[0]

    @cached_property
    def surface_current(self) -> FloatArray:
        """Velocity (3,) of the water at the surface, m/s in ``map``."""
        return self.current(np.array(0.0))

    def current_slope(self, z: FloatArray) -> FloatArray:
        """Return the derivative of the current by height, shape (..., 3), 1/s."""
        return self._currents_at(z)[1]

    def _currents_at(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        # Imported here, as in `profile`.
        from trawl_ros.model.compiled import promote_dtypes
        from trawl_ros.model.current import fill_currents

        (flat,) = promote_dtypes(np.ravel(z))
        flow, slope = np.empty((len(flat), 3), flat.dtype), np.empty((len(flat), 3))
        fill_currents(*self.profile, flat, flow, slope)
        return flow.reshape(*np.shape(z), 3), slope.reshape(*np.shape(z), 3)


def build_water(gear: GearRecord) -> Water:
    """Return the water of a gear file."""
    levels = gear.water.current
    return Water(
        density=gear.water.density_kg_m3,
        density_gradient=gear.water.density_gradient_kg_m4,
        gravity=gear.water.gravity_m_s2,
        depths=np.array([level.depth_m for level in levels]),
        currents=np.array([[level.east_m_s, level.north_m_s] for level in levels]).reshape(-1, 2),
    )
