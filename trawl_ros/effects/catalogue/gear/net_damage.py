"""Damage of the net on one side: a section gone, torn open or fouled."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

FRONT = 0.5
"""Part of the net's length, from the wing tips, where the sides are apart: what is torn or fouled
farther back pulls at both."""


@dataclass(frozen=True)
class NetDamage(Effect):
    """Share of drag that netting and ropes of one side have more, in the front half of the net."""

    side: int = 0

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with more or less drag on this side of the net."""
        # Instruments load the catalogue too, but not the model.
        from trawl_ros.model.gear_model import OUTWARD

        astern, sideways, _ = _middles(model).T
        on = _front(model, astern) & (sideways * OUTWARD[self.side] > 0.0)
        factor = np.where(on, 1.0 + values[0], 1.0)
        bars = replace(
            model.bars,
            normal_drag=factor * model.bars.normal_drag,
            friction=factor * model.bars.friction,
        )
        return replace(model, bars=bars)


def _middles(model: 'GearModel') -> FloatArray:
    """Middles (m, 3) of the net's bars as they are drawn; 0 of all others."""
    middles = np.zeros((len(model.ends), 3))
    net = model.net_bars
    middles[net] = model.first_guess[model.ends[net]].mean(axis=1)
    return middles


def _front(model: 'GearModel', astern: FloatArray) -> BoolArray:
    """Flags (m,) of the bars in the front part of the net, by how far astern (m,) they are."""
    inside = astern[model.net_bars]
    front: BoolArray = model.net_bars & (
        astern > inside.max() - FRONT * (inside.max() - inside.min())
    )
    return front


def _damage(side: int, word: str) -> NetDamage:
    return NetDamage(
        name=f'{word}_net_damage',
        sentence=f'The {word} side of the net is torn or fouled, and has another drag.',
        parameters=(Parameter('drag', '', 0.0, -0.8, 2.0, 0.2),),
        excited_by='any tow; wing tips and doors of both sides come to pull unequally',
        confused_with=(f'{word}_board_damage', f'{word}_bridle_length', 'net_drag'),
        direct=f'Spread the {word} wing and the panels behind it on deck, and look at the lacing.',
        causes='a panel torn out or open along its seam, a wing that has turned over, weed, a rope '
        'or another gear hanging in the meshes of one side.',
        side=side,
    )


EFFECTS = (_damage(0, 'port'), _damage(1, 'starboard'))
