# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sentences of a diagnosis, the verdict first."""

from trawl_ros.diagnosis.diagnosis import BoardsMoved, Diagnosis, values_of
from trawl_ros.diagnosis.library.gear_file_change import GearFileChange
from trawl_ros.diagnosis.report.common_units import in_common_unit
from trawl_ros.diagnosis.report.known_together import known_together
from trawl_ros.gear.parts import own_parts

MENTIONED = 3
"""Number of places where model and measurement disagree, and of causes, that are named at once."""

UNUSUAL_STD = 2.0
"""Departure of a coefficient, in std, from where the boards are not those of the gear file."""


def headline(diagnosis: Diagnosis) -> str:
    """Return the verdict in one sentence."""
    return own_parts(_headline(diagnosis), diagnosis.gear)


def _headline(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == 'NOT_TESTABLE':
        return f'Nothing can be said: {diagnosis.reason}.'
    if diagnosis.verdict == 'NO_DISCREPANCY':
        moved = diagnosis.moved
        if moved is not None and abs(moved.std) > UNUSUAL_STD:
            return (
                'No discrepancy: nothing is missing, but the boards are not those of the gear '
                f'file ({_moved(moved)}).'
            )
        return f'No discrepancy: {diagnosis.reason}.'
    if diagnosis.best is None and diagnosis.frozen:
        listed = '; '.join(map(str, diagnosis.frozen))
        return f'A sensor is frozen ({listed}). Of the other readings: {diagnosis.reason}.'
    if diagnosis.verdict == 'NAMED':
        named = ' and '.join(
            f'{own.words} ({100.0 * own.probability:.1f} %)'
            if own.is_leaf
            else f'in the group {own.words} ({100.0 * own.probability:.1f} %)'
            for own in diagnosis.named
        )
        return f'The cause is {named}: {_sizes(diagnosis)}.'
    if diagnosis.verdict == 'AMBIGUOUS':
        return (
            f'The cause is one of these: {_likely(diagnosis)}. The likeliest: {_sizes(diagnosis)}.'
        )
    return f'Model and measurements disagree, and no cause is named: {diagnosis.reason}.'


def _likely(diagnosis: Diagnosis) -> str:
    posterior = diagnosis.posterior
    assert posterior is not None
    listed = [
        f'{name.replace("_", " ")} ({100.0 * probability:.0f} %)'
        for name, probability in posterior.leaves.items()
        if name in diagnosis.among
    ]
    rest = len(listed) - MENTIONED
    return ', '.join(listed[:MENTIONED]) + (f' and {rest} more' if rest > 0 else '')


def _moved(moved: BoardsMoved) -> str:
    return (
        f'{moved.coefficient} by {moved.std:+.1f} std, all of them together change the spread by '
        f'{moved.spread:+.1f} m and the depth of the doors by {moved.depth:+.1f} m'
    )


def sentences(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return remarks on the verdict, one sentence each."""
    lines = list(diagnosis.remarks)
    lines += [line for tow in diagnosis.onsets for line in tow.sentences()]
    posterior, best, holdout = diagnosis.posterior, diagnosis.best, diagnosis.holdout
    if posterior is not None:
        lines.append(
            f'The probability that nothing is missing is {_percent(posterior.nothing)}, that '
            f'something outside the library is missing {_percent(posterior.unknown)}.'
        )
    if diagnosis.moved is not None:
        lines.append(f'The boards moved from the gear file: {_moved(diagnosis.moved)}.')
    if diagnosis.where and diagnosis.verdict != 'NO_DISCREPANCY':
        listed = '; '.join(
            f'{where.channel.replace("_", " ")} {where.region}'
            for where in diagnosis.where[:MENTIONED]
        )
        lines.append(f'With the boards alone the readings are off: {listed}.')
    if best is not None and diagnosis.verdict in ('NAMED', 'AMBIGUOUS'):
        lines += known_together(best)
    if holdout is not None and holdout.removed is not None and best is not None:
        kept_back = 'tows' if diagnosis.split.by == 'tow' else 'steady states'
        placebo = (
            ''
            if holdout.removed_by_placebo is None
            else f'; the best other cause, {(holdout.instead or "").replace("_", " ")}, removes '
            f'{100.0 * holdout.removed_by_placebo:.0f} %'
        )
        lines.append(
            f'On held-out {kept_back} it removes {100.0 * holdout.removed:.0f} % of the error '
            f'beyond what instruments explain{placebo}.'
        )
    if diagnosis.split.by == 'state' and diagnosis.split.kept_back:
        lines.append(
            'With so few tows the held-out steady states are of tows that also decided: tow again '
            'on another day.'
        )
    return tuple(own_parts(line, diagnosis.gear) for line in lines)


def _percent(probability: float) -> str:
    return 'below 0.1 %' if probability < 1e-3 else f'{100.0 * probability:.1f} %'


def _sizes(diagnosis: Diagnosis) -> str:
    best = diagnosis.best
    if best is None or best.refit is None:
        return 'of unknown size'
    phrases = []
    for suspect, values in zip(best.suspects, values_of(best).values(), strict=True):
        effect, name = suspect.entry.effect, suspect.entry.name.replace('_', ' ')
        if isinstance(effect, GearFileChange):
            value, low, high, unit = values['change']
            factor, symbol = (100.0, '%') if effect.record.relative else (1.0, unit)
            ends = f'{factor * low:.3g} to {factor * high:.3g} {symbol}'
            phrases.append(f'{effect.words(value)} ({ends})')
            continue
        neutral = {parameter.name: parameter.neutral for parameter in effect.parameters}
        listed = ', '.join(
            f'{parameter.replace("_", " ")} '
            + in_common_unit(value, low, high, unit, parameter, neutral[parameter])
            for parameter, (value, low, high, unit) in values.items()
        )
        phrases.append(f'{name}, {listed}')
    return ' and '.join(phrases)
