"""The rules by which a verdict is reached, all of them here.

They follow what a trial can tell: an effect is named only if the data would be improbable without
it, if it predicts tows it was not fitted to, if no other effect does nearly as well, and if what is
then left over looks like errors.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Verdict = Literal['NO_DISCREPANCY', 'NAMED', 'AMBIGUOUS', 'UNKNOWN', 'NOT_TESTABLE']

FALSE_ALARMS = 0.01
"""Part of trials without any effect in which a discrepancy is seen nevertheless."""

DOUBT = 1.2
"""Errors of calibration and of the model may be so many times what they are taken to be, before
something is seen or named: neither is found from the data, as noise is."""

NOISE_TO_EXPLAIN = 1.7
"""Noise found over noise stated from where it is asked whether it is noise."""

NOISE_SEEN = 2.0
"""Noise found over noise stated from where there is a discrepancy, though neither effect nor
pattern shows it: a jet that reverses with the course leaves residuals of all signs."""

RIVAL = 6.0
"""An effect whose χ² is worse than the best one's by less is not excluded."""

LEAST_BIC = 10.0
"""By so much an effect must lower the information criterion of Bayes (Kass and Raftery 1995)."""

LEAST_SHARE = 0.8
"""Part of the resampled trials in which the same effect is the best."""

OTHER_SHARE = 0.05
"""An effect that is the best in fewer of the resampled trials is excluded."""

FIT = 1e-3
"""Probability below which what is left over does not look like errors."""

LEFT_SHARE = 0.1
"""Part of the χ² that an effect explains: what it leaves over is taken for another form of the same
where it is less, for at sea no effect has the very form that a catalogue gives it."""

FIT_AT_ALL = 1e-8
"""Probability below which even a small part of what is explained is too much to be left over."""

WORSE, WORSE_BY = 1e-3, 10.0
"""A repair makes a quantity worse where what it misses by, on what was kept back, has a smaller
probability than the first from errors, and a χ² larger by the second than with the boards alone."""

ALIKE = 0.98
"""Cosine from where two effects are one class for the trial at hand: with less than 0.98 the right
one of two is named in 97 % of trials at six times the detectable size."""

NEARLY_ALIKE = 0.9
"""Cosine from where two effects may be there at once and pass for one of them."""

BOUND_SHARE = 0.05
"""An effect whose values would rest on a bound stands behind one that is worse by less than this
part of what it explains, and whose values are possible."""

FEWEST_STATES = 3
"""Steady states without which nothing can be tested."""

FEWEST_TOWS = 8
"""So many tows are drawn anew; where there are fewer it is noise that is drawn."""

FEWEST_UNITS = 3
"""With fewer tows it is steady states that are left out to find what each gains."""

NOWHERE_NEAR, NEAR = 10.0, 3.0
"""Noise found over noise stated, boards alone, from where it is another gear if no effect has a
name, and neither effect nor empirical term brings it below the second. A baseline that is below
the second shows that it is the same."""

EMPIRICAL_OVER_PLACEBO = 1.5
"""An empirical term explains so many times the χ² of the best placebo, or is none."""

SCREENED = 4
"""So many effects of those that are not excluded are refitted."""

SCREEN, SCREEN_SHARE = 16.0, 0.5
"""To first order an effect may be worse by so much χ², or explain only this part of what the first
does, and still be the best in a refit."""

MIMICS_SOLVED, MIMIC_SCREEN_SHARE = 10, 0.95
"""So many changes of gear file or instruments are solved in full, the likeliest to first order of
those that explain at least this part of what the effect does, or less by `SCREEN`."""

MIMICS_TRIED = 2
"""And so many in any case of those that explain `SCREEN_SHARE`: a slack rope is far from first
order."""

MIMICS_NAMED = 3
"""So many of them are named; then no more are looked for."""


@dataclass(frozen=True)
class Grounds:
    """Grounds of a verdict on the best effect, or two effects, with the rivals not excluded.

    Attributes
    ----------
    delta_bic
        By how much it lowers the criterion, with errors as large as they may be.
    gain, gain_low
        Mean of what left-out tows gain, χ² per tow, and the lower end of its interval.
    share
        Part of the resampled trials in which it is the best.
    at_bound
        True if a value rests on the bound of what is possible.
    left_over, left_share
        Probability of what is left over, and its part of what is explained.
    rivals
        Effects that are not excluded and not of its class.
    noise
        Largest noise found over noise stated, with the effect.
    worse
        Quantities that it makes worse on what was kept back, beyond their errors.
    """

    delta_bic: float
    gain: float
    gain_low: float
    share: float
    at_bound: bool
    left_over: float
    left_share: float
    rivals: tuple[str, ...]
    noise: float = 1.0
    worse: tuple[str, ...] = ()


def leaves_too_much(left_over: float, left_share: float) -> bool:
    """True if residuals remain that the effect does not explain."""
    return left_over < FIT_AT_ALL or (left_over < FIT and left_share > LEFT_SHARE)


def judge(grounds: Grounds) -> tuple[Verdict, str]:
    """Judge whether the detected effect is named, with the reason."""
    if leaves_too_much(grounds.left_over, grounds.left_share):
        return 'UNKNOWN', (
            'what the best effect leaves over does not look like errors '
            f'(probability {grounds.left_over:.1g})'
        )
    if grounds.noise > NOISE_TO_EXPLAIN:
        return 'UNKNOWN', (
            f'with the best effect noise would have to be {grounds.noise:.1f} times what is stated'
        )
    if grounds.worse:
        listed = ' and '.join(name.replace('_', ' ') for name in grounds.worse)
        return 'AMBIGUOUS' if grounds.rivals else 'UNKNOWN', (
            f'on what was kept back the best effect makes {listed} worse than the boards alone, '
            'beyond what errors explain'
        )
    if grounds.rivals:
        return 'AMBIGUOUS', f'{", ".join(grounds.rivals)} would explain it nearly as well'
    if grounds.at_bound:
        return 'UNKNOWN', 'the best effect would have to be stronger than is possible'
    if grounds.delta_bic <= 0.0 or grounds.gain <= 0.0:
        return 'UNKNOWN', 'the best effect does not help to predict what was left out'
    if grounds.delta_bic < LEAST_BIC:
        return 'AMBIGUOUS', (
            f'the evidence is too weak to name it: with errors {DOUBT:g} times as large it lowers '
            f'BIC by {grounds.delta_bic:.1f} only'
        )
    if grounds.gain_low <= 0.0:
        return 'AMBIGUOUS', (
            'the evidence is too weak to name it: not all that was left out is predicted better'
        )
    if grounds.share < LEAST_SHARE:
        return 'AMBIGUOUS', (
            f'in {1.0 - grounds.share:.0%} of the resampled trials another effect is the best'
        )
    return 'NAMED', 'it alone explains what was seen, and predicts what was left out'


def judge_form(words: str) -> tuple[Verdict, str]:
    """Judge an effect of which a change of the gear file, which explains more, is another form.

    Parameters
    ----------
    words
        The change in words.
    """
    return 'AMBIGUOUS', f'another form of it explains more: {words}'


def judge_beside(verdict: Verdict, reason: str, mimics: Mapping[str, float]) -> tuple[Verdict, str]:
    """Judge an effect that the other rules let be named, or not excluded, beside its mimics.

    Parameters
    ----------
    verdict, reason
        By the other rules.
    mimics
        Changes of gear file or instruments that explain as much and are another thing, in words,
        with the BIC by which they explain more than the effect.
    """
    better = [words for words, over in mimics.items() if over > LEAST_BIC]
    if better:
        return 'UNKNOWN', f'another cause explains it better: {"; or ".join(better)}'
    if not mimics:
        return verdict, reason
    beside = f'it may as well be something else: {"; or ".join(mimics)}'
    return 'AMBIGUOUS', beside if verdict == 'NAMED' else f'{reason}; and {beside}'
