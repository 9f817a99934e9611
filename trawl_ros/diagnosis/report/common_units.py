# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Values with their intervals in the units of a ship's bridge and deck."""

from trawl_ros.core.units import UNITS

COMMON = {'N': ('tf', ' t'), 'rad': ('deg', '°'), 'm/s': ('kn', ' knots')}
"""SI unit → the unit that is common aboard, and how it is written."""

LIGHT_T = 0.1
"""Forces below this, in tonnes, are given in kg."""

WITHOUT_PERCENT = ('exponent',)
"""Numbers without a unit that are no share of anything."""


def in_common_unit(
    value: float, low: float, high: float, unit: str, name: str = '', neutral: float = 0.0
) -> str:
    """Format a value with its interval in the common unit.

    Parameters
    ----------
    value, low, high
        Value and ends of its interval.
    unit
        Their unit; a number without a unit becomes a percentage of more or less than ``neutral``.
    name
        Name of the number; those in `WITHOUT_PERCENT` stay as they are.
    neutral
        Value without the effect.

    Examples
    --------
    >>> from trawl_ros.diagnosis.report.common_units import in_common_unit
    >>> in_common_unit(-3360.0, -4100.0, -2600.0, 'N')
    '-0.343 t (-0.418 to -0.265)'
    >>> in_common_unit(196.0, 98.0, 294.0, 'N')
    '20 kg (9.99 to 30)'
    >>> in_common_unit(0.05, 0.04, 0.06, 'm/s per h')
    '0.0972 knots per h (0.0778 to 0.117)'
    >>> in_common_unit(0.863, 0.843, 0.884, '', 'factor', neutral=1.0)
    '-13.7 % (-15.7 to -11.6)'
    >>> in_common_unit(3.0, 2.0, 4.0, 'm')
    '3 m (2 to 4)'
    """
    size, written = 1.0, f' {unit}' if unit else ''
    base, per, rest = unit.partition(' per ')
    if not unit and name not in WITHOUT_PERCENT:
        value, low, high = (own - neutral for own in (value, low, high))
        size, written = 0.01, ' %'
    elif base in COMMON:
        symbol, written = COMMON[base]
        if base == 'N' and max(map(abs, (value, low, high))) < LIGHT_T * UNITS['tf'].size:
            symbol, written = 'kgf', ' kg'
        size, written = UNITS[symbol].size, f'{written}{per}{rest}'
    return f'{value / size:.3g}{written} ({low / size:.3g} to {high / size:.3g})'
