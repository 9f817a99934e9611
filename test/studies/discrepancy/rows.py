"""Figures of the blind tests: how often verdicts are right, and what a repair is worth.

Of a trial only its key and ``diagnosis.json`` are known here.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from studies.discrepancy.deck import FEW, cause_rows, deck_rows, is_fair
from studies.discrepancy.worth import repair_rows
from studies.rates import rate
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Section
from trawl_ros.lab.trials.trial import Scored
from trawl_ros.lab.trials.verdicts import (
    Classes,
    both_named,
    checked,
    chosen,
    found_of_three,
    hidden_names,
    named_right,
    names_of,
    one_named,
    parted,
    reported,
    right,
    same_said,
    set_size,
    verdict_word,
    wrong_named,
)


def all_sections(trials: Sequence[Scored], classes: Classes) -> list[Section]:
    """All sections with their rows."""
    return [
        Section('Clean trials', clean_rows(trials)),
        Section('Effects of the catalogue', inside_rows(trials, classes)),
        Section('Effects outside the catalogue', outside_rows(trials)),
        Section('Causes on deck', deck_rows(trials, classes)),
        Section('Two and three effects at once', pair_rows(trials, classes)),
        Section('Trials that cannot tell', poor_rows(trials, classes)),
        Section('Full bags', bag_rows(trials, classes)),
        Section('The repair', repair_rows(trials, classes)),
        Section('Each effect', effect_rows(trials, classes)),
        Section('Each cause on deck', cause_rows(trials, classes)),
        Section('Shuffled keys', shuffled_rows(trials, classes)),
    ]


def clean_rows(trials: Sequence[Scored]) -> list[MeasuredValue]:
    """Rate of false alarms."""
    clean = chosen(trials, 'clean')
    return [
        rate('clean trials with an alarm', [verdict_word(t) != 'NO_DISCREPANCY' for t in clean],
              most=2.0),
        rate('clean trials with a single name', [verdict_word(t) == 'NAMED' for t in clean],
              most=0.5),
    ]  # fmt: skip


def inside_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Detection and naming of effects in the catalogue."""
    inside = chosen(trials, 'inside')
    decided = [trial for trial in inside if verdict_word(trial) in ('NAMED', 'AMBIGUOUS')]
    third = chosen(trials, 'inside', 3.0)
    sizes = [
        set_size(trial, classes) for trial in third if verdict_word(trial) in ('NAMED', 'AMBIGUOUS')
    ]
    testable = {hidden_names(trial)[0] for trial in third}
    rows = [
        MeasuredValue(
            'effects that can be tested at 3 times the smallest detectable size',
            float(len(testable)),
            target=at_least(12.0),
            note=', '.join(sorted(testable)),
        ),
        *(
            rate(
                f'detected at {strength:g} times',
                [
                    verdict_word(t) not in ('NO_DISCREPANCY', 'NOT_TESTABLE')
                    for t in chosen(trials, 'inside', strength)
                ],
                least=95.0 if strength < 2.0 else None,
            )
            for strength in (1.5, 3.0, 6.0)
        ),
        rate(
            'truth within the set that is reported',
            [right(t, reported(t), classes) for t in decided],
            least=98.0,
            note='of trials NAMED or AMBIGUOUS',
        ),
        *(
            rate(
                f'right single name, or class, at {strength:g} times',
                [named_right(t, classes) for t in chosen(trials, 'inside', strength)],
                least=least,
            )
            for strength, least in ((1.5, None), (3.0, 93.0), (6.0, 97.0))
        ),
        MeasuredValue(
            'mean size of the set at 3 times',
            float(np.mean(sizes)) if sizes else np.nan,
            target=at_most(1.5),
            note='classes not excluded, of trials NAMED or AMBIGUOUS',
        ),
        rate(
            'wrong single name',
            [verdict_word(t) == 'NAMED' and not right(t, names_of(t), classes) for t in inside],
            most=1.0,
        ),
        *(
            rate(
                f'UNKNOWN at {strength:g} times',
                [verdict_word(t) == 'UNKNOWN' for t in chosen(trials, 'inside', strength)],
            )
            for strength in (3.0, 6.0)
        ),
    ]
    return rows


def outside_rows(trials: Sequence[Scored]) -> list[MeasuredValue]:
    """Verdicts on effects outside the catalogue."""
    outside = chosen(trials, 'outside')
    kinds = {hidden_names(trial)[0] for trial in outside}
    return [
        MeasuredValue(
            'kinds of effects outside the catalogue',
            float(len(kinds)),
            target=at_least(10.0),
            note=', '.join(sorted(kinds)),
        ),
        *(
            rate(
                f'UNKNOWN at {strength:g} times',
                [verdict_word(t) == 'UNKNOWN' for t in chosen(trials, 'outside', strength)],
                least=least,
            )
            for strength, least in ((6.0, 85.0), (10.0, 95.0))
        ),
        rate('wrong name', [verdict_word(t) == 'NAMED' for t in outside], most=5.0),
        rate('several names', [verdict_word(t) == 'AMBIGUOUS' for t in outside]),
    ]


def pair_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Verdicts on two and on three effects at once."""
    pairs, triples = chosen(trials, 'pair'), chosen(trials, 'triple')
    return [
        rate(
            'both of two effects at 3 times',
            [both_named(trial, classes) for trial in pairs],
            least=50.0,
        ),
        rate('one of two effects named alone', [one_named(trial, classes) for trial in pairs]),
        rate(
            'two of three effects at least, and no other, at 3 times',
            [found_of_three(trial, classes) for trial in triples],
            least=60.0,
        ),
        rate(
            'anything else named where three are hidden',
            [wrong_named(trial, classes) for trial in triples],
        ),
    ]


def poor_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Tows so much alike that effects are too, and the proposed next tow."""
    poor, followed = chosen(trials, 'poor'), chosen(trials, 'followed')
    alone = [
        trial for trial in poor if verdict_word(trial) == 'NAMED' and len(reported(trial)) == 1
    ]
    decided = [trial for trial in poor if verdict_word(trial) in ('NAMED', 'AMBIGUOUS')]
    return [
        rate('too poor a trial: a single name, and a wrong one',
             [trial in alone and not right(trial, names_of(trial), classes) for trial in poor]),
        rate('too poor a trial: truth within the set that is reported',
             [right(trial, reported(trial), classes) for trial in decided]),
        rate('the proposed tow parts what could not be told apart', [parted(t) for t in followed],
             note='of poor trials with several names, or a class, and a proposal'),
        rate('the proposed tow, or a check on deck, parts what could not be told apart',
             [parted(t) or checked(t, classes) for t in followed], least=85.0,
             note='the right name is among those left, and all of these but one have a check'),
    ]  # fmt: skip


def bag_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Agreement of verdicts from full bags with those from simulated windows."""
    by_number: Mapping[int, Scored] = {
        trial.key['spec']['number']: trial
        for trial in trials
        if trial.key['spec']['form'] == 'windows'
        and trial.key['spec']['series'] != 'followed'
        and trial.diagnosis is not None
    }
    rows = []
    for form, words in (('bags', 'one state after the other'), ('dynamic', 'towed in time')):
        own = [t for t in trials if t.key['spec']['form'] == form and t.diagnosis is not None]
        pairs = [
            (trial, by_number[like])
            for trial in own
            if (like := trial.key['spec']['like']) in by_number
        ]
        listed = ', '.join(
            f'{"+".join(hidden_names(trial)) or "clean"} {verdict_word(other)} '
            f'{verdict_word(trial)}'
            for trial, other in pairs
            if not same_said(trial, other)
        )
        note = f'; others: {listed}' if listed else ''
        if form == 'dynamic':
            rows += _right_rows(own, classes)
        rows.append(
            rate(
                f'full bags, {words}: verdict and name as of its windows',
                [same_said(trial, other) for trial, other in pairs],
                note=f'same effect, size and plant, other noise{note}',
            )
        )
    return rows


def _right_rows(own: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Verdicts on trials of a day that were towed in time."""
    listed = '; '.join(
        f'{trial.key["spec"]["plan"]}, {"+".join(hidden_names(trial)) or "nothing"} '
        f'{trial.key["spec"]["strength"]:g} ×: {verdict_word(trial)} '
        f'{" or ".join(sorted(reported(trial)))}'.strip()
        for trial in own
    )
    return [
        rate('towed in time: verdict right', [_right_at_sea(trial, classes) for trial in own],
             least=92.0, note='nothing where nothing is hidden; else the right name or class, or '
             f'it in a set of at most {FEW}: {listed}'),
        rate('towed in time: a wrong name', [wrong_named(trial, classes) for trial in own]),
    ]  # fmt: skip


def _right_at_sea(trial: Scored, classes: Classes) -> bool:
    if not hidden_names(trial):
        return verdict_word(trial) == 'NO_DISCREPANCY'
    return verdict_word(trial) != 'UNKNOWN' and is_fair(trial, classes)


def effect_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Right names of each effect at 3 and 6 times together."""
    rows = []
    for name in sorted({hidden_names(trial)[0] for trial in chosen(trials, 'inside')}):
        own = [
            trial
            for trial in chosen(trials, 'inside')
            if hidden_names(trial)[0] == name and trial.key['spec']['strength'] >= 3.0
        ]
        if own:
            verdicts = [verdict_word(trial) for trial in own]
            counted = ', '.join(
                f'{kind} {verdicts.count(kind)}' for kind in dict.fromkeys(verdicts)
            )
            words = name.replace('_', ' ')
            rows.append(
                rate(
                    f'{words}: right name',
                    [named_right(trial, classes) for trial in own],
                    note=counted,
                )
            )
    return rows


def shuffled_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Score by chance: the same with keys that belong to other trials."""
    inside = [trial for trial in chosen(trials, 'inside') if trial.key['spec']['strength'] >= 3.0]
    if len(inside) < 2:
        return []
    order = np.random.default_rng(0).permutation(len(inside))
    mixed = [
        Scored(inside[other].key, trial.diagnosis)
        for trial, other in zip(inside, order, strict=True)
    ]
    kinds = len({hidden_names(trial)[0] for trial in inside})
    return [
        rate('right single name at 3 and 6 times, keys shuffled',
              [named_right(trial, classes) for trial in mixed],
              note=f'one in {kinds} by chance, more where classes are wide'),
    ]  # fmt: skip
