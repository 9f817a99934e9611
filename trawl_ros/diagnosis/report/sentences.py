"""Sentences of a diagnosis, the verdict first."""

from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.report.common_units import in_common_unit
from trawl_ros.diagnosis.report.known_together import known_together
from trawl_ros.diagnosis.rules import FALSE_ALARMS, NOISE_SEEN
from trawl_ros.diagnosis.weighing import Weighed
from trawl_ros.gear.parts import own_parts

MENTIONED = 3
"""So many places where model and measurement disagree are named at once."""


def headline(diagnosis: Diagnosis) -> str:
    """Verdict in one sentence."""
    return own_parts(_headline(diagnosis), diagnosis.gear)


def _headline(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == 'NOT_TESTABLE':
        return f'Nothing can be said: {diagnosis.reason}.'
    if diagnosis.verdict == 'NO_DISCREPANCY':
        return f'No discrepancy: {diagnosis.reason}.'
    if diagnosis.verdict == 'NAMED' and diagnosis.best is None:
        listed = '; '.join(map(str, diagnosis.frozen))
        return f'A sensor is frozen ({listed}), and {diagnosis.reason}.'
    start = 'Model and measurements disagree'
    if diagnosis.where:
        listed = '; '.join(
            f'{where.channel.replace("_", " ")} {where.region}'
            for where in diagnosis.where[:MENTIONED]
        )
        start += f' ({listed})'
    if diagnosis.verdict == 'NAMED':
        return f'{start}, and the effect is {_effects(diagnosis)}.'
    if diagnosis.verdict == 'AMBIGUOUS':
        return f'{start}, and the effect may be {_effects(diagnosis)}, but {diagnosis.reason}.'
    if best := diagnosis.best:
        # A name without its size would be taken for a finding.
        partly = f'; the gear acts partly like {_names(best)}, which is not enough'
    else:
        partly = ''
    return f'{start}, and no effect of the catalogue explains it{partly}: {diagnosis.reason}.'


def sentences(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Remarks beside the verdict, one sentence each."""
    lines = list(diagnosis.remarks)
    lines += [line for tow in diagnosis.onsets for line in tow.sentences()]
    best, named, holdout = diagnosis.best, diagnosis.named, diagnosis.holdout
    if diagnosis.verdict == 'NAMED' and named is not None and named.alike:
        lines.append(
            'No data of this kind can part it from '
            f'{", ".join(named.alike).replace("_", " ")}: read the name as any of these.'
        )
    if best is not None and diagnosis.verdict in ('NAMED', 'AMBIGUOUS'):
        lines += known_together(best)
    if best is not None:
        it = 'It' if diagnosis.verdict == 'NAMED' else f'The best effect, {_names(best)},'
        lines.append(
            f'{it} lowers χ² by {best.delta_chi2:.0f} and BIC by {best.delta_bic:.0f}; each of '
            f'what was left out gains {best.gain[0]:.1f} of χ² ({best.gain[1]:.1f} to '
            f'{best.gain[2]:.1f}), and in {best.share:.0%} of resampled trials it is the best.'
        )
    if diagnosis.mimics and diagnosis.verdict == 'UNKNOWN':
        listed = '; or '.join(str(mimic) for mimic in diagnosis.mimics)
        lines.append(
            f'What would explain more than any effect: {listed}. The first lowers χ² by '
            f'{diagnosis.mimics[0].delta_chi2:.0f}.'
        )
    if diagnosis.empirical is not None:
        term, weighed = diagnosis.empirical.term, diagnosis.empirical.weighed
        ((value, low, high, unit),) = values_of(weighed.refit)[term.name].values()
        lines.append(
            f'Empirical, not a cause: {term.sentence[0].lower()}{term.sentence[1:-1]}, by '
            f'{value:.3g}{" " + unit if unit else ""} ({low:.3g} to {high:.3g}); the nearest '
            f'physical reading is {term.reading}. It lowers χ² by {weighed.delta_chi2:.0f}, the '
            f'best placebo by {diagnosis.empirical.placebo:.0f}.'
        )
    if holdout is not None and holdout.removed is not None and diagnosis.added is not None:
        it = 'it' if diagnosis.empirical is None and best is not None else diagnosis.added_as
        kept_back = 'tows' if diagnosis.split.by == 'tow' else 'steady states'
        placebo = (
            ''
            if holdout.removed_by_placebo is None
            else f'; the best {"" if diagnosis.empirical else "other "}effect, '
            f'{(holdout.instead or "").replace("_", " ")}, removes {holdout.removed_by_placebo:.0%}'
        )
        lines.append(
            f'On {kept_back} that decided nothing {it} removes {holdout.removed:.0%} of the error '
            f'beyond what instruments explain{placebo}.'
        )
    if diagnosis.split.by == 'state' and diagnosis.split.kept_back:
        lines.append(
            'With so few tows the steady states that show the gap are of tows that also decided: '
            'tow again on another day.'
        )
    if diagnosis.score_test is not None:
        lines.append(
            f'The evidence is {diagnosis.score_test.strongest:.1f}, where chance exceeds '
            f'{diagnosis.score_test.limit:.1f} in {FALSE_ALARMS:.0%} of trials without any effect '
            '(-log₁₀ of a probability).'
        )
        noise = max(diagnosis.score_test.fit.scales)
        if noise > NOISE_SEEN:
            lines.append(
                f'Readings lie around the model by {noise:.1f} times what noise explains, with '
                'every effect and pattern free.'
            )
    return tuple(own_parts(line, diagnosis.gear) for line in lines)


def _names(entry: Weighed) -> str:
    return ' and '.join(name.replace('_', ' ') for name in entry.refit.names)


def _effects(diagnosis: Diagnosis) -> str:
    best = diagnosis.best
    if best is None:
        return 'unknown'
    neutral = {
        (candidate.name, parameter.name): parameter.neutral
        for candidate in best.refit.wanted
        for parameter in candidate.effect.parameters
    }
    phrases = []
    for name, values in values_of(best.refit).items():
        listed = ', '.join(
            f'{parameter.replace("_", " ")} {value:.3g}{" " + unit if unit else ""} '
            f'({low:.3g} to {high:.3g})'
            + in_common_unit(value, low, high, unit, parameter, neutral[name, parameter])
            for parameter, (value, low, high, unit) in values.items()
        )
        phrases.append(f'{name.replace("_", " ")}, {listed}')
    return ' and '.join(phrases)
