# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Seabed: its depth, and the check for contact with the gear."""

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import ScenarioError
from trawl_ros.records.truth import SIDES

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel
    from trawl_ros.model.state import State


class SeabedTouched(ScenarioError):
    """Contact of the gear with the seabed, which the model does not have."""


@dataclass(frozen=True)
class Seabed:
    """Depths (m) below the mean surface along one direction of ``map``, level across it.

    ``depths`` (n,) are those at rising ``distances`` (n,) from the origin along ``direction`` (ENU
    yaw, rad). They are interpolated linearly and constant beyond. By default there is no bottom.
    """

    direction: float = 0.0
    distances: FloatArray = field(default_factory=lambda: np.zeros(1))
    depths: FloatArray = field(default_factory=lambda: np.full(1, math.inf))

    def depth_at(self, places: FloatArray) -> FloatArray:
        """Return the depths (...,) at places (..., 3) in ``map``."""
        along = np.array([math.cos(self.direction), math.sin(self.direction)])
        depths: FloatArray = np.interp(places[..., :2] @ along, self.distances, self.depths)
        return depths


def require_clear(seabed: Seabed, model: 'GearModel', state: 'State') -> None:
    """Check that no node and no door of the gear touches the seabed.

    Raises
    ------
    SeabedTouched
        If one does; it names the part that lies deepest in the seabed.
    """
    if not math.isfinite(seabed.depths.min()):
        return
    places = np.concatenate([state.board_positions, state.nodes])
    heights = places[:, 2] + seabed.depth_at(places)
    # A door reaches down to its lowest corner.
    edges = np.array([model.board.chord, 0.0, model.board.span])
    heights[:2] -= 0.5 * np.abs(state.board_rotations[:, 2]) @ edges
    # Rounded, so that of two equal sides port is named.
    lowest = int(np.argmin(np.round(heights, 6)))
    if heights[lowest] > 0.0:
        return
    if lowest < 2:
        part = f'{SIDES[lowest]} door'
    else:
        part = next(
            name.replace('_', ' ')
            for name, numbers, _ in model.layout.lines
            if lowest - 2 in numbers
        )
    raise SeabedTouched(
        f'the {part} touches the seabed, which is {seabed.depth_at(places[lowest]):.1f} m deep '
        'there, but the model has no contact with the bottom; expected shorter warps, more speed '
        'or deeper water'
    )
