# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Catch in the codend: its mass, and the shape of the full codend."""

from dataclasses import dataclass
from math import atan, pi, sin, sqrt
from typing import Annotated

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.numbers import NotNegative

OPEN_SHARE = sin(atan(sqrt(2.0)))
"""Circumference of diamond meshes under pressure over that of stretched netting.

A pressure p in a tube of radius r causes tensions p r around and p r / 2 along it. Bars at an angle
θ to the axis bear tan² θ times as much around as along. So θ is 54.7°, as in braided hoses.
"""


class CatchRecord(Record):
    """Catch in the codend."""

    mass_kg: Annotated[float, Field(gt=0, le=1e6)]
    """Fish, in air."""
    density_kg_m3: Annotated[float, Field(ge=900, le=1300)] = 1050.0
    """Density of the fish; those of the default sink."""
    bulk_kg_m3: Annotated[float, Field(ge=100, le=1000)] = 800.0
    """Fish in a cubic metre of the full codend; water is between them."""
    drag_coefficient: NotNegative = 1.4
    """C_D of the catch on its cross-section."""

    @model_validator(mode='after')
    def _fits(self) -> 'CatchRecord':
        if self.bulk_kg_m3 > self.density_kg_m3:
            raise ValueError(
                f'bulk_kg_m3: found {self.bulk_kg_m3:g}, expected no more than density_kg_m3, '
                f'{self.density_kg_m3:g}'
            )
        return self


@dataclass(frozen=True)
class CatchBody:
    """Body of a catch: a ball, or a cylinder with round ends as wide as the open netting.

    Attributes
    ----------
    radius, length
        Radius and length of the body, m.
    volume
        Volume of fish and the water between them, m³.
    """

    radius: float
    length: float
    volume: float

    @property
    def cross_section(self) -> float:
        """Area normal to the flow, m²."""
        return pi * self.radius**2


def catch_body(catch: CatchRecord, circumference: float, *, square: bool = False) -> CatchBody:
    """Return the body of a catch in netting of this stretched circumference (m).

    Square meshes do not open further: their bars lie around already.
    """
    volume = catch.mass_kg / catch.bulk_kg_m3
    widest = (1.0 if square else OPEN_SHARE) * circumference / (2.0 * pi)
    ball = (3.0 * volume / (4.0 * pi)) ** (1.0 / 3.0)
    radius = min(ball, widest)
    straight = max(volume - 4.0 / 3.0 * pi * radius**3, 0.0) / (pi * radius**2)
    return CatchBody(radius, 2.0 * radius + straight, volume)
