# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Effects of the net with its floats and kite, and of the catch."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

DAMAGED_LENGTH_FRACTION = 0.5
"""Part of the net's length, from the wing tips, in which damage is on one side.

Farther aft the sides lie close together: what is torn or fouled there pulls at both.
"""

REFERENCE_SPEED_M_S = 2.0
"""Speed at which the exponent of the net's drag changes nothing."""

LEAST_SPEED_M_S = 0.1
"""Speed below which the power of the speed stays constant."""


class CatchBuildUp(Effect):
    """Drag of the codend's end that grows with the time in the tow."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with the catch of the situation's hours."""
        ends = [points[-1] for name, points, _ in model.layout.lines if name == 'codend']
        area = model.lump_drag_area.copy()
        area[int(ends[-1])] += values[0] * at.hours
        return replace(model, lump_drag_area=area)


class LostFloats(Effect):
    """Share of all floats that is lost, with their drag."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with fewer floats, or more."""
        mass, volume, drag_area, added = values[0] * model.floats
        return replace(
            model,
            lump_mass=model.lump_mass - mass,
            lump_volume=model.lump_volume - volume,
            lump_drag_area=model.lump_drag_area - drag_area,
            lump_added=model.lump_added - added,
        )


class TornKite(Effect):
    """Share of the kite's area that is lost."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with a smaller kite, or a larger one."""
        kite = replace(model.kite, area=model.kite.area * (1.0 - values[0]))
        return replace(model, kite=kite)


class NetDrag(Effect):
    """Factor on the drag of netting and its ropes, and the speed's exponent in excess of two."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with scaled drag of the net."""
        factor, exponent = values
        speed = max(at.speed, LEAST_SPEED_M_S) / REFERENCE_SPEED_M_S
        return model.with_net(factor * speed**exponent, 1.0)


@dataclass(frozen=True)
class NetDamage(Effect):
    """Relative change of the drag of netting and ropes on one side of the net's front half."""

    side: int = 0

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with more or less drag on this side of the net."""
        # Imported here: instruments load the catalogue too, but not the model.
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
    """Return the middles (m, 3) of the net's bars in the first guess; 0 for all other bars."""
    middles = np.zeros((len(model.ends), 3))
    net = model.net_bars
    middles[net] = model.first_guess[model.ends[net]].mean(axis=1)
    return middles


def _front(model: 'GearModel', astern: FloatArray) -> BoolArray:
    """Return flags (m,) of the bars in the front part of the net, from their places (m,)."""
    inside = astern[model.net_bars]
    front: BoolArray = model.net_bars & (
        astern > inside.max() - DAMAGED_LENGTH_FRACTION * (inside.max() - inside.min())
    )
    return front


def _damage(side: int, word: str) -> NetDamage:
    return NetDamage(
        name=f'{word}_net_damage',
        sentence=f'The {word} side of the net is torn or fouled, so its drag differs.',
        parameters=(Parameter('drag', '', 0.0, -0.8, 2.0, 0.2),),
        excited_by='any tow; wing tips and doors of both sides come to pull unequally',
        confused_with=(f'{word}_board_damage', f'{word}_bridle_length', 'net_drag'),
        direct=f'Spread the {word} wing and the panels behind it on deck, and look at the lacing.',
        causes='a panel torn out or open along its seam, a wing that has turned over, weed, a rope '
        'or another gear hanging in the meshes of one side.',
        side=side,
    )


EFFECTS = (
    CatchBuildUp(
        name='catch_build_up',
        sentence='The catch fills the codend, whose drag grows during the tow.',
        parameters=(Parameter('drag_area', 'm² per h', 0.0, 0.0, 20.0, 3.0),),
        excited_by='time in the tow; the same warp length and speed early and late',
        confused_with=('net_drag', 'depth_sensor'),
        direct='Weigh the catch, and read the catch sensors.',
        causes='fish, jellyfish or mud in the codend.',
    ),
    LostFloats(
        name='floats',
        sentence='Some floats are lost, or there are more of them than the gear file says.',
        parameters=(Parameter('lost', '', 0.0, -0.6, 1.0, 0.15),),
        excited_by='the opening; low speed shows it most',
        confused_with=('gear_weight', 'bridle_length', 'kite'),
        direct='Count the floats on deck, and weigh one in each hand: flooded ones are heavy.',
        causes='floats torn off, crushed or flooded in deep tows, floats of another size.',
    ),
    TornKite(
        name='kite',
        sentence='The kite is torn or lost, or larger than the gear file says.',
        parameters=(Parameter('lost', '', 0.0, -2.0, 1.0, 0.3),),
        excited_by='the opening; high speed shows it most',
        confused_with=('floats',),
        direct='Look at the kite on deck: seams, lacing and setting ropes.',
        causes='a torn or twisted kite, parted lacing, another kite.',
    ),
    NetDrag(
        name='net_drag',
        sentence='The net is dirty, torn or not as drawn, so its drag differs.',
        parameters=(
            Parameter('factor', '', 1.0, 0.5, 2.0, 0.15),
            Parameter('exponent', '', 0.0, -1.0, 1.0, 0.3),
        ),
        excited_by='any tow; the exponent by speed',
        confused_with=('speed_log', 'spread_sensor', 'catch_build_up'),
        direct='Look over the netting on deck: slime, weed, torn panels, another twine than drawn.',
        causes='slime or weed, meshed fish, torn panels, netting that was replaced by another '
        'twine.',
    ),
    _damage(0, 'port'),
    _damage(1, 'starboard'),
)
