# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of the fit and its data."""

from collections.abc import Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.report.report import Report
from trawl_ros.estimation.report.residuals import ChannelResiduals
from trawl_ros.report.style import FAINT, MEASURED, PORT, STARBOARD, quiet

ALIKE_M_S = 0.1
"""Speeds (m/s) this near are drawn as one."""

ALIKE_M = 20.0
"""Warp lengths (m) this near are one point of a line."""

GROUPS = (
    ('door spread', ('door_spread',)),
    ('door depth', ('port_door_depth', 'starboard_door_depth')),
    ('warp tension', ('port_tension', 'starboard_tension')),
    ('net depth', ('net_depth',)),
    ('door pitch', ('port_pitch', 'starboard_pitch')),
    ('door roll', ('port_roll', 'starboard_roll')),
    ('vertical opening', ('vertical_opening',)),
)
"""Channels that share a panel."""


def channels_figure(report: Report) -> Figure:
    """Measured and modelled over warp length, before and after, one panel per channel."""
    figure = Figure(figsize=(11.0, 8.0), layout='constrained')
    length = report.inputs[:, :2].mean(axis=1)
    speeds = np.round(report.inputs[:, 2] / ALIKE_M_S) * ALIKE_M_S
    colours = _colours(np.unique(speeds))
    errors = report.errors
    panels = figure.subplots(2, 2)
    for i, (axes, channel) in enumerate(zip(panels.flat, PAPER_CHANNELS, strict=True)):
        scale, unit = (1e-3, 'kN') if channel.unit == 'N' else (1.0, channel.unit)
        for speed, colour in colours.items():
            rows = np.flatnonzero(speeds == speed)
            # A speed towed at one length has no line, but its marker: hollow before, filled after.
            for values, line, face in (
                (report.at_start, '--', 'white'),
                (report.at_end, '-', colour),
            ):
                at, middle = _by_length(length[rows], values[rows, i])
                axes.plot(
                    at, scale * middle, line, marker='s', ms=6, mfc=face, color=colour, lw=1.2
                )
            axes.plot(
                length[rows], scale * report.measured[rows, i], 'x', ms=7, mew=1.6, color=colour
            )
        axes.set_title(
            f'{channel.words}: error {100.0 * errors["start"][i]:.1f} % before, '
            f'{100.0 * errors["end"][i]:.1f} % after',
            fontsize='medium',
        )
        axes.set_xlabel('warp length / m')
        axes.set_ylabel(f'{channel.words} / {unit}')
        if channel.name.endswith('depth'):
            axes.invert_yaxis()
        quiet(axes)
    handles = [
        *(
            Line2D([], [], color=colour, label=f'{speed:.1f} m/s')
            for speed, colour in colours.items()
        ),
        Line2D([], [], color=FAINT, marker='x', mew=1.6, ls='', label='measured'),
        Line2D([], [], color=FAINT, marker='s', mfc='white', ls='--', label='before'),
        Line2D([], [], color=FAINT, marker='s', ls='-', label='after'),
    ]
    figure.legend(handles=handles, loc='outside lower center', ncols=len(handles), frameon=False)
    return figure


def _by_length(length: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Means of values of similar warp length, in rising order, so that a line can join them."""
    like = np.round(length / ALIKE_M) * ALIKE_M
    groups = [like == at for at in np.unique(like)]
    return (
        np.array([length[group].mean() for group in groups]),
        np.array([values[group].mean() for group in groups]),
    )


def residuals_figure(report: Report) -> Figure:
    """Residuals in stated std over warp length and speed, sides of the ship in one panel."""
    by_name = {row.channel: row for row in report.residuals}
    groups = [
        (words, [by_name[name] for name in names if name in by_name])
        for words, names in GROUPS
        if any(name in by_name for name in names)
    ]
    figure = Figure(figsize=(11.0, 1.7 * len(groups) + 0.8), layout='constrained')
    panels = figure.subplots(len(groups), 2, sharex='col', squeeze=False)
    inputs = report.inputs
    for (words, rows), (by_length, by_speed) in zip(groups, panels, strict=True):
        for axes, at in ((by_length, inputs[:, :2].mean(axis=1)), (by_speed, inputs[:, 2])):
            _draw_residuals(axes, rows, at)
        by_length.set_ylabel(words)
        by_speed.sharey(by_length)
    panels[-1, 0].set_xlabel('warp length / m')
    panels[-1, 1].set_xlabel('speed / m/s')
    handles = [
        Line2D([], [], color=PORT, marker='.', ls='', label='port'),
        Line2D([], [], color=STARBOARD, marker='.', ls='', label='starboard'),
    ]
    figure.legend(handles=handles, loc='outside lower center', ncols=2, frameon=False)
    return figure


def _draw_residuals(axes: Axes, rows: Sequence[ChannelResiduals], at: FloatArray) -> None:
    axes.axhspan(-2.0, 2.0, color=FAINT, alpha=0.15, lw=0)
    axes.axhline(0.0, color=FAINT, lw=0.8)
    for row in rows:
        side = row.channel.split('_')[0]
        colour = {'port': PORT, 'starboard': STARBOARD}.get(side, MEASURED)
        axes.plot(at[row.windows], row.scaled, '.', ms=7, color=colour, alpha=0.8)
    reach = max(3.0, *(1.1 * float(np.max(np.abs(row.scaled))) for row in rows))
    axes.set_ylim(-reach, reach)
    quiet(axes)


def _colours(speeds: FloatArray) -> dict[float, tuple[float, float, float, float]]:
    """A colour per speed, from dark to light."""
    chosen = matplotlib.colormaps['viridis'](np.linspace(0.0, 0.85, len(speeds)))
    return {float(speed): tuple(colour) for speed, colour in zip(speeds, chosen, strict=True)}
