# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Grid of the sonar's image: beams by angle, cells by range."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray

BRIGHTEST = 255
"""Greatest value of a pixel."""


@dataclass(frozen=True)
class Grid:
    """Grid of an image: meaning of its rows, columns and values.

    The beam of row i of ``beams`` points at ``angle_min`` + i ``angle_increment`` (rad about z of
    frame ``sonar``: 0 down, positive to port). Column j of ``cells`` has the echoes at the range
    (j + ½) ``max_range`` / ``cells`` (m). Ranges below ``min_range`` (m) have no echoes.
    Brightness rises from 0 to 255 over ``span`` dB.
    """

    beams: int
    cells: int
    angle_min: float
    angle_increment: float
    min_range: float
    max_range: float
    span: float

    @property
    def angles(self) -> FloatArray:
        """Angle of each row, (beams,) rad."""
        return self.angle_min + self.angle_increment * np.arange(self.beams, dtype=float)

    @property
    def cell(self) -> float:
        """Length of a cell, m."""
        return self.max_range / self.cells

    @property
    def ranges(self) -> FloatArray:
        """Range of each column, (cells,) m."""
        return self.cell * (np.arange(self.cells, dtype=float) + 0.5)
