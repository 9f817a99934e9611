# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Effects of warps, bridles, and of the weights of boards and clumps."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

SIDES = ('port', 'starboard')


@dataclass(frozen=True)
class BridleLength(Effect):
    """Additional length (m) of the upper and lower bridles on ``sides``."""

    sides: tuple[int, ...] = (0, 1)

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with longer bridles; all bars of a bridle grow by one factor."""
        longer = dict(zip(('upper', 'lower'), values, strict=True))
        names = {
            f'{SIDES[side]}_{own.name}_bridle': longer[own.at_net]
            for own in model.gear.bridles
            for side in self.sides
            if own.at_net in longer
        }
        rest = model.rest.copy()
        for name, _, bars in model.layout.lines:
            if name in names:
                rest[bars] *= 1.0 + names[name] / rest[bars].sum()
        return replace(model, rest=rest)


@dataclass(frozen=True)
class ClumpSide(Effect):
    """Additional weight in water at the lower wing tip of one side."""

    side: int = 0

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with another clump on this side; its volume does not change."""
        mass = model.lump_mass.copy()
        tip = model.layout.footrope[(0, -1)[self.side]]
        mass[tip] += values[0] / model.water.gravity
        return replace(model, lump_mass=mass)


class GearWeight(Effect):
    """Additional weight in water at each board and at each lower wing tip."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with heavier boards and clumps; volumes do not change."""
        board, clump = values / model.water.gravity
        mass = model.lump_mass.copy()
        foot = model.layout.footrope
        mass[[foot[0], foot[-1]]] += clump
        heavier = model.with_board(mass=model.board.mass + board)
        return replace(heavier, lump_mass=mass)


@dataclass(frozen=True)
class OtherWire(Effect):
    """Relative change of the warps' diameter; their weight in water goes with its square."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with warps of another diameter and the same share of steel."""
        factor = np.where(model.warp_side >= 0, 1.0 + values[0], 1.0)
        bars = model.bars
        thicker = replace(
            bars,
            mass=factor**2 * bars.mass,
            volume=factor**2 * bars.volume,
            stiffness=factor**2 * bars.stiffness,
            normal_area=factor * bars.normal_area,
            wet_area=factor * bars.wet_area,
        )
        return replace(model, bars=thicker)


class WarpStrumming(Effect):
    """Additional normal drag of the warps by vortex-induced vibration."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with scaled normal drag of the warps."""
        factor = np.where(model.warp_side >= 0, values[0], 1.0)
        bars = replace(model.bars, normal_drag=factor * model.bars.normal_drag)
        return replace(model, bars=bars)


def _bridles(name: str, whose: str, sides: tuple[int, ...], std: float) -> BridleLength:
    return BridleLength(
        name=name,
        sentence=f'{whose} bridles are longer or shorter than the gear file says.',
        parameters=(
            Parameter('upper', 'm', 0.0, -15.0, 15.0, std),
            Parameter('lower', 'm', 0.0, -15.0, 15.0, std),
        ),
        excited_by='any tow; upper against lower bridles by the opening',
        confused_with=('floats', 'gear_weight', 'board_rigging'),
        direct='Lay the bridles side by side on deck and measure them.',
        causes='a bridle that parted and was knotted or spliced, a bridle that has stretched, a '
        'chain piece more or less, a wrong bridle after a change of nets.',
        sides=sides,
    )


def _clump(side: int, word: str) -> ClumpSide:
    return ClumpSide(
        name=f'{word}_clump',
        sentence=f'The {word} clump is heavier or lighter in water than the gear file says.',
        parameters=(Parameter('weight', 'N', 0.0, -15000.0, 7500.0, 2000.0),),
        excited_by='low speed; the doors of both sides come to different depths',
        confused_with=('gear_weight', 'warp_asymmetry', f'{word}_bridle_length'),
        direct='Compare the clumps of both sides on deck, and weigh them.',
        causes='a lost clump or length of chain, a clump that belongs to another gear.',
        side=side,
    )


EFFECTS = (
    _bridles('bridle_length', 'The', (0, 1), 3.0),
    _bridles('port_bridle_length', 'The port', (0,), 1.5),
    _bridles('starboard_bridle_length', 'The starboard', (1,), 1.5),
    _clump(0, 'port'),
    _clump(1, 'starboard'),
    GearWeight(
        name='gear_weight',
        sentence='Boards or clumps are heavier or lighter in water than the gear file says.',
        parameters=(
            Parameter('board', 'N', 0.0, -7500.0, 7500.0, 1000.0),
            Parameter('clump', 'N', 0.0, -7500.0, 7500.0, 1000.0),
        ),
        excited_by='low speed',
        confused_with=('depth_sensor',),
        direct='Weigh the clumps, and compare the boards with their drawing: shoes, plates, water '
        'in hollow parts.',
        causes='clumps or chains of another weight, weights bolted to the boards or lost, flooded '
        'hollow boards.',
    ),
    OtherWire(
        name='other_wire',
        sentence='The warps are of a thicker or thinner wire than the gear file says.',
        parameters=(Parameter('diameter', '', 0.0, -0.3, 0.5, 0.1),),
        excited_by='warp length; low speed shows the weight, high speed the drag',
        confused_with=('warp_strumming', 'counter_scale', 'current_shear'),
        direct='Measure the diameter of both warps with a calliper, and look up the weight per '
        'metre.',
        causes='another wire on the drums, a worn wire, a new wire that is not in the gear file.',
    ),
    WarpStrumming(
        name='warp_strumming',
        sentence='The warps vibrate in the flow, or are fouled, and meet more drag across them.',
        parameters=(Parameter('factor', '', 1.0, 0.7, 2.5, 0.3),),
        excited_by='warp length',
        confused_with=('counter_scale', 'counter_offset', 'current_shear'),
        direct='Lay a hand on the warps at the blocks to feel strumming; look for weed and grease '
        'as they come in.',
        causes='warps that strum, weed or jellyfish on them, broken strands.',
    ),
)
