# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Operating point of a steady state, and the command that advises on a refused one."""

import re
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.gear.records import GearRecord
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
    """Return positions (2, 3) of the towing blocks from midway between them, port first, m."""
    to_port = np.array([-np.sin(heading), np.cos(heading), 0.0])
    half = 0.5 * model.gear.block_distance
    return np.stack([half * to_port, -half * to_port])


def steady_tow(model: GearModel, point: OperatingPoint) -> Tow:
    """Return the towing boundary of a steady tow; the ship is at the origin."""
    ahead = np.array([np.cos(point.heading), np.sin(point.heading), 0.0])
    velocity = point.speed * ahead + model.water.surface_current
    return Tow(
        blocks=block_offsets(model, point.heading),
        block_velocities=np.stack([velocity, velocity]),
        lengths=np.array([point.port_length, point.starboard_length]),
        length_rates=np.zeros(2),
    )


def remedy_command(gear: GearRecord, point: OperatingPoint) -> str:
    """Return the sentence that names the command, for the mean length of the warps.

    A gear of the package is named. For another gear the record does not know its file.
    """
    name, file, place = _named(gear, point)
    return f'`trawl gear state {name} {place}`{file} computes what would make it usable'


def trim_command(gear: GearRecord, point: OperatingPoint, attack_deg: float) -> str:
    """Return the sentence that names the command for shackle points at an attack angle (deg)."""
    name, file, place = _named(gear, point)
    command = f'trawl trim {name} --attack {attack_deg:.0f} --inclination 12 {place}'
    return f'`{command}`{file} finds shackle points at which the boards work in this range'


def _named(gear: GearRecord, point: OperatingPoint) -> tuple[str, str, str]:
    """Return the name of a gear, what it stands for, and the options of the operating point."""
    warp = 0.5 * (point.port_length + point.starboard_length)
    named = (gear.name, '') if _packaged(gear.name) else ('GEAR', ' (GEAR is your gear file)')
    return *named, f'--warp {warp:g} --speed {point.speed:g}'


def _packaged(name: str) -> bool:
    if not re.fullmatch(r'\w+', name):
        return False
    try:
        return share_path('config', 'gear', f'{name}.yaml').is_file()
    except TrawlError:
        return False
