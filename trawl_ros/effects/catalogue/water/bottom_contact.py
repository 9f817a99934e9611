"""Bottom contact of the lower wing tips."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation
from trawl_ros.model.numerics import length

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

SOFT = 4.0
"""Over this depth (m) the ground takes hold of a weight."""

SLOW = 0.1
"""Friction has its full size beyond this speed, m/s."""

NEAR, NEAR_SHARE = 15.0, 0.05
"""The bottom may lie higher under the gear than under the ship by so much (m), and this part."""


STARTS = (0.5, 0.6, 0.7, 0.8, 0.9)
"""Parts of all states whose wing tips are above the ground where a search begins."""


@dataclass(frozen=True)
class Ground:
    """Ground force on nodes below a depth: friction, and a vertical reaction of the same size."""

    nodes: IntArray
    depth: float
    friction: float

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Friction against the velocity over ground, and an upward reaction of the same size, N."""
        below = (-positions[..., 2] - self.depth) / SOFT
        hold = 0.5 * self.friction * (1.0 + np.tanh(0.5 * below))
        upward = np.array([0.0, 0.0, 1.0])
        forces: FloatArray = hold[..., None] * (
            upward - velocities / length(velocities, SLOW)[..., None]
        )
        return forces


class BottomContact(Effect):
    """Ground contact of both lower wing tips beyond a depth."""

    def starts(self, depths: FloatArray) -> tuple[FloatArray, ...]:
        """Start values: the ground may lie anywhere between the depths of the wing tips.

        Between two of these a refit comes to rest at the wrong ground as well as at the right one.
        """
        return tuple(np.array([0.0, depth]) for depth in np.quantile(depths, STARTS))

    def is_possible(self, lowest: FloatArray, seabed: FloatArray) -> bool:
        """False if the echo sounder shows water under the net in all tows."""
        above = seabed * (1.0 - NEAR_SHARE) - NEAR
        return not bool(np.all(lowest < above))

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with ground under the wing tips."""
        friction, depth = map(float, values)
        foot = model.layout.footrope
        ground = Ground(np.array([foot[0], foot[-1]]), depth, friction)
        return replace(model, node_forces=(*model.node_forces, ground))


EFFECT = BottomContact(
    name='bottom_contact',
    sentence='Beyond a depth the lower wing tips drag over the bottom.',
    parameters=(
        Parameter('friction', 'N', 0.0, 0.0, 10e3, 2e3),
        Parameter('depth', 'm', 0.0, 0.0, 2000.0, 50.0),
    ),
    excited_by='depth near the bottom',
    confused_with=('net_drag', 'gear_weight'),
    direct='Look at the footrope and the clumps for mud and bright chain, and at the echo sounder '
    'for the depth where she towed.',
    causes='a net that was lowered too far, a bank or a slope, a wreck.',
)
