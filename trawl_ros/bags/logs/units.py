"""Units in logs, each with its quantity and its size in SI."""

import math

UNITS: dict[str, tuple[str, float]] = {
    'mm': ('length', 1e-3),
    'cm': ('length', 0.01),
    'm': ('length', 1.0),
    'km': ('length', 1000.0),
    'ft': ('length', 0.3048),
    'fathom': ('length', 1.8288),
    'nmi': ('length', 1852.0),
    'N': ('force', 1.0),
    'daN': ('force', 10.0),
    'kN': ('force', 1e3),
    'MN': ('force', 1e6),
    'kgf': ('force', 9.80665),
    'tf': ('force', 9806.65),
    'lbf': ('force', 4.4482216152605),
    'short_tf': ('force', 8896.443230521),
    'long_tf': ('force', 9964.01641818352),
    'Pa': ('pressure', 1.0),
    'hPa': ('pressure', 100.0),
    'mbar': ('pressure', 100.0),
    'kPa': ('pressure', 1e3),
    'dbar': ('pressure', 1e4),
    'bar': ('pressure', 1e5),
    'MPa': ('pressure', 1e6),
    'atm': ('pressure', 101_325.0),
    'psi': ('pressure', 6894.757293168361),
    'rad': ('angle', 1.0),
    'deg': ('angle', math.pi / 180),
    'deg_min': ('angle', math.pi / 180),
    'm/s': ('speed', 1.0),
    'cm/s': ('speed', 0.01),
    'ft/s': ('speed', 0.3048),
    'ft/min': ('speed', 0.3048 / 60),
    'fathom/min': ('speed', 1.8288 / 60),
    'm/min': ('speed', 1 / 60),
    'km/h': ('speed', 1 / 3.6),
    'kn': ('speed', 1852 / 3600),
    'rad/s': ('rate of turn', 1.0),
    'deg/s': ('rate of turn', math.pi / 180),
    'deg/min': ('rate of turn', math.pi / 180 / 60),
}
"""Quantity and factor by name. ``kn`` is the knot, ``kN`` the kilonewton, ``tf`` the metric
ton-force (``short_tf`` of 2000 lb, ``long_tf`` of 2240 lb), ``fathom`` the international one,
``deg_min`` degrees and minutes as charts have them, whose value here is in degrees."""


def units_of(quantity: str) -> list[str]:
    """Return the units of a quantity."""
    return [name for name, (measures, _) in UNITS.items() if measures == quantity]
