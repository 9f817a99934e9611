# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Empirical drag of trawls by twine area and speed: bands to compare a gear file with.

They were fitted to full-scale and model trawls of their time and disagree widely. A drag outside
all of them hints at an error in the gear file.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

KNOT = 1852.0 / 3600.0
"""One knot, m/s."""

TON_FORCE = 9806.65
"""One metric ton-force, N."""


def reid(area: float, knots: float) -> float:
    """Return the drag (N) of pelagic trawls by Reid (1977), from twine area (m²) and speed (kn)."""
    return TON_FORCE * area * knots**2 / (54.72 * knots + 115.2)


def aberdeen(area: float, knots: float) -> float:
    """Return the drag (N) of pelagic trawls by the formula of the laboratory in Aberdeen."""
    return TON_FORCE * 0.00868 * area * knots**2 / (1 + 0.00475 * knots)


def maclennan(area: float, knots: float) -> float:
    """Return the drag (N) of trawls by MacLennan (1981)."""
    return area * (61.2 + 46.6 * knots**2) / (1 + 0.0641 * knots)


BANDS: Mapping[str, Callable[[float, float], float]] = MappingProxyType(
    {'Reid 1977': reid, 'Aberdeen': aberdeen, 'MacLennan 1981': maclennan}
)
"""Drag (N) by twine area (m²) and speed (knots)."""
