"""Evidence held against the library of mimics: to first order, and the likeliest in full."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.diagnosis.candidates import Candidate, candidates, lower_edges, signatures
from trawl_ros.diagnosis.evidence import evidence
from trawl_ros.diagnosis.mimics.change import Change
from trawl_ros.diagnosis.mimics.drift import drifts
from trawl_ros.diagnosis.mimics.gear_file_change import GearFileChange, changes_of
from trawl_ros.diagnosis.refit import Refit, refitted, told
from trawl_ros.diagnosis.rules import (
    LEAST_BIC,
    MIMIC_SCREEN_SHARE,
    MIMICS_NAMED,
    MIMICS_SOLVED,
    MIMICS_TRIED,
    RIVAL,
    SCREEN,
    SCREEN_SHARE,
)
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.diagnosis.weighing import Weighed, block_of, left_over, sparing
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.solver.predict import Predictor


@dataclass(frozen=True)
class Mimic:
    """Mimic: a change of gear file or instrument that explains what was seen as an effect does.

    Attributes
    ----------
    change
        Of the gear file, or of an instrument.
    refit
        Of boards and change together, all windows solved anew.
    delta_chi2, delta_bic
        By how much it lowers both against the boards alone, with the noise beside the effect.
    over
        By how much more than the effect it lowers the second, uncommon sizes counted against both.
    alike
        Less likely ones that are the same thing in the catalogue's words.
    """

    change: Change
    refit: Refit
    delta_chi2: float
    delta_bic: float
    over: float
    alike: 'tuple[Mimic, ...]' = ()

    @property
    def interval(self) -> tuple[float, float, float]:
        """Size, and both ends of its interval."""
        estimate = self.refit.estimate
        place = self.refit.fit.prior.slice_of('effect').start
        value, low, high = (own[place] for own in (estimate.values, estimate.low, estimate.high))
        return float(value), float(low), float(high)

    def __str__(self) -> str:
        words = self.change.words(self.interval[0])
        return f'{words} (or {"; or ".join(map(str, self.alike))})' if self.alike else words


def mimics_of(
    predictor: Predictor,
    base: Refit,
    test: ScoreTest,
    best: Weighed,
    *,
    others: Sequence[str] = (),
    better: bool = False,
    on_progress: OnProgress = ignore,
) -> tuple[Mimic, ...]:
    """Changes of gear file or instruments that explain as much as an effect, the likeliest first.

    Changes that are the same thing as the effect, or as one that is not excluded beside it, are
    none, unless `better` ones are looked for; but what is the same as one of several may do alone
    what all of them do. Uncommon sizes count against either, as the squares of their standard
    deviations.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    base
        Boards alone.
    test
        Result of the score test.
    best
        The effect, or two.
    others
        Effects that are not excluded beside it.
    better
        True for changes that explain by `LEAST_BIC` more than the effect.
    on_progress
        Called before each refit.
    """
    known = () if better else _in_other_words(best, others)
    changes: list[Change] = [
        change
        for change in (*changes_of(predictor.model.gear), *drifts())
        if not set(known) & set(change.same_as)
    ]
    predictor = _ready_for(predictor, changes)
    terms = _screened(predictor, base, test, changes)
    scales = best.refit.fit.scales
    penalty = float(np.log(test.readings))
    before = base.cost(scales)
    explained = sparing(test, best.refit, 2.0 * (before - best.refit.cost(scales)))
    explained -= _uncommon(best.refit)
    least = LEAST_BIC if better else -RIVAL
    found: list[Mimic] = []
    for candidate in _likeliest(test, terms, best, better=better):
        on_progress(told(candidate.name))
        try:
            fitted = refitted(predictor, base, terms, (candidate,))
        except GearError:
            # A net that cannot be cut so is not the one that was towed.
            continue
        # A change as large as is possible makes a name doubtful, and is no explanation by itself.
        if fitted is None or (better and fitted.at_bound()):
            continue
        delta = 2.0 * (before - fitted.cost(scales))
        criterion = delta - fitted.number * penalty
        over = criterion - _uncommon(fitted) - explained
        if over > least and not left_over(base, test, fitted).too_much:
            change = next(own for own in changes if own.name == candidate.name)
            found.append(Mimic(change, fitted, delta, criterion, over))
        if len(found) == MIMICS_NAMED:
            break
    return _by_kind(sorted(found, key=lambda mimic: -mimic.delta_bic))


def _in_other_words(best: Weighed, others: Sequence[str]) -> tuple[str, ...]:
    """Effects of which a change that is the same thing makes no name doubtful: the best one where
    it is alone, and those that are not excluded beside it.
    """
    return (*(best.refit.names if len(best.refit.names) == 1 else ()), *others)


def _by_kind(found: Sequence[Mimic]) -> tuple[Mimic, ...]:
    """Mimics with those behind the likeliest of a kind that are the same thing as it."""
    first: list[Mimic] = []
    for mimic in found:
        for place, other in enumerate(first):
            if set(mimic.change.same_as) & set(other.change.same_as):
                first[place] = replace(other, alike=(*other.alike, mimic))
                break
        else:
            first.append(mimic)
    return tuple(first)


def in_another_form(
    weighed: Sequence[Weighed], mimics: Sequence[Mimic]
) -> tuple[Weighed, Mimic] | None:
    """Effect of which a change of the gear file that explains far more than the best is another
    form, and the change; None where another change comes near.

    What the catalogue has in one form, less drag of all netting, has many on deck: another twine of
    some of it.
    """
    if not mimics:
        return None
    first, *rest = sorted(mimics, key=lambda mimic: -mimic.over)
    alone = all(first.over - other.over > RIVAL for other in rest)
    if not (first.change.keys and first.over > LEAST_BIC and alone):
        return None
    for entry in weighed:
        if len(entry.refit.wanted) == 1 and entry.refit.names[0] in first.change.same_as:
            return entry, first
    return None


def with_mimics(
    predictor: Predictor, test: ScoreTest, mimics: Sequence[Mimic]
) -> tuple[Predictor, ScoreTest]:
    """Gear and score test with mimics behind the effects of the catalogue."""
    predictor = _ready_for(predictor, [mimic.change for mimic in mimics])
    wanted = tuple(mimic.refit.wanted[0] for mimic in mimics)
    more = signatures(predictor, test.fit.windows, wanted)
    columns = tuple(np.hstack(pair) for pair in zip(test.columns, more, strict=True))
    both = replace(test, wanted=(*test.wanted, *wanted), columns=columns)
    return predictor, replace(both, evidence=evidence(both.fit, columns, both.units))


def _ready_for(predictor: Predictor, changes: Sequence[Change]) -> Predictor:
    """Gear that can be changed: a change of the gear file builds the whole gear, on which all
    effects of the gear file act.
    """
    neutral = tuple(
        ActiveEffect(change, change.neutral)
        for change in changes
        if isinstance(change, GearFileChange)
    )
    return replace(predictor, fixed=EffectSet((*neutral, *predictor.fixed.effects)))


def _screened(
    predictor: Predictor, base: Refit, test: ScoreTest, changes: Sequence[Change]
) -> ScoreTest:
    """Score test with the changes in place of the catalogue."""
    depths = lower_edges(base.fit.windows)
    wanted = candidates({change.name: change for change in changes}, predictor, depths)
    columns = tuple(signatures(predictor, base.fit.windows, wanted))
    units = np.concatenate([candidate.scale for candidate in wanted])
    own = evidence(test.fit, columns, units, weights=test.weights)
    return replace(test, wanted=wanted, columns=columns, evidence=own)


def _likeliest(
    test: ScoreTest, terms: ScoreTest, best: Weighed, *, better: bool
) -> tuple[Candidate, ...]:
    """Changes to be solved in full: nearly as likely to first order, of sizes near what happens."""
    first = sparing(test, best.refit, test.evidence.chi2(block_of(test, best.refit)))
    near = first if better else min(first - SCREEN, MIMIC_SCREEN_SHARE * first)
    far = first if better else SCREEN_SHARE * first
    # By what first order missed of the effect it may miss of a change of the gear too.
    missed = abs(sparing(test, best.refit, best.delta_chi2) - first)
    near_of_gear = near if better else max(far, min(near, first - missed))
    chosen = []
    for candidate in terms.wanted:
        sizes = candidate.scale * terms.evidence.values(terms.block(candidate))
        # First order may be wrong by half.
        if all(
            1.5 * parameter.low <= size <= 1.5 * parameter.high
            for parameter, size in zip(candidate.effect.parameters, sizes, strict=True)
        ):
            chosen.append((terms.penalised(candidate), candidate))
    ranked = sorted(chosen, key=lambda own: own[0], reverse=True)
    # A slack rope is far from first order, an instrument is not.
    of_gear = [own for _, own in ranked if isinstance(own.effect, GearFileChange)]

    def least(candidate: Candidate) -> float:
        if candidate in of_gear[:MIMICS_TRIED]:
            return far
        return near_of_gear if candidate in of_gear else near

    return tuple(
        candidate for likely, candidate in ranked[:MIMICS_SOLVED] if likely > least(candidate)
    )


def _uncommon(refit: Refit) -> float:
    """Squares of the sizes of effects, in standard deviations of what is common."""
    start, scale = (
        np.concatenate([getattr(candidate, name) for candidate in refit.wanted])
        for name in ('start', 'scale')
    )
    return float(np.sum(((refit.values - start) / scale) ** 2))
