"""Sentences of a diagnosis, the verdict first."""

from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.rules import FALSE_ALARMS
from trawl_ros.diagnosis.weighing import Weighed

MENTIONED = 3
"""So many places where model and measurement disagree are named at once."""


def headline(found: Diagnosis) -> str:
    """Verdict in one sentence."""
    if found.verdict == 'NOT_TESTABLE':
        return f'Nothing can be said: {found.reason}.'
    if found.verdict == 'NO_DISCREPANCY':
        return f'No discrepancy: {found.reason}.'
    start = 'Model and measurements disagree'
    if found.where:
        listed = '; '.join(
            f'{where.channel.replace("_", " ")} {where.region}' for where in found.where[:MENTIONED]
        )
        start += f' ({listed})'
    if found.verdict == 'NAMED':
        return f'{start}, and the effect is {_effects(found)}.'
    if found.verdict == 'AMBIGUOUS':
        return f'{start}, and the effect may be {_effects(found)}, but {found.reason}.'
    return f'{start}, and no effect of the catalogue explains it: {found.reason}.'


def sentences(found: Diagnosis) -> tuple[str, ...]:
    """Remarks beside the verdict, one sentence each."""
    said = list(found.remarks)
    best, named, shown = found.best, found.named, found.shown
    if found.verdict == 'NAMED' and named is not None and named.alike:
        said.append(
            'No data of this kind can part it from '
            f'{", ".join(named.alike).replace("_", " ")}: read the name as any of these.'
        )
    if best is not None:
        it = 'It' if found.verdict == 'NAMED' else f'The best effect, {_names(best)},'
        said.append(
            f'{it} lowers χ² by {best.delta_chi2:.0f} and BIC by {best.delta_bic:.0f}; each of '
            f'what was left out gains {best.gain[0]:.1f} of χ² ({best.gain[1]:.1f} to '
            f'{best.gain[2]:.1f}), and in {best.share:.0%} of resampled trials it is the best.'
        )
    if found.empirical is not None:
        term, weighed = found.empirical.term, found.empirical.weighed
        ((value, low, high, unit),) = values_of(weighed.refit)[term.name].values()
        said.append(
            f'Empirical, not a cause: {term.sentence[0].lower()}{term.sentence[1:-1]}, by '
            f'{value:.3g}{" " + unit if unit else ""} ({low:.3g} to {high:.3g}); the nearest '
            f'physical reading is {term.reading}. It lowers χ² by {weighed.delta_chi2:.0f}, the '
            f'best placebo by {found.empirical.placebo:.0f}.'
        )
    if shown is not None and shown.removed is not None and found.added is not None:
        it = 'it' if found.empirical is None and best is not None else found.added_as
        kept = 'tows' if found.split.by == 'tow' else 'steady states'
        placebo = (
            ''
            if shown.removed_by_placebo is None
            else f'; the best {"" if found.empirical else "other "}effect, '
            f'{(shown.instead or "").replace("_", " ")}, removes {shown.removed_by_placebo:.0%}'
        )
        said.append(
            f'On {kept} that decided nothing {it} removes {shown.removed:.0%} of the error beyond '
            f'what instruments explain{placebo}.'
        )
    if found.split.by == 'state' and found.split.showing:
        said.append(
            'With so few tows the steady states that show the gap are of tows that also decided: '
            'tow again on another day.'
        )
    if found.seen is not None:
        said.append(
            f'The evidence is {found.seen.strongest:.1f}, where chance exceeds '
            f'{found.seen.limit:.1f} in {FALSE_ALARMS:.0%} of trials without any effect '
            '(-log₁₀ of a probability).'
        )
    return tuple(said)


def _names(one: Weighed) -> str:
    return ' and '.join(name.replace('_', ' ') for name in one.refit.names)


def _effects(found: Diagnosis) -> str:
    best = found.best
    if best is None:
        return 'unknown'
    parts = []
    for name, values in values_of(best.refit).items():
        listed = ', '.join(
            f'{parameter.replace("_", " ")} {value:.3g}{" " + unit if unit else ""} '
            f'({low:.3g} to {high:.3g})'
            for parameter, (value, low, high, unit) in values.items()
        )
        parts.append(f'{name.replace("_", " ")}, {listed}')
    return ' and '.join(parts)
