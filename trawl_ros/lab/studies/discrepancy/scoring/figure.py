"""Verdicts by strength, and which effect was taken for which."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.lab.studies.discrepancy.scoring.verdicts import (
    Classes,
    both_named,
    chosen,
    hidden_names,
    named_right,
    names_of,
    one_named,
    reported,
    right,
    said_of,
    verdict_word,
)
from trawl_ros.lab.studies.discrepancy.trials.trial import Scored
from trawl_ros.report import style

KINDS = {
    'right name': '#1b7f4b',
    'right name and another beside it': '#57a877',
    'several names, the right one among them': '#8fcfaa',
    'no discrepancy seen': '#dfe3e6',
    'UNKNOWN': '#8a9399',
    'NOT_TESTABLE': '#b9c2d0',
    'one of two': '#c9e4a5',
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
    ('poor', 2.0, 'a poor trial, 2 ×'),
    ('followed', 2.0, 'and the proposed tow'),
)


def kind_of(trial: Scored, classes: Classes) -> str:
    """One of `KINDS`."""
    answer = verdict_word(trial)
    if answer in ('UNKNOWN', 'NOT_TESTABLE'):
        return answer
    if answer == 'NAMED':
        if both_named(trial, classes) or (hidden_names(trial) and named_right(trial, classes)):
            return 'right name'
        if one_named(trial, classes):
            return 'one of two'
        if hidden_names(trial) and right(trial, names_of(trial), classes):
            return 'right name and another beside it'
        among = bool(hidden_names(trial)) and right(trial, reported(trial), classes)
        return 'several names, the right one among them' if among else 'wrong name'
    if answer == 'AMBIGUOUS':
        among = bool(hidden_names(trial)) and right(trial, reported(trial), classes)
        return 'several names, ' + ('the right one among them' if among else 'all wrong')
    return 'no discrepancy seen'


def verdicts_figure(trials: Sequence[Scored], classes: Classes) -> Figure:
    """Draw all verdicts, and the effects of the catalogue beside what they were named."""
    figure = Figure(figsize=(10.0, 12.0), layout='constrained')
    above, below = figure.subplots(2, 1, height_ratios=(1.0, 1.8))
    _draw_verdicts(above, trials, classes)
    _draw_names(below, trials, classes)
    return figure


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
        f'{words}\n{len(chosen(trials, series, strength))} trials'
        for series, strength, words in there
    ]
    axes.set_yticks(at, labels)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel('trials, %')
    axes.legend(ncols=3, loc='lower center', bbox_to_anchor=(0.5, 1.0), frameon=False)
    style.quiet(axes)


def _draw_names(axes: Axes, trials: Sequence[Scored], classes: Classes) -> None:
    """Hidden effect by what was said of it, in per cent of its trials at 3 and 6 times."""
    own = [trial for trial in chosen(trials, 'inside') if trial.key['spec']['strength'] >= 3.0]
    hidden = sorted({hidden_names(trial)[0] for trial in own})
    if not hidden:
        axes.set_axis_off()
        return
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
    totals = np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    axes.imshow(100.0 * counts / totals, cmap='Greens', vmin=0.0, vmax=100.0, aspect='auto')
    for (row, column), count in np.ndenumerate(counts):
        if count:
            dark = count > 0.6 * totals[row, 0]
            axes.text(column, row, f'{count:.0f}', ha='center', va='center',
                      color='white' if dark else 'black', fontsize=9)  # fmt: skip
    axes.set_xticks(range(len(answers)), [name.replace('_', ' ') for name in answers], rotation=60,
                    ha='right')  # fmt: skip
    axes.set_yticks(range(len(hidden)), [name.replace('_', ' ') for name in hidden])
    axes.set_xlabel('what was said (trials at 3 and 6 times)')
    axes.set_ylabel('what is hidden')
