"""Lattices for branch continuation: warp length × speed, and warp length × installation angle."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from trawl_ros.lab.validation.branches.continuation import Answer, Place, Spot, continue_branches
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.operating_point import OperatingPoint

SPEED = 2.1
"""Speed (m/s) at which installation angles are varied, that of the paper's trial."""

Angle = Literal['ε', 'ζ', 'η']
ANGLES: tuple[Angle, ...] = ('ε', 'ζ', 'η')


@dataclass(frozen=True)
class Lattice:
    """Lattice of answers: rows are warp lengths (m), columns are named by ``across``."""

    across: str
    lengths: Sequence[float]
    columns: Sequence[float]
    answers: dict[Spot, Answer]

    def at(self, row: int, column: int) -> Answer:
        """The answer in a row and column."""
        return self.answers[row, column]


def speed_lattice(model: GearModel, lengths: Sequence[float], speeds: Sequence[float]) -> Lattice:
    """Continue steady states over warp lengths and speeds."""
    places = {
        (i, j): Place(model, OperatingPoint(length, length, speed))
        for i, length in enumerate(lengths)
        for j, speed in enumerate(speeds)
    }
    return _walked('speed through the water (m/s)', lengths, speeds, places, SPEED)


def angle_lattice(
    model: GearModel, lengths: Sequence[float], angle: Angle, degrees: Sequence[float]
) -> Lattice:
    """Continue steady states over warp lengths and one installation angle (°)."""
    turned = []
    for value in degrees:
        installation = np.zeros(3)
        installation[ANGLES.index(angle)] = np.radians(value)
        turned.append(model.with_board(installation=tuple(installation)))
    places = {
        (i, j): Place(turned[j], OperatingPoint(length, length, SPEED))
        for i, length in enumerate(lengths)
        for j in range(len(degrees))
    }
    return _walked(f'installation angle {angle} (°)', lengths, degrees, places, 0.0)


def _walked(
    across: str,
    lengths: Sequence[float],
    columns: Sequence[float],
    places: dict[Spot, Place],
    usual: float,
) -> Lattice:
    """Continue from the middle length at the usual speed or angle; every third place also cold."""
    first = len(lengths) // 2, int(np.abs(np.array(columns) - usual).argmin())
    cold = [(i, j) for i, j in places if (i + j) % 3 == 0]
    return Lattice(across, lengths, columns, continue_branches(places, first, cold))
