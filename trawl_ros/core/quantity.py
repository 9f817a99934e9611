# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quantities in files: a number with its unit."""

from trawl_ros.core.schema import Record
from trawl_ros.core.units import UNITS, units_of


class Quantity(Record):
    """Quantity: a number with its unit."""

    value: float
    unit: str

    def si(self) -> float:
        """Return the value in SI units."""
        return self.value * UNITS[self.unit].size


def in_si(quantity: Quantity | None) -> float:
    """Return a quantity in SI units, or 0 if it is not given."""
    return 0.0 if quantity is None else quantity.si()


def check_quantity(key: str, quantity: Quantity, wanted: str) -> None:
    """Refuse a quantity of another kind than wanted, or a negative one.

    Raises
    ------
    ValueError
        Naming the key, what was found and what was expected.
    """
    check_unit(f'{key}.unit', quantity.unit, wanted)
    if quantity.value < 0:
        raise ValueError(f'{key}.value: found {quantity.value:g}, expected 0 or more')


def check_unit(key: str, unit: str, quantity: str) -> None:
    """Refuse a unit of another quantity, or an unknown unit.

    Raises
    ------
    ValueError
        Naming the key, what was found and what was expected.
    """
    known = UNITS.get(unit)
    if known is None or known[0] != quantity:
        is_one = f' of {known[0]}' if known else ''
        raise ValueError(
            f'{key}: found {unit!r}{is_one}, expected a unit of {quantity}: '
            f'{", ".join(units_of(quantity))}'
        )
