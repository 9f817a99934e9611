"""The canvas kite on the headrope (eq. 29-33)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
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


@dataclass(frozen=True)
class KiteNodes:
    """Carrying nodes of the kite: ``nodes`` (3,) numbers, one of which may be there twice,
    and ``weights`` (2, 3) that make its front and rear carrying points of them.
    """

    nodes: IntArray
    weights: FloatArray

    @cached_property
    def shares(self) -> FloatArray:
        """Share (3,) of the kite's load on each node; both carriers hold half of it."""
        shares: FloatArray = self.weights.mean(axis=0)
        return shares

    @cached_property
    def held(self) -> bool:
        """True if there is a kite."""
        return bool(self.weights.any())


NO_KITE = KiteNodes(np.zeros(3, int), np.zeros((2, 3)))
"""For gear without a kite, whose area and mass are zero as well."""


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
