# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Nodes of the net that carry the kite."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class KiteNodes:
    """Carrying nodes of the kite.

    ``nodes`` (3,) are their numbers, of which two may be equal; ``weights`` (2, 3) combine them
    into the front and the rear carrying point.
    """

    nodes: IntArray
    weights: FloatArray

    @cached_property
    def shares(self) -> FloatArray:
        """Share (3,) of the kite's load on each node; both carriers hold half of it."""
        shares: FloatArray = self.weights.mean(axis=0)
        return shares

    @cached_property
    def carried(self) -> FloatArray:
        """Change (6, 9) of both carrying points with the places of the three nodes."""
        carried: FloatArray = np.asarray(np.kron(self.weights, np.eye(3)), float)
        return carried

    @cached_property
    def held(self) -> bool:
        """True if there is a kite."""
        return bool(self.weights.any())


NO_KITE = KiteNodes(np.zeros(3, int), np.zeros((2, 3)))
"""Nodes for a gear without a kite, whose area and mass are zero as well."""
