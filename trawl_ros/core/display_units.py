# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Units in which quantities are printed and read: systems, and units of single quantities."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.units import UNITS, units_of

SYSTEMS: Mapping[str, Mapping[str, str]] = {
    'metric': {'warp': 'm', 'depth': 'm', 'width': 'm', 'speed': 'm/s', 'tension': 'kN'},
    'sea': {'warp': 'm', 'depth': 'm', 'width': 'm', 'speed': 'kn', 'tension': 'tf'},
    'imperial': {
        'warp': 'fathom', 'depth': 'fathom', 'width': 'ft', 'speed': 'kn', 'tension': 'lbf',
    },
}  # fmt: skip
"""Unit of each quantity by system. ``width`` is any length across: spreads, openings, boards."""

ALIASES: Mapping[str, str] = {
    't': 'tf', 'tonne': 'tf', 'tonnes': 'tf', 'fm': 'fathom', 'fathoms': 'fathom', 'feet': 'ft',
    'kt': 'kn', 'kts': 'kn', 'knot': 'kn', 'knots': 'kn', 'lb': 'lbf', 'lbs': 'lbf',
    '°': 'deg',
}  # fmt: skip
"""Other names of units, as they are spoken on a bridge."""

SYMBOLS: Mapping[str, str] = {'tf': 't', 'fathom': 'fm', 'deg': '°'}
"""Symbols that differ from the name in `UNITS`."""

IN_TEXT = re.compile(
    r'(?<![\w.])((?P<of>spread|depth)(?: of)? )?(?P<number>\d+(?:\.\d+)?) '
    r'(?P<unit>m/s|kN|m)(?![\w/²³])'
)
"""A number with a unit of a sentence."""


@dataclass(frozen=True)
class DisplayUnits:
    """Units in which a user reads and writes quantities.

    Attributes
    ----------
    units
        Name in `UNITS` by quantity: ``warp``, ``depth``, ``width``, ``speed``, ``tension``.
    """

    units: Mapping[str, str]

    def size(self, quantity: str) -> float:
        """Return the size of a quantity's unit in SI units."""
        return UNITS[self._unit(quantity)].size

    def symbol(self, quantity: str) -> str:
        """Return the symbol of a quantity's unit."""
        return SYMBOLS.get(self._unit(quantity), self._unit(quantity))

    def shown(self, value: float, quantity: str, digits: int = 1) -> str:
        """Format a value (SI) in the quantity's unit, with at least so many decimals."""
        space = '' if quantity == 'angle' else ' '
        return f'{self.number(value, quantity, digits)}{space}{self.symbol(quantity)}'

    def weight(self, value: float) -> str:
        """Format a weight (N), which is small: in N where tensions are in kN."""
        if self._unit('tension') == 'kN':
            return f'{value:.0f} N'
        return self.shown(value, 'tension', 2)

    def number(self, value: float, quantity: str, digits: int = 1) -> str:
        """Format a value (SI) without its unit; large units get one or two more decimals."""
        more = {'tf': 1, 'fathom': 0, 'm/s': 1, 'kn': 1}.get(self._unit(quantity), 0)
        fewer = 1 if self._unit(quantity) == 'lbf' else 0
        return f'{value / self.size(quantity):.{max(0, digits + more - fewer)}f}'

    def sentence(self, text: str) -> str:
        """Convert the m, m/s and kN of a sentence; other lengths than named count as warps."""
        return IN_TEXT.sub(self._convert, text)

    def _convert(self, found: re.Match[str]) -> str:
        unit, number = found['unit'], found['number']
        length = {'spread': 'width', 'depth': 'depth', None: 'warp'}[found['of']]
        quantity = {'m/s': 'speed', 'kN': 'tension', 'm': length}[unit]
        if self._unit(quantity) == unit:
            return found[0]
        decimals = len(number.partition('.')[2])
        shown = self.shown(float(number) * UNITS[unit].size, quantity, min(decimals, 1))
        return f'{found[1] or ""}{shown}'

    def _unit(self, quantity: str) -> str:
        return 'deg' if quantity == 'angle' else self.units[quantity]


METRIC = DisplayUnits(SYSTEMS['metric'])


def quantity_of(name: str, unit: str) -> str:
    """Return the quantity of a channel by its name and its SI unit."""
    by_unit = {'N': 'tension', 'rad': 'angle', 'm/s': 'speed'}
    if unit in by_unit:
        return by_unit[unit]
    return next(
        (key for key in ('depth', 'warp') if key in name.replace('length', 'warp')), 'width'
    )


def parse_units(text: str) -> DisplayUnits:
    """Read a choice of units.

    Parameters
    ----------
    text
        A system (``metric``, ``sea``, ``imperial``), pairs such as ``speed=kn,tension=t``, or a
        system followed by pairs, separated by commas.

    Raises
    ------
    TrawlError
        If a system, quantity or unit is unknown.
    """
    units: dict[str, str] = dict(SYSTEMS['metric'])
    for part in (part.strip() for part in text.split(',')):
        quantity, paired, name = part.partition('=')
        if not paired and part in SYSTEMS:
            units.update(SYSTEMS[part])
        elif paired and quantity in units:
            units[quantity] = _unit(name, UNITS[units[quantity]].quantity)
        else:
            raise TrawlError(
                f"found '{part}', expected {', '.join(SYSTEMS)} or a pair such as speed=kn of "
                f'{", ".join(units)}'
            )
    return DisplayUnits(units)


def parse_value(text: str, quantity: str, units: DisplayUnits = METRIC) -> float:
    """Read a number with or without a unit, such as ``250fm``, in SI units.

    Parameters
    ----------
    text
        Number, and its unit if it is not that of ``units``.
    quantity
        Key of `DisplayUnits.units`.
    units
        Units of numbers without one.

    Raises
    ------
    TrawlError
        If it is no number, or the unit is unknown or of another quantity.
    """
    found = re.fullmatch(r'\s*([-+]?[\d.]+(?:e[-+]?\d+)?|[-+]?(?:nan|inf))\s*(\D.*)?', text, re.I)
    try:
        value = float(found[1]) if found else float(text)
    except ValueError:
        example = f'400, 400m or 220fm, in {units.symbol(quantity)} without a unit'
        raise TrawlError(f"found '{text}', expected a number such as {example}") from None
    if found is None or not found[2]:
        return value * units.size(quantity)
    kind = UNITS[units.units[quantity]].quantity
    return value * UNITS[_unit(found[2].strip(), kind)].size


def _unit(name: str, kind: str) -> str:
    unit = ALIASES.get(name.lower(), name)
    if unit not in UNITS or UNITS[unit].quantity != kind:
        known = ', '.join(dict.fromkeys(SYMBOLS.get(known, known) for known in units_of(kind)))
        raise TrawlError(f"found the unit '{name}', expected one of {kind}: {known}")
    return unit
