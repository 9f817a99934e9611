"""Empirical drag of trawls by twine area and speed: bands to hold a gear file against.

They were fitted to full-scale and model trawls of their time and disagree widely; a net whose
drag lies outside all of them has something in its file that is not in theirs.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

KNOT = 1852.0 / 3600.0
TON_FORCE = 9806.65


def reid(area: float, knots: float) -> float:
    """Drag (N) of pelagic trawls after Reid 1977, of twine area (m²) and speed (knots)."""
    return TON_FORCE * area * knots**2 / (54.72 * knots + 115.2)


def aberdeen(area: float, knots: float) -> float:
    """Drag (N) of pelagic trawls as the laboratory in Aberdeen has it."""
    return TON_FORCE * 0.00868 * area * knots**2 / (1 + 0.00475 * knots)


def maclennan(area: float, knots: float) -> float:
    """Drag (N) of trawls after MacLennan 1981."""
    return area * (61.2 + 46.6 * knots**2) / (1 + 0.0641 * knots)


BANDS: Mapping[str, Callable[[float, float], float]] = MappingProxyType(
    {'Reid 1977': reid, 'Aberdeen': aberdeen, 'MacLennan 1981': maclennan}
)
"""Drag (N) by twine area (m²) and speed (knots)."""
