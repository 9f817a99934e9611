"""Values in the units of a ship's bridge and deck, beside SI."""

from trawl_ros.core.units import UNITS

COMMON = {'N': ('kN', ' kN'), 'rad': ('deg', '°'), 'm/s': ('kn', ' knots')}
"""SI unit → the one that is common aboard, and how it is written."""


def in_common_unit(value: float, low: float, high: float, unit: str) -> str:
    """Value with its interval in the common unit, as an addition in brackets; empty for others.

    Examples
    --------
    >>> from trawl_ros.diagnosis.report.common_units import in_common_unit
    >>> in_common_unit(-3360.0, -4100.0, -2600.0, 'N')
    ' = -3.36 kN (-4.1 to -2.6)'
    >>> in_common_unit(3.0, 2.0, 4.0, 'm')
    ''
    """
    if unit not in COMMON:
        return ''
    symbol, written = COMMON[unit]
    size = UNITS[symbol].size
    return f' = {value / size:.3g}{written} ({low / size:.3g} to {high / size:.3g})'
