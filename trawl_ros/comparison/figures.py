# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of a comparison: one over the other, differences over operation, and the course."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from trawl_ros.comparison.comparison import ComparedCourse, Comparison
from trawl_ros.comparison.summary import ComparedSensor
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.display_units import DisplayUnits, quantity_of
from trawl_ros.estimation.fit.error_terms import group_of
from trawl_ros.records.channels import CHANNELS
from trawl_ros.report.pictures import Drawing
from trawl_ros.report.style import FAINT, MEASURED, PORT, STARBOARD, quiet

STYLES = {
    'port': {'color': PORT, 'marker': 'o', 'mfc': PORT, 'ls': '-'},
    'starboard': {'color': STARBOARD, 'marker': 's', 'mfc': 'none', 'ls': '--'},
    'middle': {'color': MEASURED, 'marker': 'D', 'mfc': MEASURED, 'ls': '-'},
}
"""Sides by colour, and by marker and line: filled circles and lines, open squares and dashes."""

REFERENCE = '#222222'

SHIFT = {'port': -0.01, 'starboard': 0.01, 'middle': 0.0}
"""Shift of a side's points along an axis, a part of its range, so that none hides another."""

WORDS = {
    'length': 'warp length', 'tension': 'warp tension', 'pitch': 'door pitch', 'roll': 'door roll',
    'divergence': 'warp divergence', 'declination': 'warp declination',
}  # fmt: skip
"""Names of quantities whose channels say only the side."""

MINUTES = {'port': (0, 2), 'starboard': (1, 2), 'middle': (0, 1)}
"""First minute of a course that is drawn, and every how many: one side lies between the other."""


def drawings(comparison: Comparison, units: DisplayUnits) -> list[Drawing]:
    """Draw all figures.

    Parameters
    ----------
    comparison
        What is drawn.
    units
        Units of the axes.
    """
    one, other = comparison.names
    bars = 'Bars: one std of the error. Port: red filled circles; starboard: green open squares.'
    course = (
        'equilibria, where warp and speed are those of a steady state'
        if comparison.kind == 'gear'
        else 'medians of minutes'
    )
    found = [
        Drawing(
            'over',
            f'{one} over {other}, all states. On the line both are equal. {bars}',
            _over_figure(comparison, units),
        ),
        Drawing(
            'differences',
            f'{one} minus {other} over warp, speed and time. Shaded: two std of the error. {bars}',
            _difference_figure(comparison, units),
        ),
    ]
    for number in range(len(comparison.courses)):
        name = '' if len(comparison.courses) == 1 else f' of {comparison.logs[number]}'
        found.append(
            Drawing(
                f'course{number + 1}' if name else 'course',
                f'Course{name}: {one} as dots, {other} as lines ({course}).',
                _course_figure(comparison, number, units),
            )
        )
    return found


def side_of(channel: str) -> str:
    """Return the side of a channel, ``middle`` for one without."""
    return channel.split('_')[0] if channel.startswith(('port_', 'starboard_')) else 'middle'


def _groups(comparison: Comparison) -> dict[str, list[ComparedSensor]]:
    groups: dict[str, list[ComparedSensor]] = {}
    for sensor in comparison.sensors:
        groups.setdefault(group_of(sensor.channel), []).append(sensor)
    return groups


def _over_figure(comparison: Comparison, units: DisplayUnits) -> Figure:
    groups = _groups(comparison)
    across = min(3, len(groups))
    down = math.ceil(len(groups) / across)
    figure = Figure(figsize=(11.0, 3.4 * down + 0.5), layout='constrained')
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for axes, (group, sensors) in zip(panels, groups.items(), strict=False):
        quantity = quantity_of(group, sensors[0].unit)
        size, symbol = units.size(quantity), units.symbol(quantity)
        for sensor in sensors:
            name = sensor.channel
            own = [state.sensors[name] for state in comparison.states if name in state.sensors]
            at, values, std = np.array([(c.reference, c.measured, c.std) for c in own]).T / size
            _points(axes, name, at, values, std)
        low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
        ends = [min(low), max(high)]
        axes.plot(ends, ends, color=FAINT, lw=1.0, zorder=0)
        axes.set_xlim(*ends)
        axes.set_ylim(*ends)
        axes.set_title(_words(group), fontsize='medium')
        axes.set_xlabel(f'{comparison.names[1]} / {symbol}')
        axes.set_ylabel(f'{comparison.names[0]} / {symbol}')
        quiet(axes)
    for axes in panels[len(groups) :]:
        axes.set_axis_off()
    _legend(figure)
    return figure


def _difference_figure(comparison: Comparison, units: DisplayUnits) -> Figure:
    groups = _groups(comparison)
    figure = Figure(figsize=(11.0, 1.9 * len(groups) + 0.8), layout='constrained')
    panels = figure.subplots(len(groups), 3, sharex='col', sharey='row', squeeze=False)
    of_axes = ('warp', units.size('warp')), ('speed', units.size('speed')), ('time', 1.0)
    for (group, sensors), row in zip(groups.items(), panels, strict=True):
        angle = sensors[0].is_angle
        for (axis, size), axes in zip(of_axes, row, strict=True):
            for sensor in sensors:
                states = [s for s in comparison.states if sensor.channel in s.sensors]
                at = np.array([state.axes[axis] for state in states])
                own = [state.sensors[sensor.channel] for state in states]
                off, std, per = np.array(
                    [(c.difference, c.std, max(abs(c.reference), 1e-9) / 100.0) for c in own]
                ).T
                per = math.radians(1.0) if angle else per
                _points(axes, sensor.channel, at / size, off / per, std / per)
            two = 2.0 * float(np.median(std / per))
            axes.axhspan(-two, two, color='#eef1f3', zorder=0)
            axes.axhline(0.0, color=FAINT, lw=0.9, zorder=1)
            quiet(axes)
        row[0].set_ylabel(f'{_words(group)}\n{"°" if angle else "%"}')
    for axes, (axis, _) in zip(panels[-1], of_axes, strict=True):
        unit = 'h' if axis == 'time' else units.symbol(axis)
        axes.set_xlabel(f'{axis} / {unit}')
    _legend(figure)
    return figure


def _course_figure(comparison: Comparison, number: int, units: DisplayUnits) -> Figure:
    course = comparison.courses[number]
    groups: dict[str, list[str]] = {}
    for name in course.reference:
        if name in course.measured and np.isfinite(course.reference[name]).any():
            groups.setdefault(group_of(name), []).append(name)
    figure = Figure(figsize=(11.0, 1.9 * len(groups) + 0.8), layout='constrained')
    panels = figure.subplots(max(1, len(groups)), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (group, names) in zip(panels, groups.items(), strict=False):
        quantity = quantity_of(group, CHANNELS[names[0]].unit)
        size, symbol = units.size(quantity), units.symbol(quantity)
        for name in names:
            style = STYLES[side_of(name)]
            axes.plot(
                course.hours, course.measured[name] / size, ls='', ms=3.0, mew=0.8,
                marker=style['marker'], mfc=style['mfc'], color=style['color'],
                markevery=MINUTES[side_of(name)],
            )  # fmt: skip
            reference = course.reference[name] / size
            axes.plot(course.hours, reference, ls=style['ls'], lw=1.6, color=REFERENCE)
        axes.set_ylim(*_limits(course, names) / size)
        axes.set_ylabel(f'{_words(group)}\n{symbol}')
        if 'depth' in group:
            axes.invert_yaxis()
        quiet(axes)
    panels[-1].set_xlabel('time from the start / h')
    _legend(figure, Line2D([], [], color=REFERENCE, label=comparison.names[1]))
    return figure


def _limits(course: ComparedCourse, names: Sequence[str]) -> FloatArray:
    """Return limits of an axis that show what is compared, without false echoes."""
    pairs = [np.array([course.measured[name], course.reference[name]]) for name in names]
    shown = np.concatenate([pair[:, np.isfinite(pair).all(axis=0)] for pair in pairs], axis=1)
    low, high = np.percentile(shown, [1.0, 99.0]) if shown.size else (0.0, 1.0)
    reach = 0.25 * ((high - low) or abs(low) or 1.0)
    return np.array([low - reach, high + reach])


def _words(group: str) -> str:
    return WORDS.get(group, group.replace('_', ' '))


def _points(axes: Axes, channel: str, at: FloatArray, values: FloatArray, std: FloatArray) -> None:
    style = STYLES[side_of(channel)]
    shift = SHIFT[side_of(channel)] * float(np.ptp(at))
    axes.errorbar(
        at + shift, values, std, fmt=style['marker'], color=style['color'], mfc=style['mfc'],
        ms=5.0, mew=1.1, elinewidth=0.8, zorder=3,
    )  # fmt: skip


def _legend(figure: Figure, *more: Line2D) -> None:
    labels = {'port': 'port', 'starboard': 'starboard', 'middle': 'one for both sides'}
    handles: Sequence[Line2D] = [
        Line2D(
            [], [], ls='', marker=STYLES[side]['marker'], mfc=STYLES[side]['mfc'],
            color=STYLES[side]['color'], label=label,
        )
        for side, label in labels.items()
    ]  # fmt: skip
    figure.legend(
        handles=[*handles, *more], loc='outside lower center', ncols=len(handles) + len(more),
        frameon=False,
    )  # fmt: skip
