"""Kites and lifting panels on ropes: lift across the flow, whatever way they hang."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.numerics import length
from trawl_ros.model.water import Water

STILL = 1e-6
"""Speed (m/s) below which lift is rounded off, so that its derivative exists."""


@dataclass(frozen=True)
class LiftingBodies:
    """Node force: lift ½ ρ v² C_L S, at right angles to the flow and as far upward as that allows.

    Attributes
    ----------
    nodes : (k,) array
        Numbers of the nodes, each once.
    area : (k,) array
        C_L S on each of them, m²; negative for what dives.
    water
        Its density and currents.
    """

    nodes: IntArray
    area: FloatArray
    water: Water

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Lift on the nodes (k, 3), N."""
        height = positions[..., 2]
        flow = self.water.current(height) - velocities
        speed, level = length(flow, STILL), length(flow[..., :2], STILL)
        # Of the unit vector upward what lies across the flow; its length is level / speed.
        upward = np.array([0.0, 0.0, 1.0])
        across = speed[..., None] ** 2 * upward - flow[..., 2:] * flow
        head = 0.5 * self.water.density_at(height) * self.area * speed / level
        lift: FloatArray = head[..., None] * across
        return lift
