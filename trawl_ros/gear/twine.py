# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Twine of netting: fibres, and properties from a twine's Rtex or diameter."""

from dataclasses import dataclass
from math import pi, sqrt
from typing import Literal

Material = Literal['PA', 'PES', 'PP', 'PE', 'UHMWPE']

PA_DIAMETER = 0.038
"""Diameter (mm) of a twine of polyamide over the root of its Rtex (g/km), from FAO tables.

That of other fibres goes with the root of their volume.
"""


@dataclass(frozen=True)
class Fibre:
    """Fibre: density (kg/m³), and modulus (Pa) of a twine of it over its whole section."""

    density: float
    modulus: float


FIBRES: dict[str, Fibre] = {
    'PA': Fibre(1140.0, 2.0e9),
    'PES': Fibre(1380.0, 3.0e9),
    'PP': Fibre(910.0, 1.5e9),
    'PE': Fibre(950.0, 1.5e9),
    'UHMWPE': Fibre(975.0, 3.0e10),
}
"""Fibres by material, with densities of the fibres and assumed moduli of twines."""


@dataclass(frozen=True)
class Twine:
    """Twine: ``diameter`` (m), ``tex`` mass per length (kg/m) of its fibres, and ``fibre``."""

    diameter: float
    tex: float
    fibre: Fibre

    @property
    def section(self) -> float:
        """Section (m²), with the water between the fibres."""
        return pi / 4 * self.diameter**2

    def density(self, water: float) -> float:
        """Return the density (kg/m³) of the whole section, filled with water of this density."""
        fibres = self.tex / self.fibre.density
        return (self.tex + (self.section - fibres) * water) / self.section


def twine_of(material: str, rtex: float | None, diameter: float | None) -> Twine:
    """Derive a twine from its Rtex (g/km), its diameter (m), or both.

    A diameter without an Rtex is that of a twine whose fibres fill three quarters of it, as in the
    FAO tables for polyamide.
    """
    fibre = FIBRES[material]
    # Millimetres per root of g/km.
    factor = PA_DIAMETER * sqrt(FIBRES['PA'].density / fibre.density)
    if diameter is None:
        assert rtex is not None
        diameter = 1e-3 * factor * sqrt(rtex)
    if rtex is None:
        rtex = (1e3 * diameter / factor) ** 2
    return Twine(diameter, 1e-6 * rtex, fibre)
