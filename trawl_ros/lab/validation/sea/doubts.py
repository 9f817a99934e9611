# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Uncertain numbers behind missed points, each over a range, and the value that a point would need.

The ranges were fixed before any run.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.records import EffectRecord, GearRecord
from trawl_ros.lab.report.doubts import need_in_words
from trawl_ros.lab.report.page import TextTable
from trawl_ros.lab.validation.sea.changes import STRUMMING, value_of
from trawl_ros.lab.validation.sea.modelled import ModelledHaul, gear_record
from trawl_ros.lab.validation.sea.published import PointRecord
from trawl_ros.lab.validation.sea.quantities import quantities
from trawl_ros.lab.validation.sea.tables import NEAR_PERCENT, shown, word
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import Equilibrium, steady_state

FRONT = 'front weight'
"""Name of the weights on the lower wings, which sources print for most hauls."""


@dataclass(frozen=True)
class Doubt:
    """Number that is assumed, or printed with a range: its change, and the factors tried."""

    what: str
    low: float
    high: float
    gear: Callable[[GearRecord, float], GearRecord] = lambda gear, factor: gear
    warp: bool = False
    speed: bool = False


def _effect(name: str, value: str, shift: float) -> Callable[[GearRecord, float], GearRecord]:
    def changed(gear: GearRecord, factor: float) -> GearRecord:
        effect = EffectRecord.model_validate({'name': name, 'values': {value: factor - shift}})
        return gear.model_copy(update={'effects': (*gear.effects, effect)})

    return changed


def _hung(kind: str) -> Callable[[GearRecord, float], GearRecord]:
    key = 'buoyancy_n' if kind == 'floats' else 'weight_in_water_n'

    def changed(gear: GearRecord, factor: float) -> GearRecord:
        hung = tuple(
            item.model_copy(update={key: factor * getattr(item, key)})
            if item.name == kind
            else item
            for item in gear.hung
        )
        return gear.model_copy(update={'hung': hung})

    return changed


def _strumming(gear: GearRecord, factor: float) -> GearRecord:
    drag = factor * gear.warp.normal_drag
    return gear.changed('warp', normal_drag=drag)


DOUBTS = (
    Doubt('drag of the net', 0.7, 2.0, _effect('net_drag', 'factor', 0.0)),
    Doubt('lift of the boards', 0.7, 1.3, _effect('board_damage', 'lift', 1.0)),
    Doubt('normal drag of the warps', 1.0, STRUMMING / 1.5, _strumming),
    Doubt('weights at the wings', 0.5, 2.0, _hung(FRONT)),
    Doubt('chain of the footrope', 0.5, 2.0, _hung('chain')),
    Doubt('buoyancy of the floats', 0.3, 1.5, _hung('floats')),
    Doubt('length of the warps', 0.7, 1.4, warp=True),
    Doubt('speed', 0.85, 1.2, speed=True),
)
"""Net: as far apart as empirical formulas are. Warps: up to a cable that strums. Rest: as far as
crews change it. Length of warps and weights are printed for some hauls, as their list says."""


def doubts_table(hauls: Sequence[ModelledHaul], *, quick: bool) -> TextTable:
    """Points that count and are missed, with what they need of each number alone."""
    rows: list[tuple[str, ...]] = []
    for one in hauls:
        missed = [p for p in one.haul.points if abs(one.error(p)) > NEAR_PERCENT]
        if one.haul.use == 'counts' and missed and one.observables is not None:
            rows += _rows(one, missed, quick=quick)
    return TextTable(
        f'Points that count and are off by more than {NEAR_PERCENT:g} %: each number changed '
        'alone, and the factors on it, of those tried, with which the point comes within '
        f'{NEAR_PERCENT:g} %.',
        ('point', 'sea', 'model', 'number', 'with the least', 'with the most', 'needs'),
        tuple(rows),
    )


def _rows(
    one: ModelledHaul, missed: Sequence[PointRecord], *, quick: bool
) -> list[tuple[str, ...]]:
    gear = one.haul.rigged(gear_record(one.gear, quick=quick))
    start = steady_state(build_model(gear), one.haul.warp_m, one.haul.speed).equilibrium
    rows = []
    for doubt in DOUBTS:
        ends = [_solved(one, gear, doubt, factor, start) for factor in (doubt.low, doubt.high)]
        for point in missed:
            values = [values.get(point.quantity, float('nan')) for values in ends]
            by_factor = {doubt.low: values[0], doubt.high: values[1]}
            by_factor[1.0] = one.value(point.quantity)
            rows.append(
                (
                    f'{one.gear.gear}, {one.haul.name}: {word(point.quantity)}',
                    shown(point.value, point.quantity),
                    shown(one.value(point.quantity), point.quantity),
                    doubt.what,
                    f'× {doubt.low:.3g}: {shown(by_factor[doubt.low], point.quantity)}',
                    f'× {doubt.high:.3g}: {shown(by_factor[doubt.high], point.quantity)}',
                    need_in_words(by_factor, point.value, NEAR_PERCENT / 100.0),
                )
            )
    return sorted(rows, key=lambda row: row[0])


def _solved(
    one: ModelledHaul, gear: GearRecord, doubt: Doubt, factor: float, start: Equilibrium
) -> dict[str, float]:
    """Quantities of a haul with one number changed; none without a steady state."""
    model = build_model(doubt.gear(gear, factor))
    warp = one.haul.warp_m * (factor if doubt.warp else 1.0)
    speed = one.haul.speed * (factor if doubt.speed else 1.0)
    try:
        steady = steady_state(model, warp, speed, start=start)
    except NoSteadyState:
        return {}
    derived = quantities(model, steady)
    return {
        point.quantity: value_of(steady.observables, derived, point.quantity)
        for point in one.haul.points
    }
