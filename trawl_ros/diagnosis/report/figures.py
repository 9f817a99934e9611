# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of a diagnosis."""

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.holdout import HoldoutComparison
from trawl_ros.diagnosis.inference.posterior import Posterior
from trawl_ros.diagnosis.inference.screen import Screen
from trawl_ros.diagnosis.locating import map_of
from trawl_ros.report.pictures import Drawing
from trawl_ros.report.style import FAINT, MEASURED, SECOND, quiet

LEAD = 'Which cause it is'
WHERE, GAP = 'Where they disagree', 'The gap before and after'
BEGAN = 'What began during the tow'

MOST_Z = 8.0
"""Colours end here."""

MAX_BARS, MIN_SHOWN_PROBABILITY = 10, 0.005
"""Largest number of causes that are drawn, and their least probability."""


def drawings(diagnosis: Diagnosis) -> list[Drawing]:
    """Return all figures for which there are numbers."""
    holdout, made = diagnosis.holdout, []
    if diagnosis.posterior is not None:
        made.append(
            Drawing(
                'probabilities',
                'Probability of each cause (dark), and of any cause of its group, which one check '
                'on deck finds (light).',
                probability_figure(diagnosis.posterior), LEAD,
            )
        )  # fmt: skip
    if diagnosis.screen is not None:
        made.append(
            Drawing(
                'where',
                'Residuals of each sensor with each variable, in standard deviations of what '
                'errors would make, boards and calibration taken out. Red: grows with it.',
                where_figure(diagnosis.screen), WHERE,
            )
        )  # fmt: skip
    if holdout is not None and holdout.after is not None:
        made.append(
            Drawing(
                'gap',
                'Errors of each sensor on held-out tows, over what errors of instruments '
                'alone would make (1): boards refitted alone, with '
                'the likeliest cause, and with the best other one.',
                gap_figure(holdout, 'the likeliest cause'), GAP,
            )
        )  # fmt: skip
    if diagnosis.base is not None and diagnosis.best is not None:
        made.append(
            Drawing(
                'coefficients',
                'The coefficients of the boards with and without '
                'the likeliest cause, in standard deviations of the prior: those that move had '
                'hidden it.',
                coefficient_shifts_figure(diagnosis), GAP,
            )
        )  # fmt: skip
    return [*made, *_began(diagnosis)]


def _began(diagnosis: Diagnosis) -> list[Drawing]:
    watched = [tow for tow in diagnosis.onsets if tow.watched]
    if not watched:
        return []
    from trawl_ros.diagnosis.onset.monitor import OnsetOptions
    from trawl_ros.diagnosis.report.onset_figure import onset_figure

    return [
        Drawing(
            f'onset_{number}',
            f'{tow.tow} as it was watched. Above: what each channel shows more than the '
            'model predicted, in standard deviations. Below: the evidence for the rarest '
            'candidate; beyond the dashed limit a finding is raised.',
            onset_figure(tow.course, tow.findings, OnsetOptions().limit, tow.start_ns), BEGAN,
        )
        for number, tow in enumerate(watched, start=1)
    ]  # fmt: skip


def where_figure(test: Screen) -> Figure:
    """Map of residual patterns: channels by variables."""
    channels, variables, z = map_of(test)
    figure = Figure(figsize=(8.0, 0.35 * len(channels) + 1.8), layout='constrained')
    axes = figure.subplots()
    picture = axes.imshow(z, cmap='RdBu_r', vmin=-MOST_Z, vmax=MOST_Z, aspect='auto')
    axes.set_xticks(range(len(variables)), variables, rotation=25, ha='right')
    axes.set_yticks(range(len(channels)), [_words(name) for name in channels])
    for row, column in np.argwhere(np.abs(z) >= 3.0):
        colour = 'white' if abs(z[row, column]) > 0.6 * MOST_Z else 'black'
        axes.text(column, row, f'{z[row, column]:+.1f}', ha='center', va='center', color=colour)
    figure.colorbar(picture, ax=axes, label='standard deviations')
    return figure


def probability_figure(posterior: Posterior) -> Figure:
    """Draw bars of the probabilities of causes and of their nodes."""
    leaves, nodes = posterior.leaves, posterior.nodes
    rows = [
        (_words(name), probability, nodes[posterior.entry(name).entry.node.path])
        for name, probability in list(leaves.items())[:MAX_BARS]
        if nodes[posterior.entry(name).entry.node.path] > MIN_SHOWN_PROBABILITY
    ]
    rows += [
        ('something else', posterior.unknown, 0.0), ('boards alone', posterior.nothing, 0.0)
    ]  # fmt: skip
    rows.sort(key=lambda row: row[1])
    figure = Figure(figsize=(8.0, 0.35 * len(rows) + 1.2), layout='constrained')
    axes = figure.subplots()
    places = np.arange(len(rows))
    axes.barh(places, [node for _, _, node in rows], 0.7, color=FAINT)
    axes.barh(places, [leaf for _, leaf, _ in rows], 0.4, color=MEASURED)
    axes.set_yticks(places, [name for name, _, _ in rows])
    axes.set_xlim(0.0, 1.0)
    axes.set_xlabel('probability')
    quiet(axes)
    return figure


def gap_figure(holdout: HoldoutComparison, added: str) -> Figure:
    """Errors before and after the repair, and with the placebo."""
    channels = list(holdout.before.rms)
    figure = Figure(figsize=(9.0, 4.5), layout='constrained')
    axes = figure.subplots()
    places = np.arange(len(channels))
    bars = [('boards alone', holdout.before, SECOND), (f'with {added}', holdout.after, MEASURED)]
    if holdout.placebo is not None:
        bars.append((f'with {_words(holdout.instead or "")} instead', holdout.placebo, FAINT))
    width = 0.8 / len(bars)
    for number, (label, errors, colour) in enumerate(bars):
        assert errors is not None
        heights = [errors.rms.get(name, np.nan) / holdout.before.expected[name]
                   for name in channels]  # fmt: skip
        shift = (number - 0.5 * (len(bars) - 1)) * width
        axes.bar(places + shift, heights, width, color=colour, label=label)
    axes.axhline(1.0, color='black', lw=0.8, ls='--')
    axes.set_xticks(places, [_words(name) for name in channels], rotation=30, ha='right')
    axes.set_ylabel('error / error of instruments')
    quiet(axes)
    figure.legend(loc='outside upper center', ncols=3, frameon=False)
    return figure


def coefficient_shifts_figure(diagnosis: Diagnosis) -> Figure:
    """Coefficients of the boards with and without the effect."""
    base, added = diagnosis.base, diagnosis.best
    assert base is not None
    assert added is not None
    assert added.refit is not None
    board = base.fit.prior.only('coefficients')
    figure = Figure(figsize=(9.0, 4.0), layout='constrained')
    axes = figure.subplots()
    for shift, (label, refit, colour) in zip(
        (-0.12, 0.12),
        (('boards alone', base, SECOND), ('with the likeliest cause', added.refit, MEASURED)),
        strict=True,
    ):
        own = refit.fit.prior.slice_of('coefficients')
        values = board.departure(refit.estimate.values[own])
        std = refit.estimate.std[own] / board.std
        axes.errorbar(
            np.arange(len(board)) + shift, values, 1.96 * std, fmt='o', color=colour, label=label
        )
    axes.axhline(0.0, color='black', lw=0.8)
    axes.set_xticks(range(len(board)), board.names)
    axes.set_ylabel('from the start / std of the prior')
    quiet(axes)
    figure.legend(loc='outside upper center', ncols=2, frameon=False)
    return figure


def _words(name: str) -> str:
    return name.replace('_', ' ')
