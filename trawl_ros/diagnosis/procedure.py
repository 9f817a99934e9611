"""Procedure of a diagnosis: detect, locate, name, repair, and compare on held-out windows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.diagnosis.changes import changes
from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.empirical import empirical
from trawl_ros.diagnosis.fit_beside import fit_beside
from trawl_ros.diagnosis.holdout import holdout_comparison, split
from trawl_ros.diagnosis.instruments import (
    frozen,
    over_ground,
    possible,
    standing,
    without,
    wrong_unit,
)
from trawl_ros.diagnosis.locating import telling
from trawl_ros.diagnosis.mimicry import Mimic, in_another_form, mimics_of, with_mimics
from trawl_ros.diagnosis.naming import Named, name
from trawl_ros.diagnosis.next_tow import Proposal, propose
from trawl_ros.diagnosis.refit import REFITTING, Refit, fit_boards, refitted, was_in_order
from trawl_ros.diagnosis.rules import (
    FEWEST_STATES,
    LEAST_BIC,
    NEAR,
    NOWHERE_NEAR,
    judge_beside,
    judge_form,
)
from trawl_ros.diagnosis.score_test import ScoreTest, score_test
from trawl_ros.diagnosis.weighing import Weighed, left_over
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

PLACEBO_STEPS = 3
"""A wrong effect has no place to come to rest at, and what it is worth is seen before."""


def diagnose_windows(
    gear: GearRecord,
    windows: Sequence[SteadyWindow],
    tows: Sequence[str],
    baseline: frozenset[int] = frozenset(),
    on_progress: OnProgress = ignore,
) -> Diagnosis:
    """Diagnose the missing effects of a gear's model from steady windows.

    Parameters
    ----------
    gear
        The gear as it is believed.
    windows
        Steady windows of all tows.
    tows
        Names of the tows.
    baseline
        Tows of when the gear was known to be in order.
    on_progress
        Called at each step of the diagnosis.

    Raises
    ------
    GearError
        If the gear file switches on an effect that there is not.
    """
    stuck = frozen(windows, tows)
    windows, fallen = standing(without(windows, stuck), tows)
    halves = split(windows, baseline)
    deciding, kept_back = halves.deciding, halves.kept_back
    model = build_model(gear)
    # Effects found by an earlier diagnosis are those that the gear in order did not have.
    new = frozenset(effect.name for effect in gear.effects if effect.provenance is not None)
    predictor = Predictor(model, effects_of(gear), without=baseline, new=new)
    remarks = (*over_ground(windows, tows), *(sensor.sentence for sensor in stuck), *fallen)
    known = Diagnosis(
        'NOT_TESTABLE', '', gear, tuple(tows), baseline, halves, remarks=remarks, frozen=stuck
    )
    examined = {window.state for window in windows if window.tow not in baseline}
    if len(examined) < FEWEST_STATES:
        return replace(
            known,
            reason=f'found {len(examined)} steady states to examine, expected at least '
            f'{FEWEST_STATES}: what does not vary cannot be told from the boards',
        )
    on_progress(_step('fitting the boards'))
    prior = board_prior(gear)
    fit = fit_beside if new else fit_boards
    base = fit(predictor, prior, deciding)
    if base is None or len(base.fit.windows) < 0.5 * len(deciding):
        return replace(
            known,
            reason=wrong_unit(predictor, prior, deciding)
            or 'most of the windows have no steady state in this model: it is another gear, or far '
            'from how it was towed',
        )
    on_progress(_step('looking for effects'))
    effects, ruled_out = possible(
        catalogue(), [window for window in windows if window.tow not in baseline]
    )
    known = replace(known, remarks=(*remarks, *ruled_out))
    test = score_test(predictor, base.fit, effects)
    where = sorted((*telling(test), *changes(test)), key=lambda located: -abs(located.z))
    known = replace(known, base=base, score_test=test, where=tuple(where))
    if not test.detected:
        return replace(
            known,
            verdict='NAMED' if stuck else 'NO_DISCREPANCY',
            reason=f'nothing in the {"other " if stuck else ""}readings is beyond what boards '
            'and errors explain',
            holdout=holdout_comparison(predictor, base, None, None, kept_back),
        )
    named = name(predictor, base, test, kept_back, on_progress)
    if named.lost:
        on_progress(_step('leaving out what has no steady state with the best effect'))
        remaining = tuple(window for window in deciding if window.index not in named.lost)
        if (again := fit(predictor, prior, remaining)) is not None:
            base, test = again, score_test(predictor, again.fit, effects)
            known = replace(known, base=base, score_test=test)
            named = name(predictor, base, test, kept_back, on_progress)
    named, mimics = _beside_mimics(predictor, base, test, named, on_progress)
    best = named.weighed[0].refit if named.weighed else None
    placebo, term = None, None
    if named.verdict == 'UNKNOWN':
        on_progress(_step('looking for an empirical term'))
        term = empirical(predictor, base, test)
        if term is not None:
            placebo, best = best, term.weighed.refit
        noise, left = (float(np.median(refit.fit.scales)) for refit in (base, best or base))
        nowhere_near = noise > NOWHERE_NEAR and left > NEAR
        if nowhere_near and not was_in_order(predictor, prior, deciding, baseline):
            return replace(
                known,
                reason=wrong_unit(predictor, prior, deciding)
                or f'readings are {noise:.0f} times further from the model than their errors '
                'explain, and no effect brings them near: it is another gear',
            )
    on_progress(_step('predicting what was kept back'))
    if best is not None and placebo is None:
        placebo = _placebo(predictor, base, test, named)
    comparison = holdout_comparison(predictor, base, best, placebo, kept_back)
    on_progress(_step('looking for the next tow'))
    checks, proposals = _advice(predictor, test, named, mimics)
    return replace(
        known,
        verdict=named.verdict,
        reason=named.reason,
        named=named,
        holdout=comparison,
        checks=checks,
        proposals=proposals,
        empirical=term,
        mimics=mimics,
    )


def _beside_mimics(
    predictor: Predictor, base: Refit, test: ScoreTest, named: Named, on_progress: OnProgress
) -> tuple[Named, tuple[Mimic, ...]]:
    """Hold a name against the library of mimics; without a name, look for what explains more."""
    if not named.weighed:
        return named, ()
    on_progress(_step('holding it against other causes'))
    unknown = named.verdict == 'UNKNOWN'
    mimics = mimics_of(
        predictor, base, test, named.weighed[0],
        others=(*named.rivals, *named.alike), better=unknown, on_progress=on_progress,
    )  # fmt: skip
    if (form := in_another_form(named.weighed, mimics)) is not None:
        return _as_form(base, test, named, *form)
    if unknown:
        return named, mimics
    words = {str(mimic): mimic.over for mimic in mimics}
    verdict, reason = judge_beside(named.verdict, named.reason, words)
    if verdict == 'UNKNOWN':
        mimics = tuple(mimic for mimic in mimics if mimic.over > LEAST_BIC)
    return replace(named, verdict=verdict, reason=reason), mimics


def _as_form(
    base: Refit, test: ScoreTest, named: Named, best: Weighed, form: Mimic
) -> tuple[Named, tuple[Mimic, ...]]:
    """Result with an effect first of which a change of the gear file is another form."""
    verdict, reason = judge_form(str(form))
    rest = tuple(entry for entry in named.weighed if entry is not best)
    left = left_over(base, test, best.refit)
    return Named(verdict, reason, (best, *rest), (), (), left), (form,)


def _step(detail: str) -> WorkProgress:
    return WorkProgress('diagnosing', detail=detail)


def _advice(
    predictor: Predictor, test: ScoreTest, named: Named, mimics: Sequence[Mimic]
) -> tuple[tuple[str, ...], tuple[Proposal, ...]]:
    """Direct checks and tows that separate the best effect from those not excluded, and from
    changes of gear file or instruments that explain as much.
    """
    others = {*named.rivals, *named.alike}
    beside = [
        mimic
        for mimic in (mimics if named.verdict == 'AMBIGUOUS' else ())
        if not set(named.weighed[0].refit.names) & set(mimic.change.same_as)
    ]
    if not named.weighed or not (others or beside):
        return (), ()
    best = named.weighed[0].refit
    rivals = [candidate for candidate in test.wanted if candidate.name in others]
    if beside:
        predictor, test = with_mimics(predictor, test, beside)
        rivals += [mimic.refit.wanted[0] for mimic in beside]
    candidate = best.wanted[0]
    values = best.values[: len(candidate.start)]
    proposals = propose(predictor, test, candidate, values, rivals)
    direct = [
        candidate.effect.direct for candidate in (*best.wanted, *rivals) if candidate.effect.direct
    ]
    return tuple(dict.fromkeys(direct)), proposals


def _placebo(predictor: Predictor, base: Refit, test: ScoreTest, named: Named) -> Refit | None:
    """Placebo: the best effect that is neither named nor of its class.

    Where none is named, only one that was refitted already will do.
    """
    if not named.weighed:
        return None
    taken = {*named.weighed[0].refit.names, *named.alike}
    for entry in named.weighed[1:]:
        if not taken & set(entry.refit.names):
            return entry.refit
    rest = [candidate for candidate in test.wanted if candidate.name not in taken]
    if not rest or named.verdict == 'UNKNOWN':
        return None
    options = replace(REFITTING, iterations_final=PLACEBO_STEPS)
    return refitted(predictor, base, test, (max(rest, key=test.penalised),), options, rounds=1)
