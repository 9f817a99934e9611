"""Figures of the blind tests: how often verdicts are right, and what a repair is worth.

Of a trial only its key and ``diagnosis.json`` are known here.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from scipy.stats import binomtest

from trawl_ros.model.board import COEFFICIENTS
from trawl_ros.studies.discrepancy.study import Scored
from trawl_ros.studies.row import Row

EXACT = 'binomial 95 % interval (Clopper and Pearson)'
AGAIN = 'median; 95 % interval by drawing trials again'
DRAWS = 1000


def names_of(diagnosis: dict[str, Any]) -> set[str]:
    """Effects that are named, with all of their classes."""
    return {name for effect in diagnosis['effects'] for name in effect['class']}


def reported(diagnosis: dict[str, Any]) -> set[str]:
    """All effects that are not excluded."""
    return names_of(diagnosis) | set(diagnosis['ambiguous_with'])


def effects_of(trial: Scored) -> tuple[str, ...]:
    """What is hidden."""
    return tuple(trial.key['spec']['effects'])


def chosen(trials: Iterable[Scored], series: str, strength: float | None = None) -> list[Scored]:
    """Testable trials of a series and a strength."""
    return [
        trial
        for trial in trials
        if trial.key['spec']['series'] == series
        and trial.diagnosis is not None
        and (strength is None or trial.key['spec']['strength'] == strength)
    ]


def all_rows(trials: Sequence[Scored]) -> list[tuple[str, tuple[Row, ...]]]:
    """All sections with their rows."""
    return [
        ('Clean trials', tuple(clean_rows(trials))),
        ('Effects of the catalogue', tuple(inside_rows(trials))),
        ('Effects outside the catalogue', tuple(outside_rows(trials))),
        ('Two effects at once', tuple(pair_rows(trials))),
        ('The repair', tuple(repair_rows(trials))),
        ('Each effect', tuple(effect_rows(trials))),
        ('Shuffled keys', tuple(shuffled_rows(trials))),
    ]


def clean_rows(trials: Sequence[Scored]) -> list[Row]:
    """How often there is an alarm where nothing is."""
    clean = chosen(trials, 'clean')
    return [
        _rate('clean trials with an alarm', [verdict(t) != 'NO_DISCREPANCY' for t in clean],
              most=2.0),
        _rate('clean trials with a single name', [verdict(t) == 'NAMED' for t in clean],
              most=0.5),
    ]  # fmt: skip


def inside_rows(trials: Sequence[Scored]) -> list[Row]:
    """Detection and naming of what the catalogue has."""
    inside = chosen(trials, 'inside')
    said = [trial for trial in inside if verdict(trial) in ('NAMED', 'AMBIGUOUS')]
    third = chosen(trials, 'inside', 3.0)
    sizes = [
        1 + len(set(_of(trial)['ambiguous_with']) - names_of(_of(trial)))
        for trial in third
        if verdict(trial) in ('NAMED', 'AMBIGUOUS')
    ]
    testable = {effects_of(trial)[0] for trial in third}
    rows = [
        Row(
            'effects that can be tested at 3 times the smallest detectable size',
            float(len(testable)),
            least=12.0,
            note=', '.join(sorted(testable)),
        ),
        *(
            _rate(
                f'detected at {strength:g} times',
                [verdict(t) not in ('NO_DISCREPANCY', 'NOT_TESTABLE')
                 for t in chosen(trials, 'inside', strength)],
                least=95.0 if strength < 2.0 else None,
            )
            for strength in (1.5, 3.0, 6.0)
        ),
        _rate('truth within the set that is reported', [right(t, reported) for t in said],
              least=98.0, note='of trials NAMED or AMBIGUOUS'),
        *(
            _rate(
                f'right single name, or class, at {strength:g} times',
                [named_right(t) for t in chosen(trials, 'inside', strength)],
                least=least,
            )
            for strength, least in ((1.5, None), (3.0, 90.0), (6.0, 97.0))
        ),
        Row('mean size of the set at 3 times', float(np.mean(sizes)) if sizes else np.nan,
            target=1.5, note='classes not excluded, of trials NAMED or AMBIGUOUS'),
        _rate('wrong single name', [verdict(t) == 'NAMED' and not right(t, names_of)
                                    for t in inside], most=2.0),
        *(
            _rate(
                f'UNKNOWN at {strength:g} times',
                [verdict(t) == 'UNKNOWN' for t in chosen(trials, 'inside', strength)],
            )
            for strength in (3.0, 6.0)
        ),
    ]  # fmt: skip
    return rows


def outside_rows(trials: Sequence[Scored]) -> list[Row]:
    """What is said of what the catalogue does not have."""
    outside = chosen(trials, 'outside')
    kinds = {effects_of(trial)[0] for trial in outside}
    return [
        Row('kinds of effects outside the catalogue', float(len(kinds)), least=10.0,
            note=', '.join(sorted(kinds))),
        *(
            _rate(
                f'UNKNOWN at {strength:g} times',
                [verdict(t) == 'UNKNOWN' for t in chosen(trials, 'outside', strength)],
                least=least,
            )
            for strength, least in ((6.0, 80.0), (10.0, 95.0))
        ),
        _rate('wrong name', [verdict(t) == 'NAMED' for t in outside], most=10.0),
        _rate('several names', [verdict(t) == 'AMBIGUOUS' for t in outside]),
    ]  # fmt: skip


def pair_rows(trials: Sequence[Scored]) -> list[Row]:
    """Two effects at once."""
    pairs = chosen(trials, 'pair')
    return [
        _rate('both of two effects at 3 times', [both_named(trial) for trial in pairs], least=50.0),
        _rate('one of two effects named alone', [one_named(trial) for trial in pairs]),
    ]


def repair_rows(trials: Sequence[Scored]) -> list[Row]:
    """What the named effect is worth on tows that decided nothing."""
    named = [
        trial
        for trial in chosen(trials, 'inside')
        if trial.key['spec']['strength'] >= 3.0 and named_right(trial)
    ]
    removed, placebo = (
        [100.0 * part for trial in named if (part := _removed(trial, by)) is not None]
        for by in ('after', 'placebo')
    )
    ratios = [ratio for trial in named if (ratio := _coefficient_ratio(trial)) is not None]
    inside = [_covered(trial) for trial in named]
    return [
        _median('held-out excess error removed by the effect that is named', removed, '%',
                least=80.0),
        _median('held-out excess error removed by the best wrong effect', placebo, '%',
                most=20.0),
        _median('error of the coefficients with the effect named over that without', ratios, '',
                most=1.0 / 3.0),
        _rate('amplitude intervals that cover the hidden size',
              [value for value in inside if value is not None], least=90.0, most=98.0,
              note='effects of one parameter whose unit is that of the size'),
    ]  # fmt: skip


def effect_rows(trials: Sequence[Scored]) -> list[Row]:
    """Right names of each effect at 3 and 6 times together."""
    rows = []
    for name in sorted({effects_of(trial)[0] for trial in chosen(trials, 'inside')}):
        own = [
            trial
            for trial in chosen(trials, 'inside')
            if effects_of(trial)[0] == name and trial.key['spec']['strength'] >= 3.0
        ]
        if own:
            verdicts = [verdict(trial) for trial in own]
            counted = ', '.join(
                f'{kind} {verdicts.count(kind)}' for kind in dict.fromkeys(verdicts)
            )
            words = name.replace('_', ' ')
            rows.append(
                _rate(f'{words}: right name', [named_right(trial) for trial in own], note=counted)
            )
    return rows


def shuffled_rows(trials: Sequence[Scored]) -> list[Row]:
    """The same score with keys that belong to other trials: what chance would reach."""
    inside = [trial for trial in chosen(trials, 'inside') if trial.key['spec']['strength'] >= 3.0]
    if len(inside) < 2:
        return []
    order = np.random.default_rng(0).permutation(len(inside))
    mixed = [
        Scored(inside[other].key, trial.diagnosis)
        for trial, other in zip(inside, order, strict=True)
    ]
    kinds = len({effects_of(trial)[0] for trial in inside})
    return [
        _rate('right single name at 3 and 6 times, keys shuffled',
              [named_right(trial) for trial in mixed],
              note=f'one in {kinds} by chance, more where classes are wide'),
    ]  # fmt: skip


def verdict(trial: Scored) -> str:
    """The first word of a diagnosis."""
    return str(_of(trial)['verdict'])


def right(trial: Scored, of: Callable[[dict[str, Any]], set[str]]) -> bool:
    """Whether what is hidden is among what is said."""
    return set(effects_of(trial)) <= of(_of(trial))


def named_right(trial: Scored) -> bool:
    """Whether there is one name, and the right one."""
    alone = len(_of(trial)['effects']) == 1
    return verdict(trial) == 'NAMED' and alone and right(trial, names_of)


def both_named(trial: Scored) -> bool:
    """Whether two effects are hidden and both are named."""
    pair = trial.key['spec']['series'] == 'pair'
    return pair and verdict(trial) == 'NAMED' and right(trial, names_of)


def one_named(trial: Scored) -> bool:
    """Whether two effects are hidden and one of them is named, without any that is not there."""
    names = names_of(_of(trial))
    pair = trial.key['spec']['series'] == 'pair' and not both_named(trial)
    return pair and verdict(trial) == 'NAMED' and bool(names) and names <= set(effects_of(trial))


def _of(trial: Scored) -> dict[str, Any]:
    assert trial.diagnosis is not None
    return trial.diagnosis


def _removed(trial: Scored, by: str) -> float | None:
    """Part of the mean square error beyond that of the plant itself which a repair removes."""
    before, after = 0.0, 0.0
    for name, channel in _of(trial)['channels'].items():
        if channel[by] is None or name not in trial.key['floor']:
            return None
        floor = trial.key['floor'][name]
        before += (channel['before'] ** 2 - floor**2) / channel['expected'] ** 2
        after += (channel[by] ** 2 - floor**2) / channel['expected'] ** 2
    return 1.0 - after / before if before > 0.0 else None


def _coefficient_ratio(trial: Scored) -> float | None:
    """Error of the twelve with the effect over that without, each in its std after."""
    found = _of(trial)['coefficients']
    truth = dict(zip(COEFFICIENTS, trial.key['coefficients'], strict=True))
    sums = {'before': 0.0, 'after': 0.0}
    for name, value in truth.items():
        own = found[name]
        if own['after'] is None:
            return None
        for when in sums:
            sums[when] += ((own[when]['value'] - value) / own['after']['std']) ** 2
    return float(np.sqrt(sums['after'] / sums['before']))


def _covered(trial: Scored) -> bool | None:
    """Whether the interval of an effect of one parameter covers the hidden size."""
    (effect,) = _of(trial)['effects'] if len(_of(trial)['effects']) == 1 else (None,)
    name = effects_of(trial)[0]
    if effect is None or effect['name'] != name or len(effect['parameters']) != 1:
        return None
    ((_, parameter),) = effect['parameters'].items()
    neutral = 1.0 if name == 'warp_strumming' else 0.0
    size = trial.key['sizes'][0] + neutral
    return bool(parameter['low'] <= size <= parameter['high'])


def _rate(
    what: str,
    outcomes: Sequence[bool],
    *,
    least: float | None = None,
    most: float | None = None,
    note: str = '',
) -> Row:
    if not outcomes:
        return Row(what, np.nan, unit='%', least=least, target=most, note='no trials')
    count, number = sum(outcomes), len(outcomes)
    ends = binomtest(count, number).proportion_ci(method='exact')
    said = f'{count} of {number}; {note or EXACT}'
    return Row(what, 100.0 * count / number, 100.0 * ends.low, 100.0 * ends.high, '%', most, said,
               least)  # fmt: skip


def _median(
    what: str,
    values: Sequence[float],
    unit: str,
    *,
    least: float | None = None,
    most: float | None = None,
) -> Row:
    if not values:
        return Row(what, np.nan, unit=unit, least=least, target=most, note='no trials')
    known = np.array(values)
    chance = np.random.default_rng(0)
    drawn = np.median(known[chance.integers(len(known), size=(DRAWS, len(known)))], axis=1)
    low, high = np.percentile(drawn, (2.5, 97.5))
    note = f'{len(known)} trials named rightly at 3 and 6 times; {AGAIN}'
    return Row(what, float(np.median(known)), float(low), float(high), unit, most, note, least)
