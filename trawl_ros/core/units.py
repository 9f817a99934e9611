# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Units, each with its quantity, its size in SI and its name."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class Unit(NamedTuple):
    """Unit: the measured quantity, its size in SI, and its name in sentences."""

    quantity: str
    size: float
    name: str


UNITS: Mapping[str, Unit] = MappingProxyType(
    {
        'mm': Unit('length', 1e-3, 'millimetres'),
        'cm': Unit('length', 0.01, 'centimetres'),
        'm': Unit('length', 1.0, 'metres'),
        'km': Unit('length', 1000.0, 'kilometres'),
        'ft': Unit('length', 0.3048, 'feet'),
        'fathom': Unit('length', 1.8288, 'fathoms'),
        'nmi': Unit('length', 1852.0, 'nautical miles'),
        'N': Unit('force', 1.0, 'newtons'),
        'daN': Unit('force', 10.0, 'decanewtons'),
        'kN': Unit('force', 1e3, 'kilonewtons'),
        'MN': Unit('force', 1e6, 'meganewtons'),
        'kgf': Unit('force', 9.80665, 'kilograms-force'),
        'tf': Unit('force', 9806.65, 'tonnes-force'),
        't': Unit('force', 9806.65, 'tonnes'),
        'lbf': Unit('force', 4.4482216152605, 'pounds-force'),
        'short_tf': Unit('force', 8896.443230521, 'short tons-force'),
        'long_tf': Unit('force', 9964.01641818352, 'long tons-force'),
        'Pa': Unit('pressure', 1.0, 'pascals'),
        'hPa': Unit('pressure', 100.0, 'hectopascals'),
        'mbar': Unit('pressure', 100.0, 'millibars'),
        'kPa': Unit('pressure', 1e3, 'kilopascals'),
        'dbar': Unit('pressure', 1e4, 'decibars'),
        'bar': Unit('pressure', 1e5, 'bars'),
        'MPa': Unit('pressure', 1e6, 'megapascals'),
        'atm': Unit('pressure', 101_325.0, 'atmospheres'),
        'psi': Unit('pressure', 6894.757293168361, 'pounds-force per square inch'),
        'rad': Unit('angle', 1.0, 'radians'),
        'deg': Unit('angle', math.pi / 180, 'degrees'),
        'deg_min': Unit('angle', math.pi / 180, 'degrees and minutes'),
        'm/s': Unit('speed', 1.0, 'metres per second'),
        'cm/s': Unit('speed', 0.01, 'centimetres per second'),
        'ft/s': Unit('speed', 0.3048, 'feet per second'),
        'ft/min': Unit('speed', 0.3048 / 60, 'feet per minute'),
        'fathom/min': Unit('speed', 1.8288 / 60, 'fathoms per minute'),
        'm/min': Unit('speed', 1 / 60, 'metres per minute'),
        'km/h': Unit('speed', 1 / 3.6, 'kilometres per hour'),
        'kn': Unit('speed', 1852 / 3600, 'knots'),
        'rad/s': Unit('rate of turn', 1.0, 'radians per second'),
        'deg/s': Unit('rate of turn', math.pi / 180, 'degrees per second'),
        'deg/min': Unit('rate of turn', math.pi / 180 / 60, 'degrees per minute'),
    }
)
"""Units by symbol.

``kn`` is the knot, ``kN`` the kilonewton, ``tf`` the metric ton-force (``short_tf`` of 2000 lb,
``long_tf`` of 2240 lb), and ``fathom`` the international fathom. ``deg_min`` is written in degrees
and minutes, as on charts; its value is in degrees."""


def units_of(quantity: str) -> list[str]:
    """Return the units of a quantity."""
    return [symbol for symbol, unit in UNITS.items() if unit.quantity == quantity]
