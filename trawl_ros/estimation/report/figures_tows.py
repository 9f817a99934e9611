# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures that compare tows."""

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.report.report import Report
from trawl_ros.report.style import FAINT, MEASURED, MEASURED_TRUTH, SECOND, quiet

NAMED = 8
"""With more tows than this the legend would hide the figure."""


def held_out_figure(report: Report) -> Figure:
    """Hold-out errors per channel: fitted, left out, tow by tow, and those of the paper."""
    figure = Figure(figsize=(9.0, 4.5), layout='constrained')
    axes = figure.subplots()
    place = np.arange(len(PAPER_CHANNELS))
    out = report.held_out
    left = 'tow by tow' if out.by == 'tow' else 'state by state'
    errors = report.errors
    axes.bar(place - 0.2, 100.0 * errors['end'], 0.38, color=FAINT, label='fitted')
    axes.bar(
        place + 0.2, 100.0 * errors['held_out'], 0.38, color=MEASURED, label=f'left out, {left}'
    )
    by_tow = report.by_tow
    if len(by_tow) > 1:
        spread = np.linspace(-0.12, 0.12, len(by_tow))
        for tow, beside in zip(by_tow, spread, strict=True):
            axes.plot(
                place + 0.2 + beside, 100.0 * tow.held_out, 'o', ms=5, color=SECOND, mec='white',
                label='single tows' if beside == spread[0] else None,
            )  # fmt: skip
    axes.hlines(
        [100.0 * channel.paper for channel in PAPER_CHANNELS], place - 0.42, place + 0.42,
        color=MEASURED_TRUTH, ls='--', lw=1.2, label='the paper, fitted',
    )  # fmt: skip
    axes.set_xticks(place, [channel.words for channel in PAPER_CHANNELS])
    axes.set_ylabel('mean error / mean measured value / %')
    quiet(axes)
    figure.legend(loc='outside upper center', ncols=4, fontsize='small', frameon=False)
    return figure


def tow_biases_figure(report: Report) -> Figure:
    """Calibration errors of each tow's instruments, in units of their prior std."""
    figure = Figure(figsize=(11.0, 4.5), layout='constrained')
    axes = figure.subplots()
    biases = report.estimate.tow_biases
    channels = list(dict.fromkeys(bias.channel for bias in biases))
    tows = sorted({bias.tow for bias in biases})
    colours = matplotlib.colormaps['viridis'](np.linspace(0.0, 0.85, len(tows)))
    axes.axhspan(-1.0, 1.0, color=FAINT, alpha=0.2, lw=0)
    axes.axhline(0.0, color=FAINT, lw=0.8)
    beside = (np.arange(len(tows)) - 0.5 * (len(tows) - 1)) * 0.6 / len(tows)
    for tow, colour, shift in zip(tows, colours, beside, strict=True):
        own = {bias.channel: bias for bias in biases if bias.tow == tow}
        axes.errorbar(
            [channels.index(name) + shift for name in own],
            [bias.value / bias.known for bias in own.values()],
            [bias.std / bias.known for bias in own.values()],
            fmt='o', ms=4, capsize=2, color=colour, label=report.tows[tow],
        )  # fmt: skip
    labels = [name.replace('_', ' ').replace(' ', '\n', 1) for name in channels]
    axes.set_xticks(np.arange(len(channels)), labels, fontsize='small')
    axes.set_ylabel('bias / std known before')
    quiet(axes)
    if 1 < len(tows) <= NAMED:
        figure.legend(loc='outside upper center', ncols=4, fontsize='small', frameon=False)
    return figure
