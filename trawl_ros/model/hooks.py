"""Extension points for physics beyond the paper: coefficient modifiers and node forces.

Water enters as a profile of currents, ropes and netting through the arrays of `BarProperties`;
these two are for what neither can say. Both are called with complex numbers as well, for their
derivatives are taken by the complex step.
"""

from dataclasses import dataclass
from typing import Protocol

from trawl_ros.core.arrays import FloatArray, IntArray

DRAG, LIFT = 0, 1
"""Places of C_x^F and C_y^F among the coefficients that a board's law gives."""


class CoefficientModifier(Protocol):
    """Coefficient modifier: changes the law of the boards (eq. 14)."""

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Return the modified force and moment coefficients (..., 6).

        Parameters
        ----------
        coefficients
            As eq. 14 has them (..., 6).
        attack, slip
            α and β (...), rad.
        lean
            Vertical part (...) of the board's outward normal: positive where its outer face looks
            up.
        """
        ...


@dataclass(frozen=True)
class InTurn:
    """Coefficient modifier that applies one after another."""

    first: CoefficientModifier
    then: CoefficientModifier

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Return the coefficients modified by both."""
        return self.then(self.first(coefficients, attack, slip, lean), attack, slip, lean)


class NodeForce(Protocol):
    """A force on some nodes, each by its own position and velocity alone."""

    @property
    def nodes(self) -> IntArray:
        """Numbers (k,) of the nodes, each once."""
        ...

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Force (k, 3), N, at positions (m) and velocities (m/s), both (k, 3) in ``map`` axes."""
        ...
