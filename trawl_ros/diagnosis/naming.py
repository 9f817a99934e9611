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
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.relinearise import with_those_of
from trawl_ros.solver.predict import Predictor

REFITTING = replace(OPTIONS, iterations_final=10, halvings=2)
"""Options of a refit, which starts near to where it comes to rest."""

PAIR = 2
"""Effects at once, at most."""

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
        Those that were refitted, best first; of two effects at once the pair stands first.
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
    seen: ScoreTest,
    on_progress: OnProgress = ignore,
) -> Named:
    """Name the detected effect, or say why it cannot be named.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    base
        Boards alone.
    seen
        Result of the score test.
    on_progress
        Called before each refit.
    """
    ranked = sorted(seen.wanted, key=seen.penalised, reverse=True)
    first = seen.penalised(ranked[0])
    chosen: list[Candidate] = []
    for candidate in ranked:
        again = any(other.name == candidate.name for other in chosen)
        near = seen.penalised(candidate) > min(first - SCREEN, SCREEN_SHARE * first)
        if near and not again:
            chosen.append(candidate)
    refits = []
    for candidate in chosen[:SCREENED]:
        on_progress(_refitting(candidate.name))
        found = _refitted(predictor, base, seen, (candidate,), REFITTING)
        lost = _lost(base, found)
        if found is not None and not lost:
            refits.append(found)
        elif candidate is chosen[0] and len(lost) <= OPTIONS.set_aside * len(base.fit.windows):
            return _without_states(lost)
    if not refits:
        return _without_states(frozenset())
    weighed = _possible_first(weigh(base, seen, refits))
    best = weighed[0]
    left = left_over(base, seen, best.refit)
    if seconds := _seconds(seen, weighed, left):
        weighed, left = _with_second(predictor, base, seen, refits, weighed, seconds, on_progress)
        best = weighed[0]
    alike = twins(seen, best.refit)
    rivals = _rivals(seen, weighed)
    grounds = Grounds(
        delta_bic=best.doubted_bic,
        gain_low=best.gain[1],
        share=best.share,
        at_bound=best.refit.at_bound(),
        left_over=left.probability,
        left_share=left.share,
        rivals=rivals,
        noise=max(best.refit.fit.scales),
    )
    verdict, reason = judge(grounds)
    if verdict == 'AMBIGUOUS':
        # None is excluded that is the best in some of the resampled trials.
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
            return (other, *(one for one in weighed if one is not other))
    return weighed


def _rivals(seen: ScoreTest, weighed: Sequence[Weighed]) -> tuple[str, ...]:
    """Effects that are not excluded and not of the class of the best."""
    best = weighed[0]
    taken = {*best.refit.names, *twins(seen, best.refit)}
    return tuple(
        other.refit.names[0]
        for other in weighed[1:]
        if best.delta_bic - other.delta_bic < RIVAL
        and other.refit.names[0] not in taken
        and not other.refit.at_bound()
    )


def _near(seen: ScoreTest, weighed: Sequence[Weighed]) -> frozenset[str]:
    """Names of effects nearly as good as the best, or nearly the same: both may be present."""
    refitted_too = {name for other in weighed[1:] for name in other.refit.names}
    alike = refitted_too.intersection(twins(seen, weighed[0].refit, NEARLY_ALIKE))
    return frozenset({*_rivals(seen, weighed), *alike})


def _of_one_instrument(seen: ScoreTest, best: Weighed) -> frozenset[str]:
    """Other errors of the instrument whose error is the best: one seldom comes without them."""
    (first,) = best.refit.wanted
    own = first.effect.instrument
    return frozenset(one.name for one in seen.wanted if own and one.effect.instrument == own) - {
        first.name
    }


def _seconds(seen: ScoreTest, weighed: Sequence[Weighed], left: LeftOver) -> tuple[Candidate, ...]:
    """Candidates for a second effect beside the best.

    Some of its rivals, or else of all effects, that explain most of what is left over; and other
    errors of its instrument.
    """
    best = weighed[0]
    (first,) = best.refit.wanted
    rest = seen.evidence.without(seen.block(first))
    others = [one for one in seen.wanted if one.name != first.name]
    others.sort(key=lambda one: seen.penalised(one, rest), reverse=True)
    near, own = _near(seen, weighed), _of_one_instrument(seen, best)
    # Residuals of the best in the direction of its like are seen badly to first order.
    chosen = _once(one for one in others if one.name in near)[:SECONDS]
    if not chosen:
        chosen = tuple(
            one
            for one in others[:1]
            if left.too_much or seen.penalised(one, rest) > _to_be_there(best)
        )
    return _once([*chosen, *(one for one in others if one.name in own)])


def _once(found: Iterable[Candidate]) -> tuple[Candidate, ...]:
    """First candidate of each effect."""
    first: dict[str, Candidate] = {}
    for one in found:
        first.setdefault(one.name, one)
    return tuple(first.values())


def _to_be_there(best: Weighed) -> float:
    """Required decrease of the criterion by a second effect: less is the best's other form."""
    return max(LEAST_BIC, LEFT_SHARE * best.delta_chi2)


def refitted(
    predictor: Predictor,
    base: Refit,
    seen: ScoreTest,
    wanted: Sequence[Candidate],
    options: EstimatorOptions | None = None,
) -> Refit | None:
    """Refit boards and effects together, from their first-order values.

    With ``options``, or those of a refit. None where a state that was towed has no steady state
    then: that explains nothing.
    """
    found = _refitted(predictor, base, seen, wanted, options or REFITTING)
    return None if _lost(base, found) else found


def _lost(base: Refit, found: Refit | None) -> frozenset[int]:
    """Windows that have a steady state with the boards alone, and none in a refit."""
    if found is None:
        return frozenset(part.window.index for part in base.fit.windows)
    return frozenset(window.index for window in with_those_of(base.fit, found.fit)[1])


def _without_states(lost: frozenset[int]) -> Named:
    reason = 'no effect leads to a gear with steady states'
    return Named('UNKNOWN', reason, (), (), (), LeftOver(0.0, 1.0), lost)


def _refitted(
    predictor: Predictor,
    base: Refit,
    seen: ScoreTest,
    wanted: Sequence[Candidate],
    options: EstimatorOptions,
) -> Refit | None:
    """Refit as `refitted`, with the remaining windows where some have lost their steady state."""
    rows = [place for candidate in wanted for place in seen.block(candidate)]
    columns = [own[:, rows] for own in seen.columns]
    parts = extended(base.fit, wanted, columns, base.fit.options).windows
    scale = np.concatenate([candidate.scale for candidate in wanted])
    starts = np.concatenate([candidate.start for candidate in wanted])
    values = starts + scale * seen.evidence.values(rows)
    best: Refit | None = None
    # First order may lead astray: then from where there is nothing but the boards.
    for start in (values, starts):
        best = likelier(best, refit(predictor, base.fit, wanted, start, parts, options))
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
    seen: ScoreTest,
    refits: Sequence[Refit],
    weighed: tuple[Weighed, ...],
    seconds: Sequence[Candidate],
    on_progress: OnProgress,
) -> tuple[tuple[Weighed, ...], LeftOver]:
    """Weigh the best effect together with a second, and that one alone; with their residuals."""
    (first,) = weighed[0].refit.wanted
    more = []
    for second in seconds:
        if second.name not in [one.names[0] for one in refits]:
            on_progress(_refitting(second.name))
            more.append(refitted(predictor, base, seen, (second,)))
        on_progress(_refitting(f'{first.name} and {second.name}'))
        more.append(refitted(predictor, base, seen, (first, second)))
    found = _possible_first(weigh(base, seen, [*refits, *(one for one in more if one is not None)]))
    pair = next((one for one in found if len(one.refit.wanted) == PAIR), None)
    alone = tuple(one for one in found if len(one.refit.wanted) < PAIR)
    if pair is not None:
        with_both = left_over(base, seen, pair.refit)
        alike = {
            *twins(seen, weighed[0].refit, NEARLY_ALIKE),
            *_of_one_instrument(seen, weighed[0]),
        }
        least = LEAST_BIC if pair.refit.names[1] in alike else _to_be_there(alone[0])
        if not with_both.too_much and pair.delta_bic > least + alone[0].delta_bic:
            return (pair, *alone), with_both
    return alone, left_over(base, seen, alone[0].refit)
