# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables of published hauls compared with the model."""

import math
from collections.abc import Sequence

from trawl_ros.lab.report.page import TextTable
from trawl_ros.lab.validation.sea.changes import CHANGES, changed_hauls, value_of
from trawl_ros.lab.validation.sea.modelled import (
    Modelled,
    ModelledHaul,
    gear_record,
    is_right,
    modelled_trend,
)
from trawl_ros.lab.validation.sea.published import GearHauls, PublishedHauls, TrendRecord
from trawl_ros.report.rendering import number

NEAR_PERCENT = 30.0
"""Error that most points should stay within, %."""

FORCES = ('warp_tension', 'net_drag', 'lower_bridle_tension')
"""Quantities in newtons."""


UNITS = {'warp_m': 'm of warp', 'speed_kn': 'knot'}
"""Units of the variables of slopes."""


def word(quantity: str) -> str:
    """Return the name of a quantity in words."""
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
    if quantity == 'mouth_area':
        return f'{value:.0f} m²'
    return f'{value:.1f}°' if quantity == 'board_attack' else f'{value:.1f} m'


def points_table(hauls: Sequence[ModelledHaul], published: PublishedHauls) -> TextTable:
    """Return a table of every point compared with the model."""
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
    return TextTable(
        f'Every published point, compared with the model. {sources}', head, tuple(rows)
    )


def trends_table(trends: Sequence[TrendRecord], hauls: Modelled) -> TextTable:
    """Return a table of signs and bounds of trends compared with the model."""
    rows = tuple(
        (
            trend.gear,
            word(trend.quantity),
            trend.by,
            f'{trend.first} to {trend.second}',
            _printed(trend),
            *(
                shown(hauls[trend.gear, name].value(trend.quantity), trend.quantity)
                for name in (trend.first, trend.second)
            ),
            'yes' if is_right(trend, hauls) else 'no',
            trend.source,
        )
        for trend in trends
        if trend.counts
    )
    model = ('model, first', 'model, second')
    head = ('gear', 'what', 'by', 'hauls', 'sea', *model, 'right', 'source')
    return TextTable('Signs of trends, and bounds on them, that sources print.', head, rows)


def _printed(trend: TrendRecord) -> str:
    """Sign or bound as a source prints it."""
    if trend.within is not None:
        return f'stays within {shown(trend.within, trend.quantity)}'
    assert trend.sign is not None
    return 'grows' if trend.sign > 0 else 'falls'


def ratios_table(trends: Sequence[TrendRecord], hauls: Modelled) -> TextTable:
    """Compare ratios and slopes with the model; ratios as changes in percent."""
    rows = []
    for trend in trends:
        if trend.counts:
            continue
        model = modelled_trend(trend, hauls)
        if trend.per is not None:
            sea, found = (f'{slope:.3f} per {UNITS[trend.per]}' for slope in (trend.slope, model))
        else:
            assert trend.ratio is not None
            sea, found = (f'{100.0 * (ratio - 1.0):+.1f} %' for ratio in (trend.ratio, model))
        where = f'{trend.first} to {trend.second}'
        found = found if math.isfinite(model) else 'no steady state'
        rows.append((trend.gear, word(trend.quantity), trend.by, where, sea, found, trend.source))
    return TextTable(
        'Ratios, as changes in percent, and slopes that sources print. They belong to other gears '
        'than those they are compared with, so they do not count.',
        ('gear', 'what', 'by', 'hauls', 'sea', 'model', 'source'),
        tuple(rows),
    )


def changes_table(hauls: Sequence[ModelledHaul], *, quick: bool) -> TextTable:
    """Points that count and are missed, with changes of what was not measured."""
    rows = []
    for one in hauls:
        missed = [p for p in one.haul.points if abs(one.error(p)) > NEAR_PERCENT]
        if one.haul.use != 'counts' or not missed:
            continue
        changed = changed_hauls(gear_record(one.gear, quick=quick), one.haul)
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
    """Return a table of the gears' sources, with tuned and assumed values."""
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
