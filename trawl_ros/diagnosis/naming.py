"""Naming of an effect: refits of the best candidates, their comparison, and the verdict."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.diagnosis.candidates import Candidate, extended
from trawl_ros.diagnosis.refit import OPTIONS, Refit, likelier, refit
from trawl_ros.diagnosis.rules import (
    BOUND_SHARE,
    LEAST_BIC,
    LEFT_SHARE,
    NEARLY_ALIKE,
    RIVAL,
    SCREEN,
    SCREEN_SHARE,
    SCREENED,
    Grounds,
    Verdict,
    judge,
)
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.diagnosis.weighing import LeftOver, Weighed, left_over, twins, weigh
from trawl_ros.diagnosis.worsening import worsened
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.relinearise import with_those_of
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.solver.predict import Predictor

REFITTING = replace(OPTIONS, iterations_final=10, halvings=2)
"""Options of a refit, which starts near to where it comes to rest."""

PAIR, THREE = 2, 3
"""Effects at once; more than three are not looked for."""

SECONDS = 2
"""So many are tried beside the best where there are effects like it."""


@dataclass(frozen=True)
class Named:
    """Result of the naming.

    Attributes
    ----------
    verdict, reason
        And why.
    weighed
        Those that were refitted, best first; two or three effects at once stand first.
    alike
        Effects that no such data can part from the best.
    rivals
        Effects that are not excluded.
    left_over
        Residuals beyond their errors after the best.
    lost
        Windows that have no steady state with what was the best to first order: then nothing was
        weighed, and they are better left out.
    """

    verdict: Verdict
    reason: str
    weighed: tuple[Weighed, ...]
    alike: tuple[str, ...]
    rivals: tuple[str, ...]
    left_over: LeftOver
    lost: frozenset[int] = frozenset()


def name(
    predictor: Predictor,
    base: Refit,
    test: ScoreTest,
    kept_back: Sequence[SteadyWindow] = (),
    on_progress: OnProgress = ignore,
) -> Named:
    """Name the detected effect, or say why it cannot be named.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    base
        Boards alone.
    test
        Result of the score test.
    kept_back
        Windows that decided nothing so far, on which the best effect is to make nothing worse.
    on_progress
        Called before each refit.
    """
    ranked = sorted(test.wanted, key=test.penalised, reverse=True)
    first = test.penalised(ranked[0])
    chosen: list[Candidate] = []
    for candidate in ranked:
        again = any(other.name == candidate.name for other in chosen)
        near = test.penalised(candidate) > min(first - SCREEN, SCREEN_SHARE * first)
        if near and not again:
            chosen.append(candidate)
    refits = []
    for candidate in chosen[:SCREENED]:
        on_progress(_refitting(candidate.name))
        fitted = _refitted(predictor, base, test, (candidate,), REFITTING)
        lost = _lost(base, fitted)
        if fitted is not None and not lost:
            refits.append(fitted)
        elif candidate is chosen[0] and len(lost) <= OPTIONS.set_aside * len(base.fit.windows):
            return _without_states(lost)
    if not refits:
        return _without_states(frozenset())
    weighed = _possible_first(weigh(base, test, refits))
    best = weighed[0]
    left = left_over(base, test, best.refit)
    if seconds := _seconds(test, weighed, left):
        weighed, left = _with_second(predictor, base, test, refits, weighed, seconds, on_progress)
        best = weighed[0]
    alike = _not_told_apart(test, weighed)
    rivals = _rivals(test, weighed)
    grounds = Grounds(
        delta_bic=best.doubted_bic,
        gain=best.gain[0],
        gain_low=best.gain[1],
        share=best.share,
        at_bound=best.refit.at_bound(),
        left_over=left.probability,
        left_share=left.share,
        rivals=rivals,
        noise=max(best.refit.fit.scales),
        worse=worsened(predictor, base, best.refit, kept_back),
    )
    verdict, reason = judge(grounds)
    if verdict == 'AMBIGUOUS':
        # None is excluded that is the best in a twentieth of the resampled trials.
        rivals = tuple(dict.fromkeys((*rivals, *best.others)))
    return Named(verdict, reason, weighed, alike, rivals, left)


def _possible_first(weighed: tuple[Weighed, ...]) -> tuple[Weighed, ...]:
    """Effects in order, those on a bound behind one that does nearly as well."""
    best = weighed[0]
    if not best.refit.at_bound():
        return weighed
    for other in weighed[1:]:
        near = best.delta_bic - other.delta_bic < BOUND_SHARE * best.delta_bic
        if near and not other.refit.at_bound():
            return (other, *(entry for entry in weighed if entry is not other))
    return weighed


def _rivals(test: ScoreTest, weighed: Sequence[Weighed]) -> tuple[str, ...]:
    """Effects that are not excluded and not of the class of the best."""
    best = weighed[0]
    taken = {*best.refit.names, *_not_told_apart(test, weighed)}
    return tuple(
        other.refit.names[0]
        for other in weighed[1:]
        if best.delta_bic - other.delta_bic < RIVAL
        and other.refit.names[0] not in taken
        and not other.refit.at_bound()
    )


def _not_told_apart(test: ScoreTest, weighed: Sequence[Weighed]) -> tuple[str, ...]:
    """Effects of the best one's class; none that was refitted and explains much less, for what is
    alike to first order may need a size that is not possible.
    """
    best = weighed[0]
    told = {
        other.refit.names[0]
        for other in weighed[1:]
        if best.delta_bic - other.delta_bic > _to_be_there(best)
    }
    return tuple(name for name in twins(test, best.refit) if name not in told)


def _near(test: ScoreTest, weighed: Sequence[Weighed]) -> frozenset[str]:
    """Names of effects nearly as good as the best, or nearly the same: both may be present."""
    refitted_too = {name for other in weighed[1:] for name in other.refit.names}
    alike = refitted_too.intersection(twins(test, weighed[0].refit, NEARLY_ALIKE))
    return frozenset({*_rivals(test, weighed), *alike})


def _of_one_instrument(test: ScoreTest, best: Weighed) -> frozenset[str]:
    """Other errors of the instrument whose error is the best: one seldom comes without them."""
    (first,) = best.refit.wanted
    own = first.effect.instrument
    return frozenset(
        candidate.name for candidate in test.wanted if own and candidate.effect.instrument == own
    ) - {first.name}


def _seconds(test: ScoreTest, weighed: Sequence[Weighed], left: LeftOver) -> tuple[Candidate, ...]:
    """Candidates for a second effect beside the best.

    Some of its rivals, or else of all effects, that explain most of what is left over; and other
    errors of its instrument.
    """
    best = weighed[0]
    (first,) = best.refit.wanted
    rest = test.evidence.without(test.block(first))
    others = [candidate for candidate in test.wanted if candidate.name != first.name]
    others.sort(key=lambda candidate: test.penalised(candidate, rest), reverse=True)
    near, own = _near(test, weighed), _of_one_instrument(test, best)
    # Residuals of the best in the direction of its like are seen badly to first order.
    chosen = _once(candidate for candidate in others if candidate.name in near)[:SECONDS]
    if left.too_much or not chosen:
        chosen += tuple(
            candidate
            for candidate in others[:1]
            if left.too_much or test.penalised(candidate, rest) > _to_be_there(best)
        )
    return _once([*chosen, *(candidate for candidate in others if candidate.name in own)])


def _once(wanted: Iterable[Candidate]) -> tuple[Candidate, ...]:
    """First candidate of each effect."""
    first: dict[str, Candidate] = {}
    for candidate in wanted:
        first.setdefault(candidate.name, candidate)
    return tuple(first.values())


def _to_be_there(best: Weighed) -> float:
    """Required decrease of the criterion by a second effect: less is the best's other form."""
    return max(LEAST_BIC, LEFT_SHARE * best.delta_chi2)


def refitted(
    predictor: Predictor,
    base: Refit,
    test: ScoreTest,
    wanted: Sequence[Candidate],
    options: EstimatorOptions | None = None,
) -> Refit | None:
    """Refit boards and effects together, from their first-order values.

    With ``options``, or those of a refit. None where a state that was towed has no steady state
    then: that explains nothing.
    """
    fitted = _refitted(predictor, base, test, wanted, options or REFITTING)
    return None if _lost(base, fitted) else fitted


def _lost(base: Refit, fitted: Refit | None) -> frozenset[int]:
    """Windows that have a steady state with the boards alone, and none in a refit."""
    if fitted is None:
        return frozenset(linear.window.index for linear in base.fit.windows)
    return frozenset(window.index for window in with_those_of(base.fit, fitted.fit)[1])


def _without_states(lost: frozenset[int]) -> Named:
    reason = 'no effect leads to a gear with steady states'
    return Named('UNKNOWN', reason, (), (), (), LeftOver(0.0, 1.0), lost)


def _refitted(
    predictor: Predictor,
    base: Refit,
    test: ScoreTest,
    wanted: Sequence[Candidate],
    options: EstimatorOptions,
) -> Refit | None:
    """Refit as `refitted`, with the remaining windows where some have lost their steady state."""
    rows = [place for candidate in wanted for place in test.block(candidate)]
    columns = [own[:, rows] for own in test.columns]
    windows = extended(base.fit, wanted, columns, base.fit.options).windows
    scale = np.concatenate([candidate.scale for candidate in wanted])
    starts = np.concatenate([candidate.start for candidate in wanted])
    values = starts + scale * test.evidence.values(rows)
    best: Refit | None = None
    # First order may lead astray: then from where there is nothing but the boards.
    for start in (values, starts):
        best = likelier(best, refit(predictor, base.fit, wanted, start, windows, options))
        if (
            best is not None
            and not _lost(base, best)
            and best.fit.negative_log_likelihood < base.fit.negative_log_likelihood
        ):
            break
    return best


def _refitting(names: str) -> WorkProgress:
    return WorkProgress('diagnosing', detail=f'refitting with {names}')


def _with_second(
    predictor: Predictor,
    base: Refit,
    test: ScoreTest,
    refits: Sequence[Refit],
    weighed: tuple[Weighed, ...],
    seconds: Sequence[Candidate],
    on_progress: OnProgress,
) -> tuple[tuple[Weighed, ...], LeftOver]:
    """Weigh the best effect together with a second, and perhaps a third, and those alone; with
    the residuals of what then stands first.
    """
    (first,) = weighed[0].refit.wanted
    more = []
    for second in seconds:
        if second.name not in [fitted.names[0] for fitted in refits]:
            on_progress(_refitting(second.name))
            more.append(refitted(predictor, base, test, (second,)))
        on_progress(_refitting(f'{first.name} and {second.name}'))
        more.append(refitted(predictor, base, test, (first, second)))
    tried = [*refits, *(fitted for fitted in more if fitted is not None)]
    reweighed = _possible_first(weigh(base, test, tried))
    pair, alone = _of_number(reweighed, PAIR), _alone(reweighed)
    if pair is not None and pair.delta_bic > _least(test, weighed[0], pair, alone[0]):
        tried += _exchanged(predictor, base, test, pair.refit)
        pair = _of_number(weigh(base, test, tried), PAIR)
        assert pair is not None
        with_both = left_over(base, test, pair.refit)
        if third := _third(test, pair, with_both):
            on_progress(_refitting(' and '.join((*pair.refit.names, third.name))))
            fitted = refitted(predictor, base, test, (*pair.refit.wanted, third))
            if found := _with_third(predictor, base, test, tried, pair, fitted):
                return found
        if not with_both.too_much:
            return (pair, *alone), with_both
    return alone, left_over(base, test, alone[0].refit)


def _exchanged(predictor: Predictor, base: Refit, test: ScoreTest, several: Refit) -> list[Refit]:
    """Refit with one of several effects exchanged, where to first order another explains more.

    The first effect alone may have been what two that are there look like together.
    """
    gains = []
    for own in several.wanted:
        others = [other for other in several.wanted if other is not own]
        rest = test.evidence.without([place for other in others for place in test.block(other)])
        rivals = [rival for rival in test.wanted if rival.name not in several.names]
        rival = max(rivals, key=lambda candidate: test.penalised(candidate, rest))
        gain = test.penalised(rival, rest) - test.penalised(own, rest)
        gains.append((gain, (*others, rival)))
    gain, wanted = max(gains, key=lambda entry: entry[0])
    fitted = refitted(predictor, base, test, wanted) if gain > 0.0 else None
    return [] if fitted is None else [fitted]


def _least(test: ScoreTest, first: Weighed, pair: Weighed, alone: Weighed) -> float:
    """Criterion that a pair must exceed."""
    alike = {*twins(test, first.refit, NEARLY_ALIKE), *_of_one_instrument(test, first)}
    more = LEAST_BIC if pair.refit.names[1] in alike else _to_be_there(alone)
    return more + alone.delta_bic


def _third(test: ScoreTest, pair: Weighed, left: LeftOver) -> Candidate | None:
    """Candidate for a third effect: what explains most of what two leave over, if that is much."""
    rest = test.evidence.without([p for own in pair.refit.wanted for p in test.block(own)])
    others = [candidate for candidate in test.wanted if candidate.name not in pair.refit.names]
    best = max(others, key=lambda candidate: test.penalised(candidate, rest))
    enough = left.too_much or test.penalised(best, rest) > _to_be_there(pair)
    return best if enough else None


def _with_third(
    predictor: Predictor,
    base: Refit,
    test: ScoreTest,
    tried: Sequence[Refit],
    pair: Weighed,
    fitted: Refit | None,
) -> tuple[tuple[Weighed, ...], LeftOver] | None:
    """Three effects at once before each alone, with their residuals; None if two are enough."""
    if fitted is None:
        return None
    exchanged = _exchanged(predictor, base, test, fitted)
    reweighed = weigh(base, test, [*tried, fitted, *exchanged])
    three = _of_number(reweighed, THREE)
    (two,) = [entry for entry in reweighed if entry.refit is pair.refit]
    assert three is not None
    left = left_over(base, test, three.refit)
    if left.too_much or three.delta_bic <= two.delta_bic + _to_be_there(two):
        return None
    return (three, *_alone(_possible_first(reweighed))), left


def _of_number(weighed: Sequence[Weighed], number: int) -> Weighed | None:
    """Best of those that are so many effects at once."""
    return next((entry for entry in weighed if len(entry.refit.wanted) == number), None)


def _alone(weighed: Sequence[Weighed]) -> tuple[Weighed, ...]:
    """Effects that were refitted alone."""
    return tuple(entry for entry in weighed if len(entry.refit.wanted) < PAIR)
