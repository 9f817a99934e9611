"""The sea: density and current as functions of depth."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.interpolate import PchipInterpolator

ATMOSPHERE = 101_325.0
"""Pressure at the surface, Pa."""


@dataclass(frozen=True)
class Water:
    """Density and current of the water.

    Parameters
    ----------
    density : float
        Density at the surface, kg/m³.
    density_gradient : float
        Its growth with depth, kg/m⁴.
    gravity : float
        m/s².
    depths : (n,) array
        Depths of the current profile, m, rising; empty for still water.
    currents : (n, 2) array
        Current to the east and north at these depths, m/s. Between them it follows a
        monotone cubic, outside it stays constant.
    """

    density: float = 1025.0
    density_gradient: float = 0.0
    gravity: float = 9.80665
    depths: np.ndarray = field(default_factory=lambda: np.empty(0))
    currents: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))
    _profile: tuple[PchipInterpolator, ...] = field(
        init=False, repr=False, compare=False, default=()
    )

    def __post_init__(self) -> None:
        if len(self.depths) > 1:
            profile = PchipInterpolator(self.depths, self.currents)
            object.__setattr__(self, '_profile', (profile, profile.derivative()))

    def with_more_current(self, depths: np.ndarray, currents: np.ndarray) -> 'Water':
        """Return the same sea with another current added to its own.

        Parameters
        ----------
        depths
            Depths of the added current (n,), m, rising; it stays constant above and below.
        currents
            To the east and north there (n, 2), m/s; between them as `Water` has it.
        """
        together = np.union1d(self.depths, depths)
        more = np.column_stack([np.interp(together, depths, column) for column in currents.T])
        return replace(self, depths=together, currents=self.current(-together)[:, :2] + more)

    def density_at(self, z: np.ndarray) -> np.ndarray:
        """Density at height ``z`` (m, up, negative below the surface), kg/m³."""
        return self.density - self.density_gradient * z

    def pressure(self, depth: float) -> float:
        """Absolute pressure (Pa) at a depth (m)."""
        column = self.density * depth + 0.5 * self.density_gradient * depth**2
        return ATMOSPHERE + self.gravity * column

    def depth(self, pressure: float) -> float:
        """Depth (m) at an absolute pressure (Pa), the inverse of `pressure`."""
        column = (pressure - ATMOSPHERE) / self.gravity
        root = np.sqrt(self.density**2 + 2.0 * self.density_gradient * column)
        return float(2.0 * column / (self.density + root))

    def current(self, z: np.ndarray) -> np.ndarray:
        """Velocity of the water at heights ``z``, shape (..., 3), m/s in ``map``."""
        z = np.asarray(z)
        flow = np.zeros(z.shape + (3,), dtype=z.dtype if np.iscomplexobj(z) else float)
        if len(self.depths) == 1:
            flow[..., :2] = self.currents[0]
        elif len(self.depths) > 1:
            depth = np.clip(-np.real(z), self.depths[0], self.depths[-1])
            flow[..., :2] = self._profile[0](depth)
            if np.iscomplexobj(z):
                flow += 1j * np.imag(z)[..., None] * self.current_slope(np.real(z))
        return flow

    def current_slope(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the current by height, shape (..., 3), 1/s."""
        z = np.asarray(z)
        slope = np.zeros(z.shape + (3,))
        if len(self.depths) > 1:
            depth = np.clip(-z, self.depths[0], self.depths[-1])
            inside = (-z > self.depths[0]) & (-z < self.depths[-1])
            slope[..., :2] = -self._profile[1](depth) * inside[..., None]
        return slope
