"""Causes on deck that the catalogue does not have, hidden by changing keys of the gear file, with
the changes of the gear file that count as right beside a name.
"""

from collections.abc import Mapping

from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.hidden_effects.inside import Draw
from trawl_ros.lab.trials.hidden_effects.net_and_currents import (
    NET_AND_CURRENTS,
    NET_AND_CURRENTS_RIGHT,
)
from trawl_ros.lab.trials.hidden_effects.on_deck import (
    ON_DECK,
    RIGHT,
    DeckCause,
    added,
)


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
