# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Values in the units of a ship's bridge and deck, beside SI."""

from trawl_ros.core.units import UNITS

COMMON = {'N': ('kN', ' kN'), 'rad': ('deg', '°'), 'm/s': ('kn', ' knots')}
"""SI unit → the one that is common aboard, and how it is written."""

NO_PART = ('exponent',)
"""Numbers without a unit that are no part of anything."""


def in_common_unit(
    value: float, low: float, high: float, unit: str, name: str = '', neutral: float = 0.0
) -> str:
    """Value with its interval in the common unit, as an addition in brackets; empty for others.

    A number without a unit is how much more or less than ``neutral`` there is, in percent.

    Examples
    --------
    >>> from trawl_ros.diagnosis.report.common_units import in_common_unit
    >>> in_common_unit(-3360.0, -4100.0, -2600.0, 'N')
    ' = -3.36 kN (-4.1 to -2.6)'
    >>> in_common_unit(0.05, 0.04, 0.06, 'm/s per h')
    ' = 0.0972 knots per h (0.0778 to 0.117)'
    >>> in_common_unit(0.863, 0.843, 0.884, '', 'factor', neutral=1.0)
    ' = -13.7 % (-15.7 to -11.6)'
    >>> in_common_unit(3.0, 2.0, 4.0, 'm')
    ''
    """
    if not unit and name not in NO_PART:
        value, low, high = (100.0 * (own - neutral) for own in (value, low, high))
        return f' = {value:.3g} % ({low:.3g} to {high:.3g})'
    base, per, rest = unit.partition(' per ')
    if base not in COMMON:
        return ''
    symbol, written = COMMON[base]
    size = UNITS[symbol].size
    written = f'{written}{per}{rest}'
    return f' = {value / size:.3g}{written} ({low / size:.3g} to {high / size:.3g})'
