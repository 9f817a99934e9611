"""Diagnosis of a gear: detect, locate, name, repair, and compare on held-out windows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.diagnosis.changes import changes
from trawl_ros.diagnosis.empirical import Empirical, empirical
from trawl_ros.diagnosis.fit_beside import fit_beside
from trawl_ros.diagnosis.holdout import HoldoutErrors, Split, errors, split
from trawl_ros.diagnosis.instruments import over_ground, wrong_unit
from trawl_ros.diagnosis.locating import Where, telling
from trawl_ros.diagnosis.naming import REFITTING, Named, name, refitted
from trawl_ros.diagnosis.next_tow import Proposal, propose
from trawl_ros.diagnosis.refit import Refit, fit_boards, was_in_order
from trawl_ros.diagnosis.rules import FEWEST_STATES, NEAR, NOWHERE_NEAR, Verdict
from trawl_ros.diagnosis.score_test import ScoreTest, score_test
from trawl_ros.diagnosis.weighing import Weighed
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

PLACEBO_STEPS = 3
"""A wrong effect has no place to come to rest at, and what it is worth is seen before."""


@dataclass(frozen=True)
class HoldoutComparison:
    """Hold-out comparison: errors without, with the effect, and with the best wrong one
    (``placebo``, whose name is ``instead``).
    """

    before: HoldoutErrors
    after: HoldoutErrors | None
    placebo: HoldoutErrors | None
    instead: str | None

    @property
    def removed(self) -> float | None:
        """Share of the excess error that the effect removes; None where there is none."""
        return _removed(self.before, self.after)

    @property
    def removed_by_placebo(self) -> float | None:
        """Share of the excess error that the best wrong effect removes."""
        return _removed(self.before, self.placebo)


@dataclass(frozen=True)
class Diagnosis:
    """Diagnosis of a gear.

    Attributes
    ----------
    verdict, reason
        And why.
    gear
        As it was believed.
    tows
        Their names.
    baseline
        Those in which nothing was looked for.
    split
        Windows that decided, and those kept back.
    base, seen, named, where, shown
        Boards alone; first look; naming; patterns and jumps of residuals; errors on what was kept
        back. None, or empty, where it did not come to that.
    remarks
        On instruments that need no model to be seen at fault.
    checks, proposals
        Next steps where something cannot be told apart: without towing, in sentences, and
        tows.
    empirical
        The term that explains what no effect does, where there is one.

    Examples
    --------
    >>> import trawl_ros
    >>> diagnosis = trawl_ros.diagnose(['tow_1'], gear='coarse.yaml')
    >>> diagnosis.tows, diagnosis.named is None
    (('tow_1',), True)
    """

    verdict: Verdict
    reason: str
    gear: GearRecord
    tows: tuple[str, ...]
    baseline: frozenset[int]
    split: Split
    base: Refit | None = None
    seen: ScoreTest | None = None
    named: Named | None = None
    where: tuple[Where, ...] = ()
    shown: HoldoutComparison | None = None
    remarks: tuple[str, ...] = ()
    checks: tuple[str, ...] = ()
    proposals: tuple[Proposal, ...] = ()
    empirical: Empirical | None = None

    @property
    def best(self) -> Weighed | None:
        """The best effect, or two, where something was detected and refitted."""
        return self.named.weighed[0] if self.named and self.named.weighed else None

    @property
    def added(self) -> Weighed | None:
        """Addition to the boards' refit: an empirical term, or else the best effect."""
        return self.best if self.empirical is None else self.empirical.weighed

    @property
    def added_as(self) -> str:
        """Designation of the addition in sentences."""
        return 'the effect' if self.empirical is None else 'the empirical term'

    @property
    def repair(self) -> Weighed | None:
        """Repair of the gear: the effect that is named, or an empirical term."""
        return self.added if self.empirical or self.verdict == 'NAMED' else None


def diagnose(
    gear: GearRecord,
    windows: Sequence[SteadyWindow],
    tows: Sequence[str],
    baseline: frozenset[int] = frozenset(),
    on_progress: OnProgress = ignore,
) -> Diagnosis:
    """Diagnose the missing effects of a gear's model.

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
    parts = split(windows, baseline)
    model = build_model(gear)
    # Effects found by an earlier diagnosis are those that the gear in order did not have.
    new = frozenset(effect.name for effect in gear.effects if effect.provenance is not None)
    predictor = Predictor(model, effects_of(gear), without=baseline, new=new)
    known = Diagnosis(
        'NOT_TESTABLE', '', gear, tuple(tows), baseline, parts, remarks=over_ground(windows, tows)
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
    base = fit(predictor, prior, parts.deciding)
    if base is None or len(base.fit.windows) < 0.5 * len(parts.deciding):
        return replace(
            known,
            reason=wrong_unit(predictor, prior, parts.deciding)
            or 'most of the windows have no steady state in this model: it is another gear, or far '
            'from how it was towed',
        )
    on_progress(_step('looking for effects'))
    seen = score_test(predictor, base.fit, catalogue())
    where = sorted((*telling(seen), *changes(seen)), key=lambda one: -abs(one.z))
    known = replace(known, base=base, seen=seen, where=tuple(where))
    if not seen.detected:
        return replace(
            known,
            verdict='NO_DISCREPANCY',
            reason='nothing in the readings is beyond what boards and errors explain',
            shown=_shown(predictor, base, None, None, parts),
        )
    named = name(predictor, base, seen, on_progress)
    if named.lost:
        on_progress(_step('leaving out what has no steady state with the best effect'))
        kept = tuple(window for window in parts.deciding if window.index not in named.lost)
        if (again := fit(predictor, prior, kept)) is not None:
            base, seen = again, score_test(predictor, again.fit, catalogue())
            known = replace(known, base=base, seen=seen)
            named = name(predictor, base, seen, on_progress)
    best = named.weighed[0].refit if named.weighed else None
    other, found = None, None
    if named.verdict == 'UNKNOWN':
        on_progress(_step('looking for an empirical term'))
        found = empirical(predictor, base, seen)
        if found is not None:
            other, best = best, found.weighed.refit
        noise, left = (float(np.median(one.fit.scales)) for one in (base, best or base))
        nowhere_near = noise > NOWHERE_NEAR and left > NEAR
        if nowhere_near and not was_in_order(predictor, prior, parts.deciding, baseline):
            return replace(
                known,
                reason=wrong_unit(predictor, prior, parts.deciding)
                or f'readings are {noise:.0f} times further from the model than their errors '
                'explain, and no effect brings them near: it is another gear',
            )
    on_progress(_step('predicting what was kept back'))
    if best is not None and other is None:
        other = _placebo(predictor, base, seen, named)
    shown = _shown(predictor, base, best, other, parts)
    on_progress(_step('looking for the next tow'))
    checks, proposals = _advice(predictor, seen, named)
    return replace(
        known,
        verdict=named.verdict,
        reason=named.reason,
        named=named,
        shown=shown,
        checks=checks,
        proposals=proposals,
        empirical=found,
    )


def unread(gear: GearRecord, tows: Sequence[str], reason: str) -> Diagnosis:
    """The diagnosis of recordings without a single steady window."""
    nothing = Split((), (), 'state')
    return Diagnosis('NOT_TESTABLE', reason, gear, tuple(tows), frozenset(), nothing)


def _step(detail: str) -> WorkProgress:
    return WorkProgress('diagnosing', detail=detail)


def _advice(
    predictor: Predictor, seen: ScoreTest, named: Named
) -> tuple[tuple[str, ...], tuple[Proposal, ...]]:
    """Direct checks and tows that separate the best effect from those not excluded."""
    others = {*named.rivals, *named.alike}
    if not named.weighed or not others:
        return (), ()
    best = named.weighed[0].refit
    rivals = [one for one in seen.wanted if one.name in others]
    candidate = best.wanted[0]
    values = best.values[: len(candidate.start)]
    proposals = propose(predictor, seen, candidate, values, rivals)
    direct = [one.effect.direct for one in (*best.wanted, *rivals) if one.effect.direct]
    return tuple(dict.fromkeys(direct)), proposals


def _placebo(predictor: Predictor, base: Refit, seen: ScoreTest, named: Named) -> Refit | None:
    """Placebo: the best effect that is neither named nor of its class.

    Where none is named, only one that was refitted already will do.
    """
    if not named.weighed:
        return None
    taken = {*named.weighed[0].refit.names, *named.alike}
    for other in named.weighed[1:]:
        if not taken & set(other.refit.names):
            return other.refit
    rest = [one for one in seen.wanted if one.name not in taken]
    if not rest or named.verdict == 'UNKNOWN':
        return None
    options = replace(REFITTING, iterations_final=PLACEBO_STEPS)
    return refitted(predictor, base, seen, (max(rest, key=seen.penalised),), options)


def _shown(
    predictor: Predictor,
    base: Refit,
    best: Refit | None,
    other: Refit | None,
    parts: Split,
) -> HoldoutComparison | None:
    if not parts.showing:
        return None

    there = [one for one in (base, best, other) if one is not None]
    free = [
        replace(predictor, free=tuple(candidate.effect for candidate in one.wanted))
        for one in there
    ]
    found = iter(errors(list(zip(free, there, strict=True)), parts.showing))
    return HoldoutComparison(
        before=next(found),
        after=None if best is None else next(found),
        placebo=None if other is None else next(found),
        instead=None if other is None else other.names[0],
    )


def _removed(before: HoldoutErrors, after: HoldoutErrors | None) -> float | None:
    # In the same units: a gear with an effect may feel errors of warp lengths more.
    was = before.excess(before.expected)
    if after is None or was <= 0.0:
        return None
    return 1.0 - after.excess(before.expected) / was


def values_of(one: Refit) -> Mapping[str, Mapping[str, tuple[float, float, float, str]]]:
    """Effect → parameter → value, both ends of its interval, and unit."""
    found: dict[str, dict[str, tuple[float, float, float, str]]] = {}
    estimate = one.estimate
    for candidate, block in zip(one.wanted, one.fit.prior.blocks('effect'), strict=True):
        own = found.setdefault(candidate.name, {})
        for parameter, place in zip(candidate.effect.parameters, block, strict=True):
            numbers = (estimate.values[place], estimate.low[place], estimate.high[place])
            value, low, high = map(float, numbers)
            own[parameter.name] = (value, low, high, parameter.unit)
    return found
