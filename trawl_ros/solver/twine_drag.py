"""Drag of netting by the Reynolds number of its twine, in one steady state.

The gear files have one normal coefficient and one of friction for all twine at all speeds. Choo and
Casarella (1971, Hydrodynamic resistance of towed cables, Journal of Hydronautics 5(4)) give both by
the Reynolds number Re of the motion across the cylinder: C_n = 1.1 + 4 Re^-1/2 for 30 to 100 000,
and a pull π μ (0.55 Re^1/2 + 0.084 Re^2/3) per length and speed along it.
"""

from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.assembly import motion_of, points_of
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.line import tension
from trawl_ros.solver.equilibrium import Equilibrium

VISCOSITY = 1.05e-6
"""Kinematic viscosity of sea water at 20 °C, m²/s."""

LEAST = 30.0
"""Least Reynolds number for which the law holds; below, it is taken as there."""


def normal_coefficient(across: FloatArray) -> FloatArray:
    """C_n by the Reynolds number of the motion across."""
    coefficient: FloatArray = 1.1 + 4.0 / np.sqrt(np.maximum(across, LEAST))
    return coefficient


def friction_coefficient(across: FloatArray, along: FloatArray) -> FloatArray:
    """C_f on the wetted surface by the Reynolds numbers of the motion across and along."""
    across = np.maximum(across, LEAST)
    pull = 0.55 * np.sqrt(across) + 0.084 * across ** (2.0 / 3.0)
    coefficient: FloatArray = 2.0 * pull / np.maximum(along, LEAST)
    return coefficient


def with_twine_drag(
    model: GearModel, found: Equilibrium, viscosity: float = VISCOSITY
) -> GearModel:
    """Copy of a gear whose netting has the drag of its twine's Reynolds numbers in an equilibrium.

    Shielding of the netting stays; ropes and knots keep their coefficients. A kinematic viscosity
    (m²/s) that is larger than that of water stands for a model of the gear.
    """
    net = model.gear.netting
    motion = motion_of(model, points_of(model, found.state, found.tow), found.tow)
    unit = tension(model.bars, motion)[1]
    flow = model.water.current(motion.height) - motion.velocity
    along = np.abs((flow * unit).sum(axis=1))
    across = np.sqrt(np.maximum((flow**2).sum(axis=1) - along**2, 0.0))
    bars, mesh = model.bars, model.net_mesh.bars
    lines = [own for name, _, own in model.layout.lines if name in ('netting', 'codend')]
    numbers = np.concatenate(lines)  # in the order in which the mesh has its bars
    # Of round twines side by side the volume over the area says how thick they are.
    area = np.array([max(bar.area, 1e-12) for bar in mesh])
    thick = 4.0 / np.pi * np.array([bar.volume for bar in mesh]) / area
    cross, sliding = (speed[numbers] * thick / viscosity for speed in (across, along))
    normal, friction = bars.normal_drag.copy(), bars.friction.copy()
    normal[numbers] *= normal_coefficient(cross) / net.normal_drag
    friction[numbers] *= friction_coefficient(cross, sliding) / net.friction
    return replace(
        model,
        bars=replace(bars, normal_drag=normal, friction=friction),
        lump_drag_area=model.lump_drag_area
        * _codend_share(model, found, thick, numbers, viscosity),
    )


def _codend_share(
    model: GearModel, found: Equilibrium, thick: FloatArray, numbers: IntArray, viscosity: float
) -> FloatArray:
    """Drag area (n,) of the nodes of the codend's line over that of the gear file, 1 elsewhere."""
    net, angle = model.gear.netting, np.radians(model.gear.netting.codend_mesh_angle_deg)
    line = np.array([bar.group == 'codend' for bar in model.net_mesh.bars])
    reynolds = found.point.speed * thick[line] / viscosity
    cross, sliding = reynolds * np.sin(angle), reynolds * np.cos(angle)
    cubes = np.sin(angle) ** 3, np.pi * np.cos(angle) ** 3
    law = normal_coefficient(cross), friction_coefficient(cross, sliding)
    shares = np.ones(model.nodes)
    shares[model.ends[numbers[line], 1]] = (law[0] * cubes[0] + law[1] * cubes[1]) / (
        net.normal_drag * cubes[0] + net.friction * cubes[1]
    )
    return shares
