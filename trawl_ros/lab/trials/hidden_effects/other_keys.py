# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hidden causes on deck that the catalogue of effects does not have.

They change keys of the gear file. Certain changes of the gear file also count as right names.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Situation
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.hidden_effects.hidden import Hidden, ahead
from trawl_ros.lab.trials.hidden_effects.inside import Draw
from trawl_ros.lab.trials.hidden_effects.on_deck import (
    ON_DECK,
    RIGHT,
    DeckCause,
    added,
)
from trawl_ros.model.gear_model import GearModel

MIDDLE_HOURS = 1.4
"""Hours into a tow, about its middle."""


def torn_wing(rng: np.random.Generator) -> Hidden:
    """Port wing and the belly behind it, torn (less drag) or fouled (more drag)."""
    far = rng.uniform(0.25, 0.6)

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        net = model.net_bars
        middles = np.zeros((len(model.ends), 3))
        middles[net] = model.first_guess[model.ends[net]].mean(axis=1)
        ahead_most, aft_most = middles[net, 0].max(), middles[net, 0].min()
        in_front = middles[:, 0] > ahead_most - far * (ahead_most - aft_most)
        on = net & in_front & (middles[:, 1] > 0.0)
        more = np.where(on, 1.0 + size, 1.0)
        drag, friction = more * model.bars.normal_drag, more * model.bars.friction
        return replace(model, bars=replace(model.bars, normal_drag=drag, friction=friction))

    return Hidden('torn_wing', '', 0.2, (0.8, 2.0), gear=gear)


def _wire(gear: GearRecord, size: float) -> GearRecord:
    """Gear with a thicker wire, whose weight in water scales with the square of the diameter."""
    thicker = added('warp', 'diameter_m', factor=True)(gear, size)
    heavier = (1.0 + size) ** 2 - 1.0
    return added('warp', 'weight_in_water_n_m', factor=True)(thicker, heavier)


new_wire = DeckCause(
    'new_wire', 'warp.diameter_m, warp.weight_in_water_n_m', _wire, '', 0.05, (0.25, 0.4)
)


def _setting_in(name: str, *, reversed_: bool) -> Draw:
    """Current along the track that begins during the tow, at all depths below the log."""
    depths = np.array([0.0, 5.0, 30.0, 600.0])

    def draw(rng: np.random.Generator) -> Hidden:
        def gear(size: float, model: GearModel, at: Situation) -> GearModel:
            profile = np.array([0.0, 0.0, 1.0, 1.0]) * (at.hours - MIDDLE_HOURS)
            way: FloatArray = at.along if reversed_ else ahead(at)
            currents = size * profile[:, None] * way
            return replace(model, water=model.water.with_more_current(depths, currents))

        return Hidden(name, 'm/s per h', 0.05, (0.6, 0.6), gear=gear)

    return draw


NET_AND_CURRENTS: Mapping[str, Draw] = {
    'torn_wing': torn_wing,
    'new_wire': new_wire,
    'tide': _setting_in('tide', reversed_=True),
    'edge_of_current': _setting_in('edge_of_current', reversed_=False),
}

NET_AND_CURRENTS_RIGHT: Mapping[str, tuple[str, ...]] = {
    'torn_wing': ('port_net_damage',),
    'new_wire': ('other_wire',),
    'tide': ('current_in_time',),
    'edge_of_current': ('current_along_track',),
}
"""Cause → names of the catalogue that count as right."""


def _front_twine(gear: GearRecord, size: float) -> GearRecord:
    body = tuple(
        section.model_copy(update={'twine_diameter_m': section.twine_diameter_m * (1.0 + size)})
        if place < 2
        else section
        for place, section in enumerate(gear.netting.body)
    )
    netting = gear.netting.model_copy(update={'body': body})
    return gear.model_copy(update={'netting': netting})


OTHER_KEYS = (
    DeckCause('other_boards', 'board.area_m2',
              added('board', 'area_m2', factor=True), '', 0.05, (0.2, 0.2)),
    DeckCause('footrope_chain', 'footrope.weight_in_water_n_m',
              added('footrope', 'weight_in_water_n_m', factor=True), '', 0.1, (0.6, 0.6)),
    DeckCause('stretched_headrope', 'headrope.length_m',
              added('headrope', 'length_m', factor=True), '', 0.01, (0.04, 0.04)),
    DeckCause('heavy_kite', 'kite.mass_kg',
              added('kite', 'mass_kg', factor=True), '', 0.5, (0.5, 4.0)),
    DeckCause('other_front', 'netting.body[0], netting.body[1]',
              _front_twine, '', 0.1, (0.4, 0.8)),
)  # fmt: skip
"""The causes."""

CAUSES: Mapping[str, Draw] = {
    **ON_DECK,
    **{cause.name: cause for cause in OTHER_KEYS},
    **NET_AND_CURRENTS,
}
"""All causes on deck; those of the catalogue first."""

RIGHT_NAMES: Mapping[str, tuple[str, ...]] = {
    **RIGHT,
    **NET_AND_CURRENTS_RIGHT,
    'other_boards': ('board_damage',),
    'footrope_chain': (),
    'stretched_headrope': (),
    'heavy_kite': (),
    'other_front': ('net_drag',),
}
"""Cause → names of the catalogue that count as right."""

RIGHT_CHANGES: Mapping[str, tuple[str, ...]] = {
    'other_boards': ('board_area',),
    'footrope_chain': ('footrope_weight',),
    'stretched_headrope': ('headrope_length',),
    'heavy_kite': ('kite_weight',),
    'other_front': ('front_twine', 'twine'),
    'board_mass': ('board_mass',),
    'thicker_warps': ('warp_diameter',),
    'thicker_twine': ('twine',),
    'warp_hole': ('warp_hole_ahead',),
}
"""Cause → changes of the gear file that count as right where a name is not alone."""
