# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drag of twine and knots: reduction in sheets of netting, increase at low Reynolds numbers Re.

Twines lie in each other's wakes, and the water speeds up between them. Along a sheet the water has
1 - a of its speed, through it 1 - b, which the twines increase by 1 / (1 - S), with the solidity S.
The sheet takes the momentum that the water loses. Water passes through the sheet, which has the
slope θ to the flow, by its mean motion and by turbulent exchange e:

    S C_t = 4 a cos θ ((1 - b) sin θ + e),   S C_n = 4 b sin θ ((1 - b) sin θ + e)

C_t and C_n are the loads along and across the sheet per area of twine. Across the flow this is
Taylor's screen (1944); e is chosen by panels that lie along the flow (config/panels).

At low Reynolds numbers the drag increases. Across a cylinder C_n is 1.1 + 4 Re^-1/2, with Re of the
motion across. The laminar part of the pull along it is π μ 0.55 Re^1/2 U_t per length (Choo and
Casarella 1971, Hydrodynamic resistance of towed cables, Journal of Hydronautics 5(4)). Both go with
the root of the motion across, so that the loops over bars need one more root and no Reynolds
number. Knots are taken as spheres (Balash et al. 2009): C_D goes with 0.4 + 6 / (1 + Re^1/2), about
0.4 (1 + 15 Re^-1/2).
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import pi, radians, sqrt

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.netting import NettingRecord, SectionRecord


@dataclass(frozen=True)
class FixedPoint:
    """Options of the fixed-point iteration of water speed and loads.

    Attributes
    ----------
    iterations
        Greatest number of iterations.
    relaxation
        Part of each change that is applied.
    tolerance
        Change of the speeds, relative to the undisturbed speed, at which it ends.
    """

    iterations: int = 500
    relaxation: float = 0.2
    tolerance: float = 1e-9


WATER_ITERATION = FixedPoint()

KINEMATIC_VISCOSITY_M2_S = 1.36e-6
"""Kinematic viscosity of sea water of 35 g/kg at 10 °C, m²/s (ITTC 7.5-02-01-03)."""

ACROSS_GROWTH, ALONG_GROWTH, KNOT_GROWTH = 4.0, 1.1, 15.0
"""Factors of Re^-1/2 in C_n across, of Re^1/2 over Re of the motion along in the friction of the
wetted surface, and of Re^-1/2 in C_D of knots over its value at high Re.
"""

LOOKUP_SLOPE_RAD = 0.1
"""Slope (rad) at which the lift of bars is looked up."""

LEAST_LIFT = 0.01
"""Lift of a sheet per outline area and slope, over ½ ρ U², below which it is left out."""

MAX_SOLIDITY = 0.9
"""Solidity that denser netting is taken to have."""


@dataclass(frozen=True)
class Exposure:
    """Drag in a sheet over the drag of single twines and knots, and the coefficient κ of its lift.

    Drag is that across twines, by friction along them, and on knots, without the twine that knots
    hide.
    """

    normal: float = 1.0
    friction: float = 1.0
    knots: float = 1.0
    lift: float = 0.0


@dataclass(frozen=True)
class Sheet:
    """Sheet of netting.

    Attributes
    ----------
    bars : (n, 3) array
        Unit vectors along its bars, in axes along, around and across the sheet.
    slope, solidity, knots
        Slope to the flow (rad), solidity, and area of knots per area of twine.
    """

    bars: FloatArray
    slope: float
    solidity: float
    knots: float

    @property
    def flow(self) -> FloatArray:
        """Direction (3,) of the undisturbed flow."""
        return np.array([np.cos(self.slope), 0.0, np.sin(self.slope)])


def bar_angle(section: SectionRecord, net: NettingRecord) -> float:
    """Return the angle (rad) of the bars of a section of diamond meshes against its length."""
    angle = section.mesh_angle_deg
    return radians(net.codend_mesh_angle_deg if angle is None else angle)


def sheet_of(section: SectionRecord, net: NettingRecord, closing: float) -> Sheet:
    """Return the sheet of a section as drawn: a cone opened by the angle of its bars.

    A net that is closed behind passes the water at its end through the netting too, as a cone does
    whose circumference shrinks by ``closing`` more per length.
    """
    angle = 0.25 * pi if section.square else bar_angle(section, net)
    opening = 1.0 if section.square else np.tan(angle)
    narrowing = section.front_circumference_m - section.back_circumference_m
    narrowing = max(narrowing / section.length_m + closing, 0.0)
    slope = np.arctan(narrowing * opening / (2.0 * pi))
    return sheet(section, net, angle, float(slope))


def sheet(section: SectionRecord, net: NettingRecord, angle: float, slope: float) -> Sheet:
    """Return the sheet of a section's netting at a bar angle (rad) and a slope (rad)."""
    bar, diameter = 0.5 * section.mesh_m, section.twine_diameter_m
    solidity = 2.0 * section.twines * diameter / (bar * np.sin(2.0 * angle))
    bars = [(np.cos(angle), sign * np.sin(angle), 0.0) for sign in (1.0, -1.0)]
    knot = 0.0 if section.knotless else net.knot_diameters
    return Sheet(
        bars=np.eye(3)[:2] if section.square else np.array(bars),
        slope=slope,
        solidity=min(float(solidity), MAX_SOLIDITY),
        knots=pi / 8.0 * knot**2 * diameter / bar,
    )


def loads(net: NettingRecord, sheet: Sheet, flow: FloatArray) -> FloatArray:
    """Return loads (3, 3) across twines, along them, and on knots, per ½ ρ and area of twine.

    ``flow`` (3,) is the velocity of the water at the twines over the undisturbed speed.
    """
    along = sheet.bars @ flow
    across = flow - along[:, None] * sheet.bars
    speeds = np.linalg.norm(across, axis=1)
    share = 1.0 / len(sheet.bars)
    return np.array(
        [
            share * net.normal_drag * (speeds[:, None] * across).sum(axis=0),
            share * net.friction * pi * (np.abs(along) * along) @ sheet.bars,
            net.knot_drag * sheet.knots * np.linalg.norm(flow) * flow,
        ]
    )


def slowed(net: NettingRecord, sheet: Sheet, options: FixedPoint = WATER_ITERATION) -> FloatArray:
    """Return the velocity (3,) of the water at the twines over the undisturbed speed."""
    cosine, _, sine = sheet.flow
    lost = np.zeros(2)
    for _ in range(options.iterations):
        left = 1.0 - lost
        flow = np.array([left[0] * cosine, 0.0, left[1] * sine / (1.0 - sheet.solidity)])
        load = sheet.solidity * loads(net, sheet, flow).sum(axis=0)[[0, 2]]
        passing = 4.0 * (left[1] * sine + net.wake_exchange)
        taken = load / np.maximum(passing * np.array([cosine, sine]), 1e-12)
        change = np.minimum(taken, 0.95) - lost
        lost += options.relaxation * change
        if np.abs(change).max() < options.tolerance:
            break
    return flow


def exposure_of(sheet: Sheet, net: NettingRecord) -> Exposure:
    """Return the exposure of a sheet of netting.

    The lift of a panel goes with the square of its solidity (`NettingRecord.lift`); the part that
    its bars have already is subtracted.
    """
    flow = sheet.flow
    single, left = (loads(net, sheet, motion) @ flow for motion in (flow, slowed(net, sheet)))
    # A knot hides as much of the twine as it is thick.
    hidden = 8.0 / pi / max(net.knot_diameters, 1e-12) * sheet.knots
    parts = [float(b / a) if a > 0.0 else 1.0 for a, b in zip(single, left, strict=True)]
    clear = max(1.0 - hidden, 0.0)
    shares = clear * parts[0], clear * parts[1], parts[2]
    square = sheet.solidity**2 / (1.0 + sheet.solidity**2)
    if net.lift * square < LEAST_LIFT:
        return Exposure(*shares)
    return Exposure(*shares, max(net.lift - bars_lift(net, sheet, shares) / square, 0.0))


def bars_lift(net: NettingRecord, sheet: Sheet, shares: tuple[float, float, float]) -> float:
    """Return the lift of the bars of a sheet at a small slope, per outline area and slope."""
    tilted = replace(sheet, slope=LOOKUP_SLOPE_RAD)
    force = np.array(shares) @ loads(net, tilted, tilted.flow)
    sine, cosine = np.sin(LOOKUP_SLOPE_RAD), np.cos(LOOKUP_SLOPE_RAD)
    return float(sheet.solidity * force @ [-sine, 0.0, cosine] / sine)


@lru_cache(1000)
def exposure(section: SectionRecord, net: NettingRecord, closing: float = 0.0) -> Exposure:
    """Return the exposure of a section's netting, or the one that the gear file gives."""
    if section.ropes:
        return Exposure()
    if section.shielding is not None:
        return Exposure(section.shielding, section.shielding, section.shielding)
    return exposure_of(sheet_of(section, net, closing), net)


def viscous(net: NettingRecord, diameter: float) -> tuple[float, float]:
    """Return the viscous parts (√(m/s)) of a twine's drag across and along, for `bar.drag_at`."""
    scale = net.viscous * sqrt(KINEMATIC_VISCOSITY_M2_S / diameter) if diameter > 0.0 else 0.0
    across = ACROSS_GROWTH * scale / net.normal_drag if net.normal_drag else 0.0
    return across, ALONG_GROWTH * scale / net.friction if net.friction else 0.0


def viscous_knots(net: NettingRecord, diameter: float) -> float:
    """Return the viscous drag coefficient (√(m/s)) of knots of a diameter (m)."""
    return net.knot_drag * KNOT_GROWTH * net.viscous * sqrt(KINEMATIC_VISCOSITY_M2_S / diameter)
