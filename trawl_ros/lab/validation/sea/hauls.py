# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Published hauls at sea compared with the model, point by point."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.sea.doubts import doubts_table
from trawl_ros.lab.validation.sea.modelled import ModelledHaul, is_right, modelled
from trawl_ros.lab.validation.sea.published import (
    PointRecord,
    PublishedHauls,
    ReferenceRecord,
    TrendRecord,
    published_hauls,
)
from trawl_ros.lab.validation.sea.tables import (
    FORCES,
    NEAR_PERCENT,
    changes_table,
    gears_table,
    percent,
    points_table,
    ratios_table,
    trends_table,
    word,
)
from trawl_ros.report.pictures import Drawing

MARKS = {
    'door_depth': 'v',
    'door_spread': 'o',
    'net_depth': '^',
    'vertical_opening': 's',
    'horizontal_opening': 'D',
    'warp_tension': 'P',
    'net_drag': 'X',
    'lower_bridle_tension': 'd',
    'board_attack': '>',
    'mouth_area': '*',
}


def haul_figure(
    points: Sequence[tuple[str, str, float, float, str]], near_percent: float
) -> Figure:
    """Draw model over sea, both logarithmic; forces (kN) apart from m, m² and °.

    Parameters
    ----------
    points
        Gear, quantity, measured value, value of the model (NaN for none), and use of the haul.
    near_percent
        Half width of the band around equality, %.
    """
    forces = [p for p in points if p[1] in FORCES]
    lengths = [p for p in points if p[1] not in FORCES]
    groups = [('m, m², °', 1.0, lengths)] + ([('kN', 1e-3, forces)] if forces else [])
    gears = list(dict.fromkeys(p[0] for p in points))
    figure = Figure(figsize=(5.2 * len(groups), 4.8), layout='constrained')
    for axes, (unit, scale, group) in zip(
        np.atleast_1d(figure.subplots(1, len(groups))), groups, strict=True
    ):
        labels = set()
        for gear, quantity, sea, model, use in group:
            colour = f'C{gears.index(gear)}'
            label = f'{gear}, {quantity.replace("_", " ")}'
            axes.loglog(
                scale * sea,
                scale * model,
                MARKS[quantity],
                color=colour,
                markerfacecolor=colour if use == 'counts' else 'none',
                label=None if label in labels else label,
            )
            labels.add(label)
        values = scale * np.array([p[2] for p in group] + [p[3] for p in group])
        values = values[np.isfinite(values)]
        ends = np.array([0.7 * values.min(), 1.4 * values.max()])
        axes.plot(ends, ends, 'k-', linewidth=0.8)
        near = near_percent / 100.0
        axes.fill_between(ends, (1 - near) * ends, (1 + near) * ends, color='k', alpha=0.08)
        axes.set(xlabel=f'sea / {unit}', ylabel=f'model / {unit}', xlim=ends, ylim=ends)
        axes.grid(which='both', alpha=0.3)
        axes.legend(fontsize='x-small')
    return figure


POINTS, GEARS = 20, 3
"""Numbers of points that count, and of gears they are of, that are asked for."""

MEDIAN_PERCENT, NEAR_SHARE_PERCENT = 15.0, 90.0
"""Largest median error, and share of the points that is to be off by less than 30 %."""

DEPTHS = ('net_depth', 'door_depth')
"""Quantities that are depths."""

SMALL = ('krill_1600',)
"""Gears of the small version, with coarse nets."""


def counted(hauls: Sequence[ModelledHaul]) -> list[tuple[ModelledHaul, PointRecord]]:
    """Points that count, each with its haul."""
    return [(one, p) for one in hauls if one.haul.use == 'counts' for p in one.haul.points]


def run(quick: bool) -> Findings:
    """Compare every published haul with the model."""
    published = published_hauls()
    gears = [gear for gear in published.gears if not quick or gear.gear in SMALL]
    hauls = [one for gear in gears for one in modelled(gear, quick=quick)]
    by_name = {(one.gear.gear, one.haul.name): one for one in hauls}
    trends = [trend for trend in published.trends if (trend.gear, trend.first) in by_name]
    counting = [trend for trend in trends if trend.counts]
    right = [is_right(trend, by_name) for trend in counting]
    points = counted(hauls)
    errors = _sizes(points)
    rows = [
        MeasuredValue(
            'points that count',
            float(len(points)),
            '',
            at_least(POINTS),
            'Other sources print no plan, no speed, or a drawing in place of figures: see the '
            'last table.',
            key='points',
        ),
        MeasuredValue(
            'gears with points that count',
            float(len({one.gear.gear for one, _ in points})),
            '',
            at_least(GEARS),
            'Each from a published plan, but for four_seam, whose net is assumed.',
            key='gears',
        ),
        _median('the points that count', 'median_error', errors, _worst(points)),
        MeasuredValue(
            f'points that count within {NEAR_PERCENT:g} %',
            100.0 * float(np.mean(errors <= NEAR_PERCENT)),
            '%',
            at_least(NEAR_SHARE_PERCENT),
            _worst(points),
            key='near',
        ),
        MeasuredValue(
            'trends with the right sign, or within their bound',
            100.0 * float(np.mean(right)) if right else math.nan,
            '%',
            at_least(100.0),
            _wrong(counting, right),
            key='trends',
        ),
        MeasuredValue(
            'hauls with a steady state',
            100.0 * float(np.mean([one.observables is not None for one in hauls])),
            '%',
            at_least(100.0),
            '; '.join(f'{one.gear.gear}: {one.refusal}' for one in hauls if one.refusal)
            or 'Found cold, or from the hauls before.',
            key='found',
        ),
    ]
    planned = _sizes([pair for pair in points if pair[0].gear.plan == 'published'])
    note = (
        f'{len(planned)} points, {(planned <= NEAR_PERCENT).sum()} of them within '
        f'{NEAR_PERCENT:g} %.'
    )
    what, key = 'the gears whose net plan is published', 'median_error_of_published_plans'
    rows.append(_median(what, key, planned, note))
    rows += _beside_reference(points, published.reference)
    for gear in gears:
        own = _sizes([pair for pair in points if pair[0].gear is gear])
        if len(own):
            note = (
                f'{len(own)} points, net plan {gear.plan}. Tuned: {gear.tuned.strip()}. '
                f'Assumed: {gear.assumed.strip()}'
            )
            rows.append(_median(gear.gear, f'median_error_of_{gear.gear}', own, note))
    return Findings(
        rows=tuple(rows),
        tables=(
            points_table(hauls, published),
            trends_table(trends, by_name),
            ratios_table(trends, by_name),
            changes_table(hauls, quick=quick),
            doubts_table(hauls, quick=quick),
            gears_table(gears, published),
            TextTable(
                'Looked at and not used.',
                ('source', 'why'),
                tuple((one.source.strip(), one.why.strip()) for one in published.not_used),
            ),
        ),
        drawings=(
            Drawing(
                'points',
                'The model over the sea; filled marks count, open ones are shown only. The band '
                f'is {NEAR_PERCENT:g} % to either side.',
                haul_figure(
                    [
                        (one.gear.gear, p.quantity, p.value, one.value(p.quantity), one.haul.use)
                        for one in hauls
                        for p in one.haul.points
                    ],
                    NEAR_PERCENT,
                ),
            ),
        ),
        text=(
            'Hauls, what may be tuned and what counts stand in config/hauls/published.yaml, which '
            'was committed before any of them was run, but for the two of krill_800; drag of nets '
            'and areas of mouths came later, before these were run, and so did trends of gear that '
            'no file here describes. A point is one quantity of one haul; its error is that of the '
            'model against the middle of what was printed, and infinite where the model has no '
            f'steady state. {_reference(published)}'
        ),
    )


def _sizes(points: Sequence[tuple[ModelledHaul, PointRecord]]) -> FloatArray:
    """Return the sizes (n,) of the errors of points, %."""
    return np.array([abs(one.error(point)) for one, point in points])


def _median(what: str, key: str, errors: FloatArray, note: str) -> MeasuredValue:
    median = float(np.median(errors)) if len(errors) else math.nan
    return MeasuredValue(
        f'median error of {what}', median, '%', at_most(MEDIAN_PERCENT), note, key=key
    )


def _beside_reference(
    points: Sequence[tuple[ModelledHaul, PointRecord]], reference: ReferenceRecord
) -> list[MeasuredValue]:
    """Rows on the largest errors of depth and drag, compared with those of others."""
    groups = (
        ('depth', 'depth', DEPTHS, reference.depth_percent),
        ('drag', 'drag and tension', FORCES, reference.drag_percent),
    )
    rows = []
    for key, what, quantities, limit in groups:
        chosen = [(one, p) for one, p in points if p.quantity in quantities]
        if chosen:
            errors = _sizes(chosen)
            rows.append(
                MeasuredValue(
                    f'largest error of {what}, of the points that count',
                    float(errors.max()),
                    '%',
                    at_most(limit),
                    f'{len(chosen)} points, median {np.median(errors):.1f} %. {_worst(chosen)}',
                    key=f'largest_error_of_{key}',
                )
            )
    return rows


def _reference(published: PublishedHauls) -> str:
    """Return a sentence on the source of these errors of others."""
    reference = published.reference
    return (
        f'Limits on the errors of depth and drag, {reference.depth_percent:g} and '
        f'{reference.drag_percent:g} %, are what others reached: '
        f'{published.sources[reference.source].title}.'
    )


def _worst(points: Sequence[tuple[ModelledHaul, PointRecord]]) -> str:
    """Return a sentence on the points with the largest errors."""
    ordered = sorted(points, key=lambda pair: -abs(pair[0].error(pair[1])))[:4]
    return 'Most off: ' + ', '.join(
        f'{one.gear.gear} {one.haul.name} {word(p.quantity)} {percent(one.error(p))}'
        for one, p in ordered
    )


def _wrong(trends: Sequence[TrendRecord], right: Sequence[bool]) -> str:
    wrong = [
        f'{trend.gear} {word(trend.quantity)} by {trend.by}, {trend.first} to {trend.second}'
        for trend, good in zip(trends, right, strict=True)
        if not good
    ]
    return f'Wrong: {"; ".join(wrong)}' if wrong else f'{len(trends)} trends.'


CASE = ValidationCase('hauls', 'Published hauls at sea', run)
