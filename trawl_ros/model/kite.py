"""The canvas kite on the headrope (eq. 29-33)."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.numerics import angle, dot, length
from trawl_ros.model.water import Water


@dataclass(frozen=True)
class Kite:
    """Properties of a kite: area (m²), mass (kg), volume (m³), setting angle against its two
    carrying nodes (rad), and the constants of its lift and drag law.
    """

    area: float
    mass: float
    volume: float
    setting: float
    lift: float
    drag_base: float
    drag_growth: float


def attack_angle(kite: Kite, front: FloatArray, rear: FloatArray, flow: FloatArray) -> FloatArray:
    """Attack angle a_c (rad): pitch of the line through both carrying nodes in the vertical
    plane (eq. 31), plus the rise of the flow (eq. 32), plus the setting angle.
    """
    chord = front - rear
    pitch = angle(chord[..., 2], length(chord[..., :2], 1e-9))
    rise = angle(flow[..., 2], length(flow[..., :2], 1e-9))
    return pitch + rise + kite.setting


def load(
    kite: Kite,
    front: FloatArray,
    rear: FloatArray,
    front_velocity: FloatArray,
    rear_velocity: FloatArray,
    water: Water,
) -> FloatArray:
    """Force (..., 3) N on the kite: lift against gravity, drag along the flow, weight and
    buoyancy (eq. 30, 33). Its carrying nodes share it equally.

    C_L = ``lift`` sin 2a / 2 and C_D = ``drag_base`` + ``drag_growth`` sin² a: a flat canvas,
    whose constants the gear file states.
    """
    height = 0.5 * (front[..., 2] + rear[..., 2])
    density = water.density_at(height)
    flow = water.current(height) - 0.5 * (front_velocity + rear_velocity)
    attack = attack_angle(kite, front, rear, flow)
    speed = length(flow, 1e-9)
    pressure = 0.5 * density * kite.area
    lift = pressure * 0.5 * kite.lift * np.sin(2 * attack) * dot(flow, flow)
    resistance = pressure * (kite.drag_base + kite.drag_growth * np.sin(attack) ** 2) * speed
    heavy = (kite.mass - density * kite.volume) * water.gravity
    force: FloatArray = resistance[..., None] * flow
    force[..., 2] += lift - heavy
    return force
