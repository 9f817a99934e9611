"""Increase of the drag of twine and knots at low Reynolds numbers Re.

Across a cylinder C_n is 1.1 + 4 Re^-1/2, with Re of the motion across; the laminar part of the pull
along it is π μ 0.55 Re^1/2 U_t per length (Choo and Casarella 1971, Hydrodynamic resistance of
towed cables, Journal of Hydronautics 5(4)). Both go with the root of the motion across, so that the
loops over bars need one more root and no Reynolds number. Knots are taken as spheres (Balash et al.
2009): C_D goes with 0.4 + 6 / (1 + Re^1/2), about 0.4 (1 + 15 Re^-1/2).
"""

from math import sqrt

from trawl_ros.gear.netting import NettingRecord

VISCOSITY = 1.36e-6
"""Kinematic viscosity of sea water of 35 g/kg at 10 °C, m²/s (ITTC 7.5-02-01-03)."""

ACROSS, ALONG, KNOTS = 4.0, 1.1, 15.0
"""Factors of Re^-1/2 in the coefficient across, of Re^1/2 over the Reynolds number of the motion
along in that of friction on the wetted surface, and of Re^-1/2 in that of knots, relative to its
value at high Re."""


def viscous(net: NettingRecord, diameter: float) -> tuple[float, float]:
    """Return the viscous parts (√(m/s)) of a twine's drag across and along, for `bar.drag_at`."""
    scale = net.viscous * sqrt(VISCOSITY / diameter) if diameter > 0.0 else 0.0
    across = ACROSS * scale / net.normal_drag if net.normal_drag else 0.0
    return across, ALONG * scale / net.friction if net.friction else 0.0


def viscous_knots(net: NettingRecord, diameter: float) -> float:
    """Return the viscous drag coefficient (√(m/s)) of knots of a diameter (m)."""
    return net.knot_drag * KNOTS * net.viscous * sqrt(VISCOSITY / diameter)
