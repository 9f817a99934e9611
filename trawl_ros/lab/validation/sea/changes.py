# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Changes of quantities not measured at sea, and their effect on hauls that the model misses."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.records import EffectRecord, GearRecord
from trawl_ros.lab.validation.sea.published import HaulRecord
from trawl_ros.lab.validation.sea.quantities import quantities
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.observables import Observables
from trawl_ros.solver.equilibrium import steady_state

STRUMMING = 2.35
"""Normal drag coefficient of a vibrating tow cable at sea, the middle of 2.2 to 2.5."""

NET_DRAG = 2.0
"""Factor on the net's drag.

Reid's and MacLennan's formulas give 1.4 to 2.1 times that of the krill nets as built, at 2 knots.
"""

SPEED_FACTOR = 2.9 / 2.7
"""Factor on speed: upper end over middle of the range printed for one haul."""


@dataclass(frozen=True)
class Change:
    """Change of a gear, and factor on its towing speed."""

    what: str
    gear: Callable[[GearRecord], GearRecord] = lambda gear: gear
    speed: float = 1.0


def _strumming(gear: GearRecord) -> GearRecord:
    return gear.changed('warp', normal_drag=STRUMMING)


def _net_drag(gear: GearRecord) -> GearRecord:
    effect = EffectRecord.model_validate({'name': 'net_drag', 'values': {'factor': NET_DRAG}})
    return gear.model_copy(update={'effects': (*gear.effects, effect)})


def _no_floats(gear: GearRecord) -> GearRecord:
    return gear.model_copy(update={'hung': tuple(item for item in gear.hung if item.sinks)})


def _unshielded(gear: GearRecord) -> GearRecord:
    assert gear.netting.plan is not None
    return gear.changed('netting', plan=gear.netting.plan.model_copy(update={'shielded': False}))


CHANGES = (
    Change('no shielding', _unshielded),
    Change(f'warps that strum, C_N {STRUMMING:g}', _strumming),
    Change(f'net drag × {NET_DRAG:g}', _net_drag),
    Change(f'{100 * (SPEED_FACTOR - 1):.0f} % faster', speed=SPEED_FACTOR),
    Change('the last three', lambda gear: _strumming(_net_drag(gear)), SPEED_FACTOR),
    Change(
        "no growth of twine's drag at low Reynolds numbers",
        lambda gear: gear.changed('netting', viscous=0.0),
    ),
    Change('no lift of sheets', lambda gear: gear.changed('netting', lift=0.0)),
    Change('no floats', _no_floats),
)


def changed_hauls(
    gear: GearRecord, haul: HaulRecord
) -> list[tuple[Observables | None, Mapping[str, float]]]:
    """Observables and derived quantities of a haul with each of `CHANGES` of the gear.

    A change without a steady state gives None and an empty mapping.
    """
    found: list[tuple[Observables | None, Mapping[str, float]]] = []
    for change in CHANGES:
        model = build_model(change.gear(haul.rigged(gear)))
        try:
            steady = steady_state(model, haul.warp_m, change.speed * haul.speed)
        except NoSteadyState:
            found.append((None, {}))
        else:
            found.append((steady.observables, quantities(model, steady)))
    return found


def value_of(observables: Observables | None, derived: Mapping[str, float], quantity: str) -> float:
    """Return the quantity of this name; NaN without observables."""
    if observables is None:
        return float('nan')
    if quantity in derived:
        return derived[quantity]
    return float(np.real(getattr(observables, quantity)))
