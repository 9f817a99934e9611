"""Verdicts by strength, and which effect was taken for which."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.trials.trial import Scored
from trawl_ros.lab.trials.verdicts import (
    Classes,
    chosen,
    hidden_names,
    names_of,
    reported,
    right,
    said_of,
    verdict_word,
    wrong_named,
)
from trawl_ros.report import style
from trawl_ros.report.pictures import Drawing

KINDS = {
    'right name': '#1b7f4b',
    'right name and another beside it': '#57a877',
    'several names, the right one among them': '#8fcfaa',
    'no discrepancy seen': '#dfe3e6',
    'UNKNOWN': '#8a9399',
    'NOT_TESTABLE': '#b9c2d0',
    'a part of what is hidden': '#c9e4a5',
    'several names, all wrong': '#f3b98b',
    'wrong name': '#c8412b',
}

BARS = (
    ('clean', 0.0, 'nothing hidden'),
    ('inside', 1.5, 'catalogue, 1.5 ×'),
    ('inside', 3.0, 'catalogue, 3 ×'),
    ('inside', 6.0, 'catalogue, 6 ×'),
    ('outside', 6.0, 'outside, 6 ×'),
    ('outside', 10.0, 'outside, 10 ×'),
    ('pair', 3.0, 'two at once, 3 ×'),
    ('triple', 3.0, 'three at once, 3 ×'),
    ('deck', 3.0, 'on deck, 3 ×'),
    ('deck', 6.0, 'on deck, 6 ×'),
    ('poor', 2.0, 'a poor trial, 2 ×'),
    ('followed', 2.0, 'and the proposed tow'),
)


def kind_of(trial: Scored, classes: Classes) -> str:
    """One of `KINDS`."""
    answer = verdict_word(trial)
    if answer in ('UNKNOWN', 'NOT_TESTABLE'):
        return answer
    if answer == 'NAMED':
        hidden, named = hidden_names(trial), said_of(trial)['effects']
        stray = wrong_named(trial, classes) or len(named) > len(hidden)
        if hidden and right(trial, names_of(trial), classes):
            return 'right name and another beside it' if stray else 'right name'
        if not stray:
            return 'a part of what is hidden'
        among = bool(hidden_names(trial)) and right(trial, reported(trial), classes)
        return 'several names, the right one among them' if among else 'wrong name'
    if answer == 'AMBIGUOUS':
        among = bool(hidden_names(trial)) and right(trial, reported(trial), classes)
        return 'several names, ' + ('the right one among them' if among else 'all wrong')
    return 'no discrepancy seen'


def verdicts_figure(trials: Sequence[Scored], classes: Classes) -> Drawing:
    """Draw all verdicts, and what was said of each effect of the catalogue and cause on deck."""
    effects, causes = _strong(trials), chosen(trials, 'deck')
    caption = ['What was said of trials, by what is hidden and its strength in smallest '
               'detectable sizes']  # fmt: skip
    heights = [1.0]
    if effects:
        caption.append('each hidden effect beside what it was named, in trials')
        heights.append(1.8)
    if causes:
        caption.append('each cause on deck beside how right the verdict was, in trials')
        heights.append(1.2)
    figure = Figure(figsize=(10.0, 2.0 + 3.8 * sum(heights)), layout='constrained')
    axes = figure.subplots(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    _draw_verdicts(axes[0], trials, classes)
    if effects:
        _draw_names(axes[1], effects, classes)
    if causes:
        _draw_causes(axes[-1], causes, classes)
    return Drawing('discrepancy', f'{"; below, ".join(caption)}.', figure)


def _strong(trials: Sequence[Scored]) -> list[Scored]:
    """Trials with an effect of the catalogue, at 3 times and more."""
    return [t for t in chosen(trials, 'inside') if t.key['spec']['strength'] >= 3.0]


def _draw_verdicts(axes: Axes, trials: Sequence[Scored], classes: Classes) -> None:
    there = [bar for bar in BARS if chosen(trials, *bar[:2])]
    left = np.zeros(len(there))
    at = np.arange(len(there))
    shares = {kind: np.zeros(len(there)) for kind in KINDS}
    for place, (series, strength, _) in enumerate(there):
        own = chosen(trials, series, strength)
        for trial in own:
            shares[kind_of(trial, classes)][place] += 100.0 / len(own)
    for kind, colour in KINDS.items():
        axes.barh(at, shares[kind], left=left, color=colour, label=kind, height=0.7)
        left += shares[kind]
    labels = [
        f'{words}: {len(chosen(trials, series, strength))} trials'
        for series, strength, words in there
    ]
    axes.set_yticks(at, labels)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel('trials, %')
    axes.legend(ncols=3, loc='lower center', bbox_to_anchor=(0.5, 1.0), frameon=False)
    style.quiet(axes)


def _draw_names(axes: Axes, own: Sequence[Scored], classes: Classes) -> None:
    """Hidden effect by what was said of it, in per cent of its trials at 3 and 6 times."""
    hidden = sorted({hidden_names(trial)[0] for trial in own})
    answers = [*hidden, 'several names', 'UNKNOWN', 'nothing seen']
    counts = np.zeros((len(hidden), len(answers)))
    for trial in own:
        row = hidden.index(hidden_names(trial)[0])
        found = verdict_word(trial)
        if found == 'NAMED':
            first = said_of(trial)['effects'][0]['name']
            name = hidden[row] if right(trial, names_of(trial), classes) else first
            column = answers.index(name) if name in answers else answers.index('several names')
        else:
            words = {'AMBIGUOUS': 'several names', 'UNKNOWN': 'UNKNOWN'}
            column = answers.index(words.get(found, 'nothing seen'))
        counts[row, column] += 1.0
    _draw_counts(axes, counts, hidden, answers)
    axes.set_xticks(range(len(answers)), [name.replace('_', ' ') for name in answers], rotation=60,
                    ha='right')  # fmt: skip
    axes.set_xlabel('what was said (trials at 3 and 6 times)')


def _draw_causes(axes: Axes, own: Sequence[Scored], classes: Classes) -> None:
    """Cause on deck by how right the verdict was."""
    hidden = sorted({hidden_names(trial)[0] for trial in own})
    kinds = [kind_of(trial, classes) for trial in own]
    answers = [kind for kind in KINDS if kind in kinds]
    counts = np.zeros((len(hidden), len(answers)))
    for trial, kind in zip(own, kinds, strict=True):
        counts[hidden.index(hidden_names(trial)[0]), answers.index(kind)] += 1.0
    _draw_counts(axes, counts, hidden, answers)
    axes.set_xticks(range(len(answers)), [textwrap.fill(kind, 20) for kind in answers])
    axes.set_xlabel('the verdict (trials)')


def _draw_counts(
    axes: Axes, counts: FloatArray, hidden: Sequence[str], answers: Sequence[str]
) -> None:
    """Table of what is hidden by what was said, shaded by the part of a row's trials."""
    totals = np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    axes.imshow(100.0 * counts / totals, cmap='Greens', vmin=0.0, vmax=100.0, aspect='auto')
    for (row, column), count in np.ndenumerate(counts):
        if count:
            dark = count > 0.6 * totals[row, 0]
            axes.text(column, row, f'{count:.0f}', ha='center', va='center',
                      color='white' if dark else 'black', fontsize=9)  # fmt: skip
    axes.set_yticks(range(len(hidden)), [name.replace('_', ' ') for name in hidden])
    axes.set_ylabel('what is hidden')
