"""Empirical terms of force on the boards: differences between the sides, and drifts.

What is alike on both boards and does not change is theirs already: the twelve coefficients.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.base.term import EmpiricalTerm, size
from trawl_ros.model.hooks import CoefficientModifier

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

DIRECTIONS = ('ahead', 'outward', 'up')
SIDES = np.array([0.5, -0.5])
BOTH = np.array([1.0, 1.0])


@dataclass(frozen=True)
class More:
    """Coefficient modifier: adds to one force coefficient of both boards (2,), after any other."""

    place: int
    sizes: FloatArray
    before: CoefficientModifier | None

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Return the coefficients with the addition."""
        bent = coefficients + 0.0 * attack[..., None]
        if self.before is not None:
            bent = self.before(bent, attack, slip, lean)
        more = np.zeros((2, coefficients.shape[-1]))
        more[:, self.place] = self.sizes
        return bent + more


@dataclass(frozen=True)
class BoardForce(EmpiricalTerm):
    """Force on the boards as a share of ½ρU²A: difference of the sides, or drift per hour."""

    place: int = 0
    by_hours: bool = False

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with the force on its boards."""
        sizes = values[0] * (at.hours * BOTH if self.by_hours else SIDES)
        return model.with_board(bend=More(self.place, sizes, model.board.bend))


def board_terms() -> Iterator[EmpiricalTerm]:
    """Yield all terms of force on the boards."""
    for place, direction in enumerate(DIRECTIONS):
        yield BoardForce(
            name=f'empirical_boards_{direction}_difference',
            sentence=f'Force {direction} on the port board more than on the starboard one.',
            parameters=size('of ½ρU²A', 0.1, 2.0),
            excited_by='any tow',
            reading='one board is bent, worn, fouled or rigged unlike the other',
            place=place,
        )
        yield BoardForce(
            name=f'empirical_boards_{direction}_with_time',
            sentence=f'Force {direction} on both boards that grows with the time in the tow.',
            parameters=size('of ½ρU²A per h', 0.1, 1.0),
            excited_by='time in the tow',
            reading='boards that fill with mud, or shift in their rigging, while towing',
            place=place,
            by_hours=True,
        )
