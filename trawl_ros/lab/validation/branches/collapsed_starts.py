"""Searches that start from a collapsed gear: boards flat, crossed, or fallen together."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.validation.branches.continuation import SAME, largest_distance
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.rotations import about_axis
from trawl_ros.model.state import State
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium, require_usable
from trawl_ros.solver.operating_point import OperatingPoint

TURNS: Mapping[str, tuple[float, float]] = {
    'at −5° to the flow': (-5.0, 14.0),
    'along the flow': (0.0, 0.0),
    'at 45° to the flow': (45.0, 14.0),
    'across the flow': (90.0, 0.0),
    'flat, face down': (20.0, -90.0),
    'flat, face up': (20.0, 90.0),
    'upside down': (20.0, 180.0),
    'back to front': (180.0, 0.0),
}
"""Attitudes (°) of a collapsed board: leading edge outward, outward normal up."""

FOLDED = 0.05
"""Width of a folded gear as a share of what it was."""


@dataclass(frozen=True)
class OutcomeTally:
    """Tally of searches from collapsed shapes by outcome; ``refused`` by reason."""

    good: int
    refused: Counter[str]
    other: int

    @property
    def searches(self) -> int:
        """Number of searches."""
        return self.good + self.refused.total() + self.other


def turned_boards(turn: tuple[float, float]) -> FloatArray:
    """Rotations (2, 3, 3) of both boards at an attitude of `TURNS`."""
    yaw, lean = np.radians(turn)
    port = about_axis(2, yaw) @ about_axis(0, lean)
    flip = np.array([1.0, -1.0, 1.0])
    return np.stack([port, flip[:, None] * port * flip])


def collapsed_shapes(shape: State) -> list[State]:
    """A shape with both boards or one of them collapsed, and the whole gear folded."""
    shapes = []
    for turn in TURNS.values():
        both = turned_boards(turn)
        for rotations in (both, np.stack([both[0], shape.board_rotations[1]])):
            shapes.append(replace(shape, board_rotations=rotations))
    narrow = np.array([1.0, FOLDED, 1.0])
    folded = replace(
        shape,
        nodes=shape.nodes * narrow,
        board_positions=shape.board_positions * narrow,
        board_rotations=turned_boards(TURNS['flat, face down']),
    )
    return [*shapes, folded]


def tally(
    model: GearModel,
    point: OperatingPoint,
    shapes: Sequence[State],
    good: Equilibrium | None,
) -> OutcomeTally:
    """Search at a point from collapsed shapes; ``good`` is its steady state, None for none."""
    same, other = 0, 0
    refused: Counter[str] = Counter()
    for shape in shapes:
        try:
            found = find_equilibrium(model, point, near=shape)
            if good is not None and largest_distance(found, good) <= SAME:
                same += 1
            else:
                require_usable(model, found)
                other += 1
        except NoSteadyState as error:
            refused[error.reason] += 1
    return OutcomeTally(same, refused, other)
