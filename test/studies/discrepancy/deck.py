"""Figures of trials with causes on deck: how often the verdict is right, and what each came to."""

from collections.abc import Sequence

import numpy as np

from studies.rates import rate
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.trials.hidden_effects.other_keys import RIGHT_NAMES
from trawl_ros.lab.trials.trial import Scored
from trawl_ros.lab.trials.verdicts import (
    Classes,
    chosen,
    hidden_names,
    named_right,
    names_of,
    reported,
    right,
    set_size,
    verdict_word,
)

FEW = 3
"""So many effects may be left for a cause on deck."""


def deck_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Verdicts on causes on deck, by the names that were to count as right."""
    rows = []
    for strength, least in ((3.0, 85.0), (6.0, 95.0)):
        own = chosen(trials, 'deck', strength)
        known = [trial for trial in own if RIGHT_NAMES.get(hidden_names(trial)[0])]
        rows += [
            rate(
                f'causes detected at {strength:g} times',
                [verdict_word(trial) != 'NO_DISCREPANCY' for trial in own],
            ),
            rate(
                f'right, or in a set of at most {FEW}, or UNKNOWN, at {strength:g} times',
                [is_fair(trial, classes) for trial in own],
                least=95.0,
            ),
            rate(
                f'wrong confident name at {strength:g} times',
                [_is_wrong(trial, classes) for trial in own],
                most=3.0,
            ),
            rate(
                f'right single name or class at {strength:g} times',
                [named_right(trial, classes) for trial in known],
                least=least,
                note='of causes that the catalogue has',
            ),
            rate(
                f'causes UNKNOWN at {strength:g} times',
                [verdict_word(trial) == 'UNKNOWN' for trial in known],
                most=10.0,
                note='of causes that the catalogue has',
            ),
        ]
    return [*rows, _set_sizes(trials, classes)]


def _set_sizes(trials: Sequence[Scored], classes: Classes) -> MeasuredValue:
    """Mean size of the set of causes of the catalogue at 3 times."""
    sizes = [
        set_size(trial, classes)
        for trial in chosen(trials, 'deck', 3.0)
        if RIGHT_NAMES.get(hidden_names(trial)[0]) and verdict_word(trial) in ('NAMED', 'AMBIGUOUS')
    ]
    return MeasuredValue(
        'mean size of the set of causes at 3 times',
        float(np.mean(sizes)) if sizes else np.nan,
        target=at_most(1.5),
        note=f'{len(sizes)} trials NAMED or AMBIGUOUS, of causes that the catalogue has; effects '
        'and changes of the gear file',
    )


def cause_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Fair verdicts on each cause, with all that was said of it."""
    causes = dict.fromkeys(hidden_names(trial)[0] for trial in chosen(trials, 'deck'))
    rows = []
    for cause in sorted(causes):
        own = [trial for trial in chosen(trials, 'deck') if hidden_names(trial)[0] == cause]
        own.sort(key=lambda trial: float(trial.key['spec']['strength']))
        words = cause.replace('_', ' ')
        rows.append(
            rate(
                f'{words}: right, or in a set of at most {FEW}, or UNKNOWN',
                [is_fair(trial, classes) for trial in own],
                note='; '.join(_said(trial) for trial in own),
            )
        )
    return rows


def is_fair(trial: Scored, classes: Classes) -> bool:
    """True if a cause is rightly named, among few that are not excluded, or UNKNOWN."""
    few = len(reported(trial)) <= FEW and right(trial, reported(trial), classes)
    return (
        named_right(trial, classes)
        or verdict_word(trial) == 'UNKNOWN'
        or (verdict_word(trial) == 'AMBIGUOUS' and few)
    )


def _is_wrong(trial: Scored, classes: Classes) -> bool:
    """True if something else is named."""
    return verdict_word(trial) == 'NAMED' and not right(trial, names_of(trial), classes)


def _said(trial: Scored) -> str:
    """Strength, verdict, and what it names or does not exclude."""
    strength, verdict = trial.key['spec']['strength'], verdict_word(trial)
    said = f'{strength:g} times {verdict}'
    if verdict not in ('NAMED', 'AMBIGUOUS'):
        return said
    first = sorted(names_of(trial))
    rest = sorted(reported(trial) - names_of(trial)) if verdict == 'AMBIGUOUS' else []
    return ' '.join((said, *first, *(('or', ', '.join(rest)) if rest else ())))
