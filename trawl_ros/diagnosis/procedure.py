# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Procedure of a diagnosis: fit, screen, infer, decide, and compare on held-out windows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.diagnosis.diagnosis import BoardsMoved, Diagnosis
from trawl_ros.diagnosis.fit_beside import fit_beside
from trawl_ros.diagnosis.holdout import (
    HoldoutComparison,
    Split,
    holdout_comparison,
    split,
    without_kept_back,
)
from trawl_ros.diagnosis.inference.candidates import lower_edges
from trawl_ros.diagnosis.inference.decision import Decision, decide
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.posterior import Explanation, Posterior, infer
from trawl_ros.diagnosis.inference.refit import Refit, fit_boards, was_in_order
from trawl_ros.diagnosis.inference.screen import Screen, ready_for, screen
from trawl_ros.diagnosis.instruments import (
    frozen,
    over_ground,
    possible,
    standing,
    without,
    wrong_unit,
)
from trawl_ros.diagnosis.library.entries import library
from trawl_ros.diagnosis.locating import significant_patterns
from trawl_ros.diagnosis.next_tow import Proposal, propose
from trawl_ros.diagnosis.predictive_check import QuantityOnHoldout, on_holdout
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

MIN_STATES = 3
"""Smallest number of steady states that can be tested."""

OTHER_GEAR_NOISE, EXPLAINED_NOISE = 10.0, 3.0
"""Estimated over stated noise from which it is another gear, unless a cause brings it below the
second."""

MAX_RIVALS = 4
"""Largest number of causes that the next tow distinguishes from the likeliest."""


def diagnose_windows(
    gear: GearRecord,
    windows: Sequence[SteadyWindow],
    tows: Sequence[str],
    baseline: frozenset[int] = frozenset(),
    on_progress: OnProgress = ignore,
    options: InferenceOptions | None = None,
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
    options
        Options of the inference; the frozen ones if None.

    Raises
    ------
    GearError
        If the gear file switches on an effect that there is not.
    """
    options = options or InferenceOptions()
    stuck = frozen(windows, tows)
    windows, fallen = standing(without(windows, stuck), tows)
    halves = split(windows, baseline)
    model = build_model(gear)
    # Effects found by an earlier diagnosis are those that the gear in order did not have.
    new = frozenset(effect.name for effect in gear.effects if effect.provenance is not None)
    predictor = Predictor(model, effects_of(gear), without=baseline, new=new)
    remarks = (*over_ground(windows, tows), *(sensor.sentence for sensor in stuck), *fallen)
    known = Diagnosis(
        'NOT_TESTABLE', '', gear, tuple(tows), baseline, halves, remarks=remarks, frozen=stuck
    )
    examined = {window.state for window in windows if window.tow not in baseline}
    if len(examined) < MIN_STATES:
        return replace(
            known,
            reason=f'found {len(examined)} steady states to examine, expected at least '
            f'{MIN_STATES}: without variation no cause can be distinguished from the '
            'boards',
        )
    on_progress(_step('fitting the boards'))
    prior = board_prior(gear)
    fit = fit_beside if new else fit_boards
    base = fit(predictor, prior, windows)
    if base is None or len(base.fit.windows) < 0.5 * len(windows):
        return replace(
            known,
            reason=wrong_unit(predictor, prior, windows)
            or 'most of the windows have no steady state in this model: it is another gear, or far '
            'from how it was towed',
        )
    on_progress(_step('comparing hypotheses'))
    effects, ruled_out = possible(
        catalogue(), [window for window in windows if window.tow not in baseline]
    )
    entries = library(gear, effects)
    depths = lower_edges(base.fit.windows)
    seen = screen(predictor, base.fit, entries, depths, options.errors)
    posterior = infer(predictor, base, seen, options, on_progress)
    known = replace(
        known,
        remarks=(*remarks, *ruled_out),
        base=base,
        screen=seen,
        posterior=posterior,
        moved=_moved(predictor, base),
        where=significant_patterns(seen),
    )
    decision = decide(posterior, options)
    if decision.verdict == 'NO_DISCREPANCY':
        comparison = holdout_comparison(
            predictor, without_kept_back(base, halves), None, None, halves.kept_back
        )
        verdict = 'NAMED' if stuck else decision.verdict
        return replace(known, verdict=verdict, reason=decision.reason, holdout=comparison)
    # Noise is found by the fits, so that a misfit shows in it.
    noise, *others = (float(np.median(own.fit.scales)) for own in _refits(base, posterior))
    best = decision.best
    near = (
        min(others, default=noise) < EXPLAINED_NOISE
        and best is not None
        and len(best.suspects) == 1
    )
    if noise > OTHER_GEAR_NOISE and not (near or was_in_order(predictor, prior, windows, baseline)):
        return replace(
            known,
            reason=wrong_unit(predictor, prior, windows)
            or f'readings are {noise:.0f} times further from the model than their '
            'errors explain, and no single cause brings them near: it is another gear',
        )
    on_progress(_step('predicting what was kept back'))
    ready = ready_for(predictor, [entry.effect for entry in entries])
    comparison, held_out = _on_holdout(ready, base, posterior, best, halves, options)
    worse = [own.name for own in held_out if own.is_worse(options, len(held_out))]
    decision = decide(posterior, options, worse)
    checks, proposals = _advice(predictor, seen, posterior, decision, on_progress)
    return replace(
        known,
        verdict=decision.verdict,
        reason=decision.reason,
        named=decision.named,
        among=decision.among,
        best=best,
        holdout=comparison,
        held_out=held_out,
        checks=checks,
        proposals=proposals,
    )


def _step(detail: str) -> WorkProgress:
    return WorkProgress('diagnosing', detail=detail)


def _refits(base: Refit, posterior: Posterior) -> list[Refit]:
    return [base, *(own.refit for own in posterior.explanations if own.refit is not None)]


def _moved(predictor: Predictor, base: Refit) -> BoardsMoved:
    """Return how far the boards moved from the gear file, and what that changes."""
    board = base.fit.prior.slice_of('coefficients')
    away = base.fit.coefficients[board] - predictor.model.coefficients
    in_std = away / base.fit.prior.std[board]
    largest = int(np.argmax(np.abs(in_std)))
    changed: dict[str, list[float]] = {'spread': [], 'depth': []}
    for linear in base.fit.windows:
        change = linear.by_coefficients[:, board] @ away
        for name, own in zip(linear.channels, change, strict=True):
            if name == 'door_spread':
                changed['spread'].append(float(own))
            elif name.endswith('door_depth'):
                changed['depth'].append(float(own))
    spread, depth = (float(np.mean(own)) if own else 0.0 for own in changed.values())
    return BoardsMoved(float(in_std[largest]), base.fit.prior.names[board][largest], spread, depth)


def _on_holdout(
    predictor: Predictor,
    base: Refit,
    posterior: Posterior,
    best: Explanation | None,
    halves: Split,
    options: InferenceOptions,
) -> tuple[HoldoutComparison | None, tuple[QuantityOnHoldout, ...]]:
    """Compare the errors on the windows kept back, by channel and by quantity."""
    if not halves.kept_back:
        return None, ()
    placebo = _placebo(posterior, best)
    alone, repaired, other = (
        None if own is None else without_kept_back(own, halves)
        for own in (base, *(None if one is None else one.refit for one in (best, placebo)))
    )
    instead = None if placebo is None else ' and '.join(placebo.names)
    comparison = holdout_comparison(predictor, alone, repaired, other, halves.kept_back, instead)
    if alone is None or repaired is None:
        return comparison, ()
    return comparison, on_holdout(predictor, alone, repaired, halves.kept_back, options.errors)


def _placebo(posterior: Posterior, best: Explanation | None) -> Explanation | None:
    """Return the likeliest refitted explanation with none of the nodes of the best one."""
    if best is None:
        return None
    taken = {suspect.entry.node.path for suspect in best.suspects}
    for own in posterior.explanations:
        paths = {suspect.entry.node.path for suspect in own.suspects}
        if own.refit is not None and not own.unknown and not paths & taken:
            return own
    return None


def _advice(
    predictor: Predictor,
    seen: Screen,
    posterior: Posterior,
    decision: Decision,
    on_progress: OnProgress,
) -> tuple[tuple[str, ...], tuple[Proposal, ...]]:
    """Return checks on deck and tows that distinguish the likeliest cause from the others."""
    best = decision.best
    if best is None or best.refit is None or decision.verdict != 'AMBIGUOUS':
        return (), ()
    leaves = [name for name in posterior.leaves if name in decision.among]
    suspects = [posterior.entry(name) for name in leaves]
    checks = tuple(dict.fromkeys(suspect.entry.check for suspect in suspects))
    first = best.suspects[0]
    rivals = [own for own in suspects if own.entry.name not in best.names][:MAX_RIVALS]
    values = best.refit.values[: len(first.block)]
    on_progress(_step('looking for the next tow'))
    try:
        return checks, propose(predictor, seen, first, values, rivals)
    except GearError:
        # A gear that cannot be built so is none to be towed.
        return checks, ()
