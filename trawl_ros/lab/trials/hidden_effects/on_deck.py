# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hidden causes on deck, with the names that count as right, fixed before any trial is made.

A cause changes keys of the plant's gear file, one side of its gear, or its instruments.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from trawl_ros.effects.base.effect import Situation
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.hidden_effects.hidden import Hidden, Readings, ahead
from trawl_ros.lab.trials.hidden_effects.inside import CABLES, Draw
from trawl_ros.lab.trials.hidden_effects.outside import MoreLoad
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.hooks import DRAG, LIFT

CACHED_GEARS = 64
"""Number of cached gear models, since cases tow the same gear in all states."""

NORMAL_DRAG, FRICTION = 0.985, 1.15
"""The plant's netting and its ropes have another law of drag: less across, more along the twine."""

Change = Callable[[GearRecord, float], GearRecord]


def with_other_law(model: GearModel) -> GearModel:
    """Gear with another law of drag of netting and its ropes."""
    net = np.isin(model.ends, model.layout.net).all(axis=1)
    bars = replace(
        model.bars,
        normal_drag=np.where(net, NORMAL_DRAG, 1.0) * model.bars.normal_drag,
        friction=np.where(net, FRICTION, 1.0) * model.bars.friction,
    )
    return replace(model, bars=bars)


@lru_cache(CACHED_GEARS)
def _built(gear: GearRecord) -> GearModel:
    return with_other_law(build_model(gear))


@dataclass(frozen=True)
class DeckCause:
    """Cause that is hidden in a plant `with_other_law` by changing a key of its gear file.

    Attributes
    ----------
    name
        Of the cause.
    key
        The key that is changed.
    change
        The gear file with a change of a size.
    unit, probe, most
        As `Hidden` has them.
    """

    name: str
    key: str
    change: Change
    unit: str
    probe: float
    most: tuple[float, float]

    def __call__(self, rng: np.random.Generator) -> Hidden:
        """Return the hidden effect; it has no random shape."""

        def gear(size: float, model: GearModel, at: Situation) -> GearModel:
            if size == 0.0:
                return model
            built = _built(self.change(model.gear, size))
            return built.with_coefficients(model.coefficients)

        return Hidden(self.name, self.unit, self.probe, self.most, gear=gear)


def added(*path: str, factor: bool = False) -> Change:
    """Change of a number: a size added to it, or as a part of it."""

    def change(gear: GearRecord, size: float) -> GearRecord:
        records = [gear]
        for name in path[:-1]:
            records.append(getattr(records[-1], name))
        value = getattr(records[-1], path[-1])
        new = value * (1.0 + size) if factor else value + size
        for record, name in zip(reversed(records), reversed(path), strict=True):
            new = record.model_copy(update={name: new})
        assert isinstance(new, GearRecord)
        return new

    return change


def _lost_floats(gear: GearRecord, size: float) -> GearRecord:
    less = added('floats', 'buoyancy_n', factor=True)(gear, -size)
    return added('floats', 'drag_area_m2', factor=True)(less, -size)


def _longer(end: str) -> Change:
    def change(gear: GearRecord, size: float) -> GearRecord:
        bridles = tuple(
            own.model_copy(update={'length_m': gear.bridle_of(own).length_m + size})
            if own.at_net == end
            else own
            for own in gear.bridles
        )
        return gear.model_copy(update={'bridles': bridles})

    return change


def _twine(gear: GearRecord, size: float) -> GearRecord:
    body, codend = (
        tuple(
            section.model_copy(update={'twine_diameter_m': section.twine_diameter_m * (1.0 + size)})
            for section in sections
        )
        for sections in (gear.netting.body, gear.netting.codend)
    )
    netting = gear.netting.model_copy(update={'body': body, 'codend': codend})
    return gear.model_copy(update={'netting': netting})


def _forward(gear: GearRecord, size: float) -> GearRecord:
    x, y, z = gear.board.fastening.warp_m
    fastening = gear.board.fastening.model_copy(update={'warp_m': (x + size, y, z)})
    board = gear.board.model_copy(update={'fastening': fastening})
    return gear.model_copy(update={'board': board})


_ANGLES = ('board', 'installation')
BY_KEY = (
    DeckCause('rigging_epsilon', 'board.installation.epsilon_deg',
              added(*_ANGLES, 'epsilon_deg'), 'deg', 1.0, (8.0, 8.0)),
    DeckCause('rigging_zeta', 'board.installation.zeta_deg',
              added(*_ANGLES, 'zeta_deg'), 'deg', 1.0, (8.0, 8.0)),
    DeckCause('rigging_eta', 'board.installation.eta_deg',
              added(*_ANGLES, 'eta_deg'), 'deg', 1.0, (8.0, 8.0)),
    DeckCause('warp_hole', 'board.fastening.warp_m[0]', _forward, 'm', 0.03, (0.2, 0.2)),
    DeckCause('board_mass', 'board.mass_kg',
              added('board', 'mass_kg', factor=True), '', 0.05, (0.3, 0.3)),
    DeckCause('upper_bridles', 'bridles.upper.length_m', _longer('upper'), 'm', 2.0, (12.0, 12.0)),
    DeckCause('lower_bridles', 'bridles.lower.length_m', _longer('lower'), 'm', 2.0, (12.0, 12.0)),
    DeckCause('floats_gone', 'floats.buoyancy_n, floats.drag_area_m2',
              _lost_floats, '', 0.1, (0.5, 0.9)),
    DeckCause('clumps', 'clump.weight_in_water_n',
              added('clump', 'weight_in_water_n', factor=True), '', 0.1, (0.6, 0.4)),
    DeckCause('kite_gone', 'kite.area_m2',
              added('kite', 'area_m2', factor=True), '', 0.3, (0.95, 2.0)),
    DeckCause('thicker_warps', 'warp.diameter_m',
              added('warp', 'diameter_m', factor=True), '', 0.1, (0.2, 0.4)),
    DeckCause('thicker_twine', 'netting.body[].twine_diameter_m', _twine, '', 0.1, (0.3, 0.6)),
)  # fmt: skip
"""Causes that change a key of the gear file."""


def port_board_turned(rng: np.random.Generator) -> Hidden:
    """One board alone, shackled into another hole."""
    axis = int(rng.integers(3))

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        turn = np.zeros((2, 3))
        turn[0, axis] = np.radians(size)
        port, starboard = (tuple(map(float, own)) for own in turn)
        return model.with_board(rerigged=(port, starboard))

    return Hidden('port_board_turned', 'deg', 1.0, (8.0, 8.0), gear=gear)


def port_board_lift(rng: np.random.Generator) -> Hidden:
    """Port board that is bent or has lost a slat."""

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        return model.with_board(coefficient_modifier=MoreLoad(size, LIFT, 1.0, side=0))

    return Hidden('port_board_lift', '', 0.1, (0.6, 0.6), gear=gear)


def starboard_board_drag(rng: np.random.Generator) -> Hidden:
    """Starboard board that drags an object along."""

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        return model.with_board(coefficient_modifier=MoreLoad(size, DRAG, 0.0, side=1))

    return Hidden('starboard_board_drag', '', 0.1, (0.0, 1.0), gear=gear)


def starboard_bridle(rng: np.random.Generator) -> Hidden:
    """Upper bridle of one side that parted and was knotted."""

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        rest = model.rest.copy()
        (bars,) = [own for name, _, own in model.layout.lines if name == 'starboard_upper_bridle']
        rest[bars] += size / len(bars)
        return replace(model, rest=rest)

    return Hidden('starboard_bridle', 'm', 1.0, (10.0, 3.0), gear=gear)


def port_clump_lost(rng: np.random.Generator) -> Hidden:
    """Clump of one side that lost chain."""

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        mass = model.lump_mass.copy()
        mass[model.layout.footrope[0]] -= size / model.water.gravity
        return replace(model, lump_mass=mass)

    return Hidden('port_clump_lost', 'N', 1000.0, (5e3, 11e3), gear=gear)


def doors_swapped(rng: np.random.Generator) -> Hidden:
    """Door sensors swapped between the doors; all or nothing."""
    quantities = ('door_depth', 'pitch', 'roll')

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        if size == 0.0:
            return readings
        names = [(f'port_{name}', f'starboard_{name}') for name in quantities]
        port = {left: readings[right] for left, right in names}
        return readings | port | {right: readings[left] for left, right in names}

    return Hidden('doors_swapped', '', 1.0, (0.0, 1.0), shown=shown, whole=True)


def cells_one_side(rng: np.random.Generator) -> Hidden:
    """Load cells with swapped plugs, all or nothing; only unequal sides show it."""

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        if size == 0.0:
            return readings
        port, starboard = CABLES
        return readings | {port: readings[starboard], starboard: readings[port]}

    return Hidden('cells_swapped', '', 1.0, (0.0, 1.0), shown=shown, whole=True)


def pitch_askew(rng: np.random.Generator) -> Hidden:
    """Attitude sensor of one door mounted askew, mostly in pitch."""
    roll = rng.uniform(-0.2, 0.2)

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        return readings | {
            'port_pitch': readings['port_pitch'] + size,
            'port_roll': readings['port_roll'] + roll * size,
        }

    return Hidden('pitch_askew', 'rad', 0.05, (0.35, 0.35), shown=shown)


def crabbing(rng: np.random.Generator) -> Hidden:
    """Ship that crabs through the water while she keeps the same heading to the wind."""

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        east, north = ahead(at)
        aside = at.speed * np.sin(size) * np.array([north, -east])
        depths = np.array([0.0, 4.0, 2000.0])
        water = model.water.with_more_current(depths, np.stack([np.zeros(2), aside, aside]))
        return replace(model, water=water)

    return Hidden('crabbing', 'rad', 0.05, (0.3, 0.3), gear=gear)


ON_DECK: Mapping[str, Draw] = {
    **{cause.name: cause for cause in BY_KEY},
    'port_board_turned': port_board_turned,
    'port_board_lift': port_board_lift,
    'starboard_board_drag': starboard_board_drag,
    'starboard_bridle': starboard_bridle,
    'port_clump_lost': port_clump_lost,
    'doors_swapped': doors_swapped,
    'cells_swapped': cells_one_side,
    'pitch_askew': pitch_askew,
    'crabbing': crabbing,
}

RIGHT: Mapping[str, tuple[str, ...]] = {
    'rigging_epsilon': ('board_rigging',),
    'rigging_zeta': ('board_rigging',),
    'rigging_eta': ('board_rigging',),
    'warp_hole': ('board_rigging',),
    'board_mass': ('gear_weight',),
    'upper_bridles': ('bridle_length',),
    'lower_bridles': ('bridle_length',),
    'floats_gone': ('floats',),
    'clumps': ('gear_weight',),
    'kite_gone': ('kite',),
    'thicker_warps': ('warp_strumming', 'other_wire'),
    'thicker_twine': ('net_drag',),
    'port_board_turned': ('port_board_rigging',),
    'port_board_lift': ('port_board_damage',),
    'starboard_board_drag': ('starboard_board_damage',),
    'starboard_bridle': ('starboard_bridle_length',),
    'port_clump_lost': ('port_clump',),
    'doors_swapped': ('swapped_doors',),
    'cells_swapped': ('swapped_cells',),
    'pitch_askew': ('attitude_mount',),
    'crabbing': ('leeway',),
}
"""Cause → names of the catalogue that count as right."""
