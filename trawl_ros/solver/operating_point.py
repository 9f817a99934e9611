"""Operating point of a steady state: warp lengths, speed through the water, heading."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import Tow


@dataclass(frozen=True)
class OperatingPoint:
    """Operating point: warp lengths (m), speed through the surface water (m/s), heading (rad)."""

    port_length: float
    starboard_length: float
    speed: float
    heading: float = 0.0


def block_offsets(model: GearModel, heading: float) -> FloatArray:
    """Positions (2, 3) of the towing blocks from midway between them, port first, m."""
    to_port = np.array([-np.sin(heading), np.cos(heading), 0.0])
    half = 0.5 * model.gear.block_distance
    return np.stack([half * to_port, -half * to_port])


def steady_tow(model: GearModel, point: OperatingPoint) -> Tow:
    """Towing boundary of a steady tow at an operating point; the ship is at the origin."""
    ahead = np.array([np.cos(point.heading), np.sin(point.heading), 0.0])
    velocity = point.speed * ahead + model.water.surface_current
    return Tow(
        blocks=block_offsets(model, point.heading),
        block_velocities=np.stack([velocity, velocity]),
        lengths=np.array([point.port_length, point.starboard_length]),
        length_rates=np.zeros(2),
    )
