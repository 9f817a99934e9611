# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Time histories of every quantity: truth as thin dark lines, readings as dots, silence as bars."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import blended_transform_factory
from scipy.ndimage import median_filter

from trawl_ros.core.arrays import FloatArray
from trawl_ros.plots.records import Series, TowHistory
from trawl_ros.records.truth import SIDES
from trawl_ros.report import style

LONGEST_PERIODS, LEAST_SILENCE_S = 4.0, 10.0
"""A sensor is silent when nothing has come for so many of its periods, and for so long (s)."""


@dataclass(frozen=True)
class DotOptions:
    """Options of the dots that show readings.

    Attributes
    ----------
    most : int
        Number of dots of a curve; of more readings every so-manieth is drawn.
    neighbours : int
        Number of readings whose median decides whether one of them is an outlier.
    far_std : float
        Distance from that median, in robust standard deviations, beyond which a reading is an
        outlier (Hampel's filter) and does not widen the axis.
    """

    most: int = 600
    neighbours: int = 15
    far_std: float = 6.0


DOTS = DotOptions()


@dataclass(frozen=True)
class Curve:
    """Curve: a quantity of `TowHistory` with its label, and how readings and truth look."""

    name: str
    label: str
    colour: str
    truth_colour: str
    marker: str = 'o'
    dashes: str = '-'


@dataclass(frozen=True)
class Panel:
    """Panel of curves on one axis.

    Values are ``scale`` times SI, over a range of at least ``least``.
    """

    label: str
    curves: tuple[Curve, ...]
    least: float
    scale: float = 1.0
    down: bool = False


def _sides(name: str) -> tuple[Curve, Curve]:
    return (
        Curve(f'port_{name}', 'port', style.PORT, style.PORT_TRUTH),
        Curve(
            f'starboard_{name}', 'starboard', style.STARBOARD, style.STARBOARD_TRUTH, '+', '--',
        ),
    )  # fmt: skip


def _one(name: str, label: str = '') -> Curve:
    return Curve(name, label, style.MEASURED, style.MEASURED_TRUTH)


def _other(name: str, label: str) -> Curve:
    return Curve(name, label, style.SECOND, style.SECOND_TRUTH)


DEGREES = float(np.degrees(1.0))

PANELS = (
    Panel('warp length / m', _sides('length'), 2.0),
    Panel('warp tension / kN', _sides('tension'), 5.0, scale=1e-3),
    Panel('door depth / m', _sides('door_depth'), 2.0, down=True),
    Panel('door spread / m', (_one('door_spread'),), 2.0),
    Panel('door pitch, nose down / °', _sides('pitch'), 4.0, scale=DEGREES),
    Panel('door roll, top to starboard / °', _sides('roll'), 4.0, scale=DEGREES),
    Panel('net depth / m', (_one('net_depth'),), 2.0, down=True),
    Panel('opening / m', (_one('opening_height', 'height'), _other('opening_width', 'width')), 4.0),
    Panel(
        'speed / (m/s)',
        (_one('speed_water', 'through water'), _other('speed_ground', 'over ground')),
        0.2,
    ),
    Panel('true heading / °', (_one('heading'),), 4.0),
)


def present_panels(tow: TowHistory) -> list[Panel]:
    """Panels for which the bag holds data."""
    return [
        panel
        for panel in PANELS
        if any(curve.name in tow.truth or curve.name in tow.measured for curve in panel.curves)
    ]


def left_out(tow: TowHistory) -> list[str]:
    """Return a sentence on everything missing in the histories, or none."""
    sentences = []
    shown = present_panels(tow)
    if missing := [_plain(panel) for panel in PANELS if panel not in shown]:
        sentences.append(f'Not in the bag, so not drawn: {", ".join(missing)}.')
    for kind, there in (('Not measured', tow.measured), ('Truth is missing', tow.truth)):
        names = [
            f'{_plain(panel)} ({curve.label})' if curve.label else _plain(panel)
            for panel in shown
            for curve in panel.curves
            if curve.name not in there
        ]
        if there and names:
            sentences.append(f'{kind}: {", ".join(names)}.')
    if not tow.truth:
        sentences.append('The bag holds no truth, only what was measured.')
    return sentences


def _plain(panel: Panel) -> str:
    return panel.label.partition(' /')[0].partition(',')[0]


def history_figure(tow: TowHistory) -> Figure:
    """Draw all panels for which the bag holds data, over the same time axis."""
    panels = present_panels(tow)
    rows = (len(panels) + 1) // 2
    figure = Figure(figsize=(12.0, 0.9 + 2.0 * rows), layout='constrained')
    grid = figure.subplots(rows, 2, sharex=True, squeeze=False)
    marks: dict[str, Line2D | Patch] = {}
    if tow.truth:
        marks['truth'] = Line2D([], [], color='#333333', linewidth=1.0)
    for axes, panel in zip(grid.flat, panels, strict=False):
        _draw(axes, panel, tow, marks)
    for axes in grid.flat[len(panels) :]:
        axes.remove()
    for column in range(min(2, len(panels))):
        last = grid[(len(panels) - 1 - column) // 2, column]
        last.set_xlabel('time since the start / min')
        last.tick_params(labelbottom=True)
    grid[0, 0].set_xlim(0.0, max(tow.duration_s, 1.0) / 60.0)
    figure.suptitle(tow.name, fontsize='large', parse_math=False)
    figure.legend(
        handles=[*marks.values(), *_SIDES], labels=[*marks, *SIDES], loc='outside lower center',
        ncols=len(marks) + len(_SIDES), frameon=False, fontsize='small',
    )  # fmt: skip
    return figure


_GREY = '#666666'
_SIDES = (
    Line2D([], [], color=style.PORT, marker='o', ms=4.0),
    Line2D([], [], color=style.STARBOARD, marker='+', ls='--'),
)


def _draw(axes: Axes, panel: Panel, tow: TowHistory, marks: dict[str, Line2D | Patch]) -> None:
    """Draw one panel, and add the kinds of marks in it to ``marks``."""
    style.quiet(axes)
    truth, measured = (
        {curve: _shown(there[curve.name], panel) for curve in panel.curves if curve.name in there}
        for there in (tow.truth, tow.measured)
    )
    low, high = _limits(list(truth.values()), list(measured.values()), panel.least)
    axes.set_ylim((high, low) if panel.down else (low, high))
    beyond = 0
    for number, (curve, series) in enumerate(measured.items()):
        marks['measured'] = Line2D([], [], color=_GREY, ls='', marker='.')
        beyond += _dots(axes, series, curve, (low, high))
        if _silences(axes, silences(series, tow.duration_s), curve.colour, number):
            marks['bar at the foot: silent'] = Patch(color=_GREY, alpha=0.5)
    if beyond:
        marks['measured, beyond the axis'] = Line2D([], [], color=_GREY, ls='', marker='^', ms=5)
        axes.set_title(f'{beyond} beyond the axis', loc='right', fontsize='small', color=_GREY)
    for curve, series in truth.items():
        times, values = _with_gaps(series)
        axes.plot(
            times / 60.0, values, curve.dashes, color=curve.truth_colour, linewidth=1.0, zorder=3
        )
    _label(axes, panel)


def _label(axes: Axes, panel: Panel) -> None:
    """Label a panel at the top left, with the curves' names in their colours."""
    what, _, unit = panel.label.partition(' / ')
    text = axes.text(
        0.0, 1.03, f'{what} / {unit}', ha='left', va='bottom', transform=axes.transAxes
    )
    for curve in panel.curves:
        if curve.label not in ('', *SIDES):
            text = axes.annotate(
                curve.label, (1.0, 0.0), (10.0, 0.0), xycoords=text, textcoords='offset points',
                color=curve.colour, fontsize='small', va='bottom',
            )  # fmt: skip


def _shown(series: Series, panel: Panel) -> Series:
    if panel.curves[0].name == 'heading':
        return Series(series.times, style.compass(series.values))
    return Series(series.times, panel.scale * series.values)


def _limits(
    truth: Sequence[Series], measured: Sequence[Series], least: float
) -> tuple[float, float]:
    """Limits that hold the truth and all readings that are not outliers."""
    true = [series.values[np.isfinite(series.values)] for series in truth]
    every = np.concatenate([[], *true, *map(_ordinary, measured)])
    if not len(every):
        return 0.0, least
    low, high = float(every.min()), float(every.max())
    short = max(least - (high - low), 0.0)
    margin = 0.06 * (high - low + short)
    return low - 0.5 * short - margin, high + 0.5 * short + margin


def _ordinary(series: Series) -> FloatArray:
    """Readings near the median of their neighbours: an echo is left out, a haul is not."""
    values = series.values[np.isfinite(series.values)]
    if not len(values):
        return values
    off = np.abs(values - median_filter(values, size=DOTS.neighbours, mode='nearest'))
    std = max(1.4826 * float(np.median(off)), 1e-3 * float(np.median(np.abs(values))))
    ordinary: FloatArray = values[off <= DOTS.far_std * std]
    return ordinary


def _dots(axes: Axes, series: Series, curve: Curve, limits: tuple[float, float]) -> int:
    """Draw readings; return the number that lie beyond the axis and are drawn at its edge."""
    step = max(len(series.values) // DOTS.most, 1)
    # Sides lie on each other: one has full dots, the other crosses, at other times.
    drawn = slice(step // 2 if curve.marker == '+' else 0, None, step)
    size = float(np.clip(60.0 / np.sqrt(max(len(series.values[drawn]), 1)), 1.8, 4.0))
    look: dict[str, Any] = {'color': curve.colour, 'ls': '', 'zorder': 2}
    width = 0.0 if curve.marker == 'o' else 0.6
    axes.plot(
        series.times[drawn] / 60.0, series.values[drawn], marker=curve.marker, alpha=0.6,
        ms=size if curve.marker == 'o' else 1.6 * size, markeredgewidth=width, **look,
    )  # fmt: skip
    low, high = limits
    beyond = 0
    for out, edge in ((series.values > high, high), (series.values < low, low)):
        if out.any():
            marker = '^' if (edge == high) != axes.yaxis_inverted() else 'v'
            times = series.times[out] / 60.0
            axes.plot(
                times, np.full(len(times), edge), marker=marker, ms=5.0, clip_on=False,
                markeredgewidth=0.0, **look,
            )  # fmt: skip
            beyond += len(times)
    return beyond


def silences(series: Series, duration: float) -> list[tuple[float, float]]:
    """Intervals (s, from and to) without readings, also at the end; NaN counts as no reading."""
    times = series.times[np.isfinite(series.values)]
    if len(series.times) < 2 or not len(times):
        return [(0.0, duration)] if not len(times) else []
    period = float(np.median(np.diff(series.times)))
    longest = max(LONGEST_PERIODS * period, LEAST_SILENCE_S)
    edges = np.concatenate([[0.0], times, [duration]])
    return [(float(a), float(b)) for a, b in pairwise(edges) if b - a > longest]


def _silences(axes: Axes, spans: Sequence[tuple[float, float]], colour: str, number: int) -> bool:
    """Draw bars at the bottom of the panel, one row per curve; return True if there are any."""
    foot = blended_transform_factory(axes.transData, axes.transAxes)
    for begin, end in spans:
        axes.fill_between(
            [begin / 60.0, end / 60.0], 0.035 * number, 0.035 * (number + 1) - 0.008,
            transform=foot, color=colour, alpha=0.5, linewidth=0.0, zorder=1,
        )  # fmt: skip
    return bool(spans)


def _with_gaps(series: Series) -> tuple[FloatArray, FloatArray]:
    """Truth with gaps where it was not recorded."""
    if len(series.times) < 2:
        return series.times, series.values
    steps = np.diff(series.times)
    longest = max(LONGEST_PERIODS * float(np.median(steps)), LEAST_SILENCE_S)
    after = np.flatnonzero(steps > longest) + 1
    return (
        np.insert(series.times, after, series.times[after - 1]),
        np.insert(series.values, after, np.nan),
    )
