"""Figures of a diagnosis."""

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.diagnosis.candidates import Candidate
from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.holdout import HoldoutComparison
from trawl_ros.diagnosis.locating import map_of
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.report.pictures import Drawing
from trawl_ros.report.style import FAINT, MEASURED, SECOND, quiet

WHERE, WHICH, GAP = 'Where they disagree', 'Which effect it is', 'The gap before and after'
BEGAN = 'What began on the way'

MOST_Z = 8.0
"""Colours end here."""

BARS = 10
"""So many effects are drawn."""


def drawings(diagnosis: Diagnosis) -> list[Drawing]:
    """Return all figures for which there are numbers."""
    test, holdout, made = diagnosis.score_test, diagnosis.holdout, []
    if test is not None:
        made.append(
            Drawing(
                'where',
                'Residuals of each channel with each variable, in standard deviations of what '
                'errors would make, boards and calibration taken out. Red: grows with it.',
                where_figure(test), WHERE,
            )
        )  # fmt: skip
        made.append(
            Drawing(
                'evidence',
                'By how much each effect alone lowers χ² of all readings, boards refitted (dark: '
                'solved anew, light: to first order).',
                evidence_figure(diagnosis, test), WHICH,
            )
        )  # fmt: skip
        made.append(
            Drawing(
                'confusable',
                'How alike effects look in these tows: the cosine of what the one changes with '
                'the nearest that the other could do. 1 cannot be told apart.',
                confusable_figure(test), WHICH,
            )
        )  # fmt: skip
    if holdout is not None and holdout.after is not None:
        made.append(
            Drawing(
                'gap',
                'Errors of each channel on what was kept back, over what errors of instruments '
                'alone would make (1): boards refitted alone, with '
                f'{diagnosis.added_as}, and with the best other effect.',
                gap_figure(holdout, diagnosis.added_as), GAP,
            )
        )  # fmt: skip
    if diagnosis.base is not None and diagnosis.added is not None:
        made.append(
            Drawing(
                'coefficients',
                'The coefficients of the boards with and without '
                f'{diagnosis.added_as}, in standard deviations of the prior: what moves had been '
                'bent to hide it.',
                coefficient_shifts_figure(diagnosis), GAP,
            )
        )  # fmt: skip
    return [*made, *_began(diagnosis)]


def _began(diagnosis: Diagnosis) -> list[Drawing]:
    watched = [tow for tow in diagnosis.onsets if tow.watched]
    if not watched:
        return []
    from trawl_ros.diagnosis.report.onset_figure import onset_figure

    return [
        Drawing(
            f'onset_{number}',
            f'{tow.tow} as it was watched. Above: what each channel shows more than the '
            'model foretold, in standard deviations. Below: the evidence for the rarest '
            'candidate; beyond the dashed limit a finding is raised.',
            onset_figure(tow.course, tow.findings, tow.limit, tow.start_ns), BEGAN,
        )
        for number, tow in enumerate(watched, start=1)
    ]  # fmt: skip


def where_figure(test: ScoreTest) -> Figure:
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


def evidence_figure(diagnosis: Diagnosis, test: ScoreTest) -> Figure:
    """Bars of the effects in order of the χ² they explain."""
    first: dict[str, float] = {}
    for candidate in test.wanted:
        chi2 = test.evidence.chi2(test.block(candidate))
        first[candidate.name] = max(chi2, first.get(candidate.name, 0.0))
    weighed = diagnosis.named.weighed if diagnosis.named else ()
    anew = {' and '.join(entry.refit.names): entry.delta_chi2 for entry in weighed}
    ranked = sorted({*first, *anew}, key=lambda name: anew.get(name, first.get(name, 0.0)))
    ranked = ranked[-BARS:]
    figure = Figure(figsize=(8.0, 0.35 * len(ranked) + 1.2), layout='constrained')
    axes = figure.subplots()
    places = np.arange(len(ranked))
    axes.barh(places, [first.get(name, 0.0) for name in ranked], 0.7, color=FAINT)
    axes.barh(places, [max(anew.get(name, 0.0), 0.0) for name in ranked], 0.4, color=MEASURED)
    axes.set_yticks(places, [_words(name) for name in ranked])
    axes.set_xlabel('χ² explained')
    quiet(axes)
    return figure


def confusable_figure(test: ScoreTest) -> Figure:
    """Matrix of the cosines of all effects' signatures."""
    wanted = [candidate for candidate in test.wanted if not candidate.place]
    size = len(wanted)
    cosines = np.array([[largest_cosine(test, a, b) for b in wanted] for a in wanted])
    figure = Figure(figsize=(0.42 * size + 2.5, 0.42 * size + 1.8), layout='constrained')
    axes = figure.subplots()
    picture = axes.imshow(cosines, cmap='Greys', vmin=0.0, vmax=1.0)
    names = [_words(candidate.name) for candidate in wanted]
    axes.set_xticks(range(size), names, rotation=60, ha='right')
    axes.set_yticks(range(size), names)
    for row, column in np.argwhere(cosines > 0.8):
        if row != column:
            axes.text(
                column, row, f'{cosines[row, column]:.2f}', ha='center', va='center',
                color='white', fontsize=7,
            )  # fmt: skip
    figure.colorbar(picture, ax=axes, label='cosine')
    return figure


def largest_cosine(test: ScoreTest, first: Candidate, second: Candidate) -> float:
    """Largest cosine of the signatures of two effects."""
    a, b = (list(test.block(which)) for which in (first, second))
    information = test.evidence.information
    roots = []
    for block in (a, b):
        values, vectors = np.linalg.eigh(information[np.ix_(block, block)])
        present = values > 1e-9 * max(values.max(), 1e-30)
        roots.append(vectors[:, present] / np.sqrt(values[present]))
    if not (roots[0].size and roots[1].size):
        return 0.0
    between = roots[0].T @ information[np.ix_(a, b)] @ roots[1]
    return float(min(1.0, np.linalg.svd(between, compute_uv=False)[0]))


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
    base, added = diagnosis.base, diagnosis.added
    assert base is not None
    assert added is not None
    board = base.fit.prior.only('coefficients')
    figure = Figure(figsize=(9.0, 4.0), layout='constrained')
    axes = figure.subplots()
    for shift, (label, refit, colour) in zip(
        (-0.12, 0.12),
        (('boards alone', base, SECOND), (f'with {diagnosis.added_as}', added.refit, MEASURED)),
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
