"""A flat panel of netting in a stream, with the loads that the model gives its sheet."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.netting import NettingRecord, SectionRecord
from trawl_ros.model.bar_pass import water_of
from trawl_ros.model.line import BarMotion, BarProperties, drag
from trawl_ros.model.lump_pass import add_sheet_forces
from trawl_ros.model.net.wake import exposure_of, sheet, viscous, viscous_knots
from trawl_ros.model.water import Water


def panel_loads(
    section: SectionRecord, net: NettingRecord, angle: float, slope: float, speed: float
) -> FloatArray:
    """Drag and lift of a panel over ½ ρ U² and its area of twine.

    Parameters
    ----------
    section, net
        Netting, and the coefficients of its law.
    angle
        Of the bars of diamond meshes against the sheet's length, rad.
    slope
        Of the sheet to the flow, rad.
    speed
        Of the flow, m/s.

    Returns
    -------
    (3,) array
        Drag, lift, and the drag of the knots alone.
    """
    flat = sheet(section, net, angle, slope)
    left, water, diameter = exposure_of(flat, net), Water(), section.twine_diameter_m
    count = len(flat.bars)
    still, one = np.zeros(count), np.full(count, 1.0 / count)
    velocity = -speed * np.array([flat.flow] * count)
    growth = viscous(net, diameter)
    bars = BarProperties(
        stiffness=one,
        damping_time=still,
        mass=still,
        volume=still,
        normal_area=left.normal * one,
        wet_area=np.pi * left.friction * one,
        normal_drag=net.normal_drag * np.ones(count),
        friction=net.friction * np.ones(count),
        added_normal=still,
        added_tangential=still,
        bow=still,
        normal_viscous=growth[0] * np.ones(count),
        friction_viscous=growth[1] * np.ones(count),
    )
    motion = BarMotion(flat.bars, 0.0 * velocity, velocity, still, count * one, still)
    force = drag(bars, motion, flat.bars, water).sum(axis=0)
    pressure = 0.5 * water.density * speed**2
    growing = viscous_knots(net, max(net.knot_diameters, 1e-3) * diameter) / np.sqrt(speed)
    knots = left.knots * flat.knots * (net.knot_drag + growing)
    around, area = np.arange(3)[None], 1.0 / flat.solidity
    total = np.zeros((3, 3))
    add_sheet_forces(
        np.array([[0.0, 0.0, 0.0], [area, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        np.tile(velocity[0], (3, 1)),
        around,
        np.array([[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]),
        np.array([left.lift]),
        np.ones(1),
        water_of(water),
        total,
    )
    force = (force + total[0]) / pressure + knots * flat.flow
    upward = np.array([-flat.flow[2], 0.0, flat.flow[0]])
    return np.array([force @ flat.flow, force @ upward, knots])
