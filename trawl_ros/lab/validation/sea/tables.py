"""Tables of published hauls beside the model."""

import math
from collections.abc import Mapping, Sequence

from trawl_ros.lab.report.page import TextTable
from trawl_ros.lab.validation.sea.changes import CHANGES, changed_hauls, value_of
from trawl_ros.lab.validation.sea.modelled import ModelledHaul, gear_record, right_sign
from trawl_ros.lab.validation.sea.published import GearHauls, PublishedHauls, TrendRecord
from trawl_ros.report.rendering import number

NEAR_PERCENT = 30.0
"""Error that most points are to stay within, %."""

FORCES = ('warp_tension', 'net_drag')
"""Quantities in newtons."""


def word(quantity: str) -> str:
    """Quantity in words."""
    return quantity.replace('_', ' ')


def percent(error: float) -> str:
    """Error with its sign."""
    return f'{error:+.0f} %' if math.isfinite(error) else 'no steady state'


def shown(value: float, quantity: str) -> str:
    """Value with its unit."""
    if math.isnan(value):
        return '–'
    if quantity in FORCES:
        return f'{number(value / 1e3)} kN'
    return f'{value:.0f} m²' if quantity == 'mouth_area' else f'{value:.1f} m'


def points_table(hauls: Sequence[ModelledHaul], published: PublishedHauls) -> TextTable:
    """Every point beside the model."""
    uses = {'counts': 'counts', 'tunes': 'tuned by it', 'told': 'shown only'}
    rows = []
    for one in hauls:
        for point in one.haul.points:
            ends = '' if point.low is None else f' ({point.low:g} to {point.high:g})'
            rows.append(
                (
                    one.gear.gear,
                    one.haul.name,
                    f'{one.haul.warp_m:g} m',
                    f'{one.haul.speed:.2f} m/s',
                    word(point.quantity),
                    shown(point.value, point.quantity) + ends,
                    shown(one.value(point.quantity), point.quantity),
                    percent(one.error(point)),
                    uses[one.haul.use],
                    point.source or one.gear.source,
                )
            )
    head = ('gear', 'haul', 'warp', 'speed', 'what', 'sea', 'model', 'error', 'use', 'source')
    sources = '; '.join(f'{key}: {source.title}' for key, source in published.sources.items())
    return TextTable(f'Every published point beside the model. {sources}', head, tuple(rows))


def trends_table(
    trends: Sequence[TrendRecord],
    hauls: Mapping[tuple[str, str], ModelledHaul],
    published: PublishedHauls,
) -> TextTable:
    """Every trend beside the model."""
    rows = tuple(
        (
            trend.gear,
            word(trend.quantity),
            trend.by,
            f'{trend.first} to {trend.second}',
            'grows' if trend.sign > 0 else 'falls',
            *(
                shown(hauls[trend.gear, name].value(trend.quantity), trend.quantity)
                for name in (trend.first, trend.second)
            ),
            'yes' if right_sign(trend, hauls) else 'no',
        )
        for trend in trends
    )
    head = ('gear', 'what', 'by', 'hauls', 'sea', 'model, first', 'model, second', 'right')
    return TextTable('Signs of trends that sources print.', head, rows)


def changes_table(hauls: Sequence[ModelledHaul], *, small: bool) -> TextTable:
    """Points that count and are missed, with changes of what was not measured."""
    rows = []
    for one in hauls:
        missed = [p for p in one.haul.points if abs(one.error(p)) > NEAR_PERCENT]
        if one.haul.use != 'counts' or not missed:
            continue
        changed = changed_hauls(gear_record(one.gear, small=small), one.haul)
        for point in missed:
            values = (value_of(*seen, point.quantity) for seen in changed)
            rows.append(
                (
                    f'{one.gear.gear}, {one.haul.name}: {word(point.quantity)}',
                    shown(point.value, point.quantity),
                    shown(one.value(point.quantity), point.quantity),
                    *(shown(value, point.quantity) for value in values),
                )
            )
    head = ('point', 'sea', 'model', *(change.what for change in CHANGES))
    return TextTable(
        f'Points that count and are off by more than {NEAR_PERCENT:g} %, with changes of what was '
        'not measured.',
        head,
        tuple(rows),
    )


def gears_table(gears: Sequence[GearHauls], published: PublishedHauls) -> TextTable:
    """Sources of the gears, what was tuned and what assumed."""
    return TextTable(
        'What was tuned and assumed.',
        ('gear', 'source', 'tuned', 'assumed'),
        tuple(
            (
                gear.gear,
                published.sources[gear.source].address,
                gear.tuned.strip(),
                gear.assumed.strip(),
            )
            for gear in gears
        ),
    )
