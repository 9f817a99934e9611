"""Naming of an effect: refits of the best candidates, their comparison, and the verdict."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.diagnosis.candidates import Candidate
from trawl_ros.diagnosis.refit import OPTIONS, Refit, lost_by, refitted_in_part, told
from trawl_ros.diagnosis.rules import SCREEN, SCREEN_SHARE, SCREENED, Grounds, Verdict, judge
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.diagnosis.several import SetsTried, several_at_once
from trawl_ros.diagnosis.weighing import (
    LeftOver,
    Weighed,
    not_told_apart,
    possible_first,
    rivals_of_best,
    weigh,
)
from trawl_ros.diagnosis.worsening import QuantityOnHoldout, on_holdout
from trawl_ros.estimation.fit.relinearise import with_those_of
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.solver.predict import Predictor


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
    held_out
        Each quantity on what was kept back, with the best beside the boards alone.
    """

    verdict: Verdict
    reason: str
    weighed: tuple[Weighed, ...]
    alike: tuple[str, ...]
    rivals: tuple[str, ...]
    left_over: LeftOver
    lost: frozenset[int] = frozenset()
    held_out: tuple[QuantityOnHoldout, ...] = ()


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
    refits: list[Refit] = []
    in_part: list[Refit] = []
    for candidate in chosen[:SCREENED]:
        on_progress(told(candidate.name))
        fitted = refitted_in_part(predictor, base, test, (candidate,))
        lost = lost_by(base, fitted)
        if fitted is None or len(lost) > OPTIONS.set_aside * len(base.fit.windows):
            continue
        (in_part if lost else refits).append(fitted)
    weighed = possible_first(weigh(base, test, refits)) if refits else ()
    if (likeliest := _likeliest_in_part(base, test, in_part, weighed)) is not None:
        return _without_states(lost_by(base, likeliest))
    if not weighed:
        return _without_states(frozenset())
    tried = SetsTried(predictor, base, test, refits, on_progress)
    tried.add_class_of(weighed[0])
    weighed = tried.weighed()
    weighed, left = several_at_once(tried, weighed, tried.left_by(weighed[0]))
    best = weighed[0]
    rivals = rivals_of_best(test, weighed)
    alike = tuple(name for name in not_told_apart(test, weighed) if name not in rivals)
    held_out = on_holdout(predictor, base, best.refit, kept_back)
    grounds = Grounds(
        delta_bic=best.doubted_bic,
        gain=best.gain[0],
        gain_low=best.gain[1],
        share=best.share,
        at_bound=best.refit.at_bound() or best.refit.in_part(),
        left_over=left.probability,
        left_share=left.share,
        rivals=rivals,
        noise=max(best.refit.fit.scales),
        worse=tuple(own.name for own in held_out if own.worse),
    )
    verdict, reason = judge(grounds)
    if verdict == 'AMBIGUOUS':
        # None is excluded that is the best in a twentieth of the resampled trials.
        rivals = tuple(dict.fromkeys((*rivals, *best.others)))
    return Named(verdict, reason, weighed, alike, rivals, left, held_out=held_out)


def _likeliest_in_part(
    base: Refit, test: ScoreTest, in_part: Sequence[Refit], weighed: Sequence[Weighed]
) -> Refit | None:
    """The likeliest of effects that lack a steady state in some windows; None where one that lacks
    none explains as much.

    What each explains is that of its own windows, at the noise of the one that leaves least over.
    """
    if not in_part:
        return None
    every = [*in_part, *(entry.refit for entry in weighed[:1])]
    scales = min(every, key=lambda own: float(np.median(own.fit.scales))).fit.scales

    def explained(own: Refit) -> float:
        before = replace(with_those_of(base.fit, own.fit)[0], scales=scales).cost
        return 2.0 * (before - own.cost(scales)) - own.number * float(np.log(test.readings))

    likeliest = max(every, key=explained)
    return likeliest if any(likeliest is own for own in in_part) else None


def _without_states(lost: frozenset[int]) -> Named:
    reason = 'no effect leads to a gear with steady states'
    return Named('UNKNOWN', reason, (), (), (), LeftOver(0.0, 1.0), lost)
