# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Kites: the canvas kite on the headrope (eq. 29-33), and lifting bodies of given lift on ropes.

The canvas kite is compiled for complex numbers, as the boards' law is.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.bar import SPEED_ROUNDING_M_S
from trawl_ros.model.bar_pass import WaterTable, water_of
from trawl_ros.model.board_law import angle_at
from trawl_ros.model.compiled import as_kind, compiled, stepped_among
from trawl_ros.model.current import current_at
from trawl_ros.model.numerics import ROOT_FLOOR, length
from trawl_ros.model.water import Water


@dataclass(frozen=True)
class Kite:
    """Properties of a kite.

    Attributes
    ----------
    area, mass, volume, setting
        Area (m²), mass (kg), volume (m³) and setting angle (rad).
    pitched
        True if it pitches with the line through its two carrying points.
    normal_slope, normal_limit, drag_base
        Slope (1/rad) and limit of its normal coefficient, and its base drag coefficient.
    """

    area: float
    mass: float
    volume: float
    setting: float
    pitched: bool
    normal_slope: float
    normal_limit: float
    drag_base: float


def build_kite(gear: GearRecord) -> Kite:
    """Return the kite of a gear file; one without area or mass for gear that has none."""
    kite = gear.kite
    if kite is None:
        return Kite(0.0, 0.0, 0.0, 0.0, False, 0.0, 1.0, 0.0)
    return Kite(
        area=kite.area_m2,
        mass=kite.mass_kg,
        volume=kite.volume_m3,
        setting=float(np.radians(kite.setting_deg)),
        pitched=kite.chord_m is not None,
        normal_slope=kite.normal_slope,
        normal_limit=kite.normal_limit,
        drag_base=kite.drag_base,
    )


def attack_angle(kite: Kite, front: FloatArray, rear: FloatArray, flow: FloatArray) -> FloatArray:
    """Return the attack angle a_c (rad).

    It is the sum of the rise of the flow (eq. 32) and the setting angle and, for a pitched kite,
    the pitch of the line through both carrying points in the vertical plane (eq. 31).
    """
    given = front, rear, flow
    attack = np.empty(front.shape[:-1], complex)
    rows = [row.reshape(-1, 3) for row in as_kind(complex, *given)]
    fill_attack_angles(float(kite.setting), kite.pitched, *rows, attack.reshape(-1))
    return attack if stepped_among(*given) else attack.real


@compiled
def fill_attack_angles(
    setting: float,
    pitched: bool,
    front: FloatArray,
    rear: FloatArray,
    flow: FloatArray,
    attack: FloatArray,
) -> None:
    """Fill in the attack angles (n,)."""
    for n in range(len(attack)):
        # Zero times the flow makes the sums complex where the flow is.
        chord, level = ROOT_FLOOR + 0 * flow[n, 0], ROOT_FLOOR + 0 * flow[n, 0]
        for i in range(2):
            chord += (front[n, i] - rear[n, i]) ** 2
            level += flow[n, i] ** 2
        attack[n] = angle_at(flow[n, 2], np.sqrt(level)) + setting
        if pitched:
            attack[n] += angle_at(front[n, 2] - rear[n, 2], np.sqrt(chord))


def load(
    kite: Kite,
    front: FloatArray,
    rear: FloatArray,
    front_velocity: FloatArray,
    rear_velocity: FloatArray,
    water: Water,
) -> FloatArray:
    """Return the force (..., 3) N on the kite: lift, drag, weight and buoyancy (eq. 30, 33).

    Lift acts upward, drag along the flow; both carrying points take half of the force. The
    hydrodynamic force is normal to the canvas: with s = ``normal_slope`` sin a and the limit N,
    C_N = s / (1 + (s / N)⁴)^¼, C_L = C_N cos a and C_D = ``drag_base`` + C_N sin a.
    """
    given = front, rear, front_velocity, rear_velocity
    rows = [row.reshape(-1, 3) for row in as_kind(complex, *given)]
    force = np.empty_like(rows[0])
    constants = kite.setting, kite.area, kite.mass, kite.volume
    law = kite.normal_slope, kite.normal_limit, kite.drag_base
    fill_loads(
        (*map(float, (*constants, *law)),),
        kite.pitched,
        *rows,
        water_of(water),
        force,
    )
    found = force.reshape(front.shape)
    return found if stepped_among(*given) else found.real


@compiled
def fill_loads(
    constants: tuple[float, ...],
    pitched: bool,
    front: FloatArray,
    rear: FloatArray,
    front_velocity: FloatArray,
    rear_velocity: FloatArray,
    water: WaterTable,
    force: FloatArray,
) -> None:
    """Fill in the forces (n, 3) on kites."""
    setting, area, mass, volume, normal_slope, normal_limit, drag_base = constants
    density, gradient, gravity, knots, cubics = water
    flow, attack = np.empty_like(force), np.empty_like(force[:, 0])
    shear = np.empty(3)
    for n in range(len(force)):
        current_at(knots, cubics, 0.5 * (front[n, 2] + rear[n, 2]), flow[n], shear)
        for i in range(3):
            flow[n, i] -= 0.5 * (front_velocity[n, i] + rear_velocity[n, i])
    fill_attack_angles(setting, pitched, front, rear, flow, attack)
    for n in range(len(force)):
        here = density - gradient * 0.5 * (front[n, 2] + rear[n, 2])
        speed_square = flow[n, 0] ** 2 + flow[n, 1] ** 2 + flow[n, 2] ** 2
        pressure = 0.5 * here * area
        straight = normal_slope * np.sin(attack[n])
        # Products and roots: a complex power of a negative number has an imaginary part.
        square = (straight / normal_limit) * (straight / normal_limit)
        normal = straight / np.sqrt(np.sqrt(1.0 + square * square))
        drag = drag_base + normal * np.sin(attack[n])
        for i in range(3):
            force[n, i] = pressure * drag * np.sqrt(speed_square + ROOT_FLOOR) * flow[n, i]
        raised = pressure * normal * np.cos(attack[n]) * speed_square
        force[n, 2] += raised - (mass - here * volume) * gravity


@dataclass(frozen=True)
class LiftingBodies:
    """Node force: lift ½ ρ v² C_L S normal to the flow, in the vertical plane of the flow.

    Attributes
    ----------
    nodes : (k,) array
        Numbers of the nodes, each once.
    area : (k,) array
        C_L S on each of them, m²; negative for depressors.
    water
        Water with its density and currents.
    """

    nodes: IntArray
    area: FloatArray
    water: Water

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the lift on the nodes (k, 3), N."""
        height = positions[..., 2]
        flow = self.water.current(height) - velocities
        speed, level = (length(u, SPEED_ROUNDING_M_S) for u in (flow, flow[..., :2]))
        # Component of the upward unit vector normal to the flow; its length is level / speed.
        upward = np.array([0.0, 0.0, 1.0])
        across = speed[..., None] ** 2 * upward - flow[..., 2:] * flow
        head = 0.5 * self.water.density_at(height) * self.area * speed / level
        lift: FloatArray = head[..., None] * across
        return lift
