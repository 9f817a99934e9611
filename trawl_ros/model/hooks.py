# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extension points for physics beyond the paper: coefficient modifiers and node forces.

Water is changed through its profile of currents, ropes and netting through `BarProperties`; these
two are for everything else. Both are called with complex numbers as well, because their derivatives
are taken by the complex step.
"""

from dataclasses import dataclass
from typing import Protocol

from trawl_ros.core.arrays import FloatArray, IntArray

DRAG, LIFT = 0, 1
"""Places of C_x^F and C_y^F among the coefficients of a board's law."""


class CoefficientModifier(Protocol):
    """Coefficient modifier: changes the law of the boards (eq. 14)."""

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Return the modified force and moment coefficients (..., 6).

        Parameters
        ----------
        coefficients
            Coefficients (..., 6) of eq. 14.
        attack, slip
            α and β (...), rad.
        lean
            Vertical part (...) of the board's outward normal: positive if its outer face looks up.
        """
        ...


@dataclass(frozen=True)
class ComposedModifier:
    """Coefficient modifier that applies two others, one after the other."""

    first: CoefficientModifier
    then: CoefficientModifier

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Return the coefficients modified by both."""
        return self.then(self.first(coefficients, attack, slip, lean), attack, slip, lean)


class NodeForce(Protocol):
    """Force on some nodes; each depends on the position and velocity of its own node only."""

    @property
    def nodes(self) -> IntArray:
        """Numbers (k,) of the nodes, each once."""
        ...

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the force (k, 3), N, at positions (m) and velocities (m/s), (k, 3) in ``map``."""
        ...
