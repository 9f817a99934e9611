"""Comparison of refitted effects by BIC, bootstrap gains and residual patterns."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.candidates import Candidate
from trawl_ros.diagnosis.evidence import Evidence, evidence
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.rules import (
    ALIKE,
    BOUND_SHARE,
    DOUBT,
    FEWEST_TOWS,
    FEWEST_UNITS,
    LEAST_BIC,
    LEFT_SHARE,
    OTHER_SHARE,
    RIVAL,
    SCREEN_SHARE,
    leaves_too_much,
)
from trawl_ros.diagnosis.score_test import ScoreTest, blocks_of

DRAWS = 100
"""Number of bootstrap draws of the tows, or of the noise."""

CONFIDENCE = 0.95
GAIN_DRAWS = 2000


@dataclass(frozen=True)
class Weighed:
    """Comparison of one effect, or two, with the others.

    Attributes
    ----------
    refit
        With all windows solved anew.
    delta_chi2, delta_bic
        By how much it lowers both against the boards alone, with one noise for all.
    doubted_bic
        The second with all errors `DOUBT` times as large.
    gains
        Gain of each left-out unit by it, χ².
    share
        Part of resampled trials in which it is the best, or one of its class, or what few tows
        exclude.
    others
        Best candidates of the others, those of a twentieth of the trials or more.
    cosine
        The largest with any other effect that is not of its class.
    """

    refit: Refit
    delta_chi2: float
    delta_bic: float
    doubted_bic: float
    gains: FloatArray
    share: float
    others: tuple[str, ...]
    cosine: float

    @property
    def gain(self) -> tuple[float, float, float]:
        """Mean gain of a unit and the bounds of its interval."""
        number = len(self.gains)
        drawn = np.random.default_rng(0).integers(number, size=(GAIN_DRAWS, number))
        # Gains are far from normal: a unit that excites the effect gains most of all.
        means = self.gains[drawn].mean(axis=1)
        low, high = np.quantile(means, (0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE))
        return float(self.gains.mean()), float(low), float(high)


@dataclass(frozen=True)
class LeftOver:
    """Residual pattern beside an effect: its probability, and its share of the χ² explained."""

    probability: float
    share: float

    @property
    def too_much(self) -> bool:
        """True if there must be more than the effect."""
        return leaves_too_much(self.probability, self.share)


def weigh(base: Refit, test: ScoreTest, refits: Sequence[Refit]) -> tuple[Weighed, ...]:
    """Weigh all refits at one noise scale, best first."""
    likeliest = min(refits, key=lambda refit: refit.fit.negative_log_likelihood)
    scales = likeliest.fit.scales
    before = base.cost(scales)
    penalty = float(np.log(test.readings))
    deltas = [2.0 * (before - refit.cost(scales)) for refit in refits]
    criteria = [delta - refit.number * penalty for delta, refit in zip(deltas, refits, strict=True)]
    gains, bests = _resampled(test, refits, criteria)
    if len(test.fit.errors) >= FEWEST_UNITS:
        gains = [
            gain if _promised(test, refit, criterion) else _gains_of(base, refit, scales)
            for gain, refit, criterion in zip(gains, refits, criteria, strict=True)
        ]
    behind = _far_behind(test, refits, criteria)
    classes = [
        {*refit.names, *twins(test, refit), *others}
        for refit, others in zip(refits, behind, strict=True)
    ]
    entries = [
        Weighed(
            refit=refit,
            delta_chi2=delta,
            delta_bic=criterion,
            doubted_bic=criterion - delta * (1.0 - 1.0 / DOUBT**2),
            gains=gain,
            share=float(np.mean([name in alike for name in bests])),
            others=tuple(
                name
                for name in dict.fromkeys(bests)
                if name not in alike and bests.count(name) >= OTHER_SHARE * len(bests)
            ),
            cosine=_nearest(test, refit),
        )
        for refit, delta, criterion, gain, alike in zip(
            refits, deltas, criteria, gains, classes, strict=True
        )
    ]
    return tuple(sorted(entries, key=lambda entry: entry.delta_bic, reverse=True))


def _promised(test: ScoreTest, refit: Refit, criterion: float) -> bool:
    """True if first order promises a refit half of what it comes to; sensors on each other's doors
    may look like nothing where boards that are fitted to them have become unequal.
    """
    return penalised_together(test, refit.wanted) >= SCREEN_SHARE * criterion


def _gains_of(base: Refit, refit: Refit, scales: tuple[float, ...]) -> FloatArray:
    """Gain of each tow by a refit, as it is solved."""
    before, after = (
        np.array([tow.cost for tow in replace(own.fit, scales=scales).elimination.tows])
        for own in (base, refit)
    )
    gains: FloatArray = 2.0 * (before - after)
    return gains


def _far_behind(
    test: ScoreTest, refits: Sequence[Refit], criteria: Sequence[float]
) -> list[frozenset[str]]:
    """Effects that are worse than each by `LEAST_BIC`, all refitted.

    Where it is noise that is drawn anew, that of the data counts twice: it does not bring back what
    the data themselves exclude. Tows that are drawn anew have errors of the model too.
    """
    if len(test.fit.errors) >= FEWEST_TOWS:
        return [frozenset()] * len(refits)
    return [
        frozenset(
            other.names[0]
            for other, its in zip(refits, criteria, strict=True)
            if len(other.names) == 1 and its < criterion - LEAST_BIC
        )
        for criterion in criteria
    ]


def _resampled(
    test: ScoreTest, refits: Sequence[Refit], criteria: Sequence[float]
) -> tuple[list[FloatArray], list[str]]:
    """Bootstrap: gains of each unit left out, and the best effect of each trial drawn anew.

    Both to first order; ``criteria`` are what refits came to, by which the order is set right.
    """
    blocks = [[p for candidate in refit.wanted for p in test.block(candidate)] for refit in refits]
    number = len(test.fit.errors)
    if number >= FEWEST_UNITS:
        left_out = [
            test.resampled([other for other in range(number) if other != tow])
            for tow in range(number)
        ]
    else:
        states = [part.window.state for part in test.fit.windows]
        left_out = [
            test.of_windows([row for row, own in enumerate(states) if own != state])
            for state in dict.fromkeys(states)
        ]
    rng = np.random.default_rng(0)
    trials = [
        # Of few tows one may hold all the evidence there is: then it is noise that is drawn anew.
        test.resampled(rng.integers(number, size=number).tolist())
        if number >= FEWEST_TOWS
        else test.evidence.with_noise(rng)
        for _ in range(DRAWS)
    ]
    gains = [
        np.array([test.evidence.chi2(block) - rest.chi2(block) for rest in left_out])
        for block in blocks
    ]
    # First order counts the same noise as smaller, and the more so the more there is to explain.
    first = int(np.argmax(criteria))
    if not _promised(test, refits[first], criteria[first]):
        # By how much is told by one that first order knows.
        first = int(np.argmax([penalised_together(test, refit.wanted) for refit in refits]))
    scale = max(criteria[first], 0.0) / max(penalised_together(test, refits[first].wanted), 1.0)
    corrections = {
        refit.names[0]: criterion - scale * penalised_together(test, refit.wanted)
        for refit, criterion in zip(refits, criteria, strict=True)
        if len(refit.wanted) == 1
    }

    def best(trial: Evidence) -> str:
        return max(
            test.wanted,
            key=lambda candidate: (
                scale * test.penalised(candidate, trial) + corrections.get(candidate.name, 0.0)
            ),
        ).name

    return gains, [best(trial) for trial in trials]


def penalised_together(test: ScoreTest, wanted: Sequence[Candidate]) -> float:
    """Decrease of BIC with candidates together, to first order."""
    block = [place for candidate in wanted for place in test.block(candidate)]
    freedom = test.evidence.degrees_of_freedom(block)
    return test.evidence.chi2(block) - freedom * float(np.log(test.readings))


def twins(test: ScoreTest, refit: Refit, alike: float = ALIKE) -> tuple[str, ...]:
    """Names of effects whose signatures have at least this cosine with the refitted one's."""
    return like_any(test, refit, alike) if len(refit.wanted) == 1 else ()


def like_any(test: ScoreTest, refit: Refit, alike: float = ALIKE) -> tuple[str, ...]:
    """Names of effects whose signatures have this cosine with one of those refitted, by itself."""
    return tuple(
        dict.fromkeys(
            other.name
            for candidate in refit.wanted
            for other in test.wanted
            if other.name not in refit.names and _cosine(test, refit, (candidate,), other) > alike
        )
    )


def _cosine(test: ScoreTest, refit: Refit, own: Sequence[Candidate], other: Candidate) -> float:
    """Cosine of the signature of some of the refitted effects with another's."""
    places = zip(refit.wanted, refit.fit.prior.blocks('effect'), strict=True)
    values = [
        (refit.estimate.values[list(block)] - candidate.start) / candidate.scale
        for candidate, block in places
        if any(candidate is one for one in own)
    ]
    rows = [place for candidate in own for place in test.block(candidate)]
    return test.evidence.covered(rows, np.concatenate(values), test.block(other))


def _nearest(test: ScoreTest, refit: Refit) -> float:
    others = [other for other in test.wanted if other.name not in refit.names]
    return max((_cosine(test, refit, refit.wanted, other) for other in others), default=0.0)


def possible_first(weighed: tuple[Weighed, ...]) -> tuple[Weighed, ...]:
    """Effects in order, those on a bound behind one that does nearly as well, and behind all others
    those of which only a part would be there.
    """
    weighed = tuple(sorted(weighed, key=lambda entry: entry.refit.in_part()))
    best = weighed[0]
    if not best.refit.at_bound():
        return weighed
    for other in weighed[1:]:
        near = best.delta_bic - other.delta_bic < BOUND_SHARE * best.delta_bic
        if near and not other.refit.at_bound():
            return (other, *(entry for entry in weighed if entry is not other))
    return weighed


def rivals_of_best(test: ScoreTest, weighed: Sequence[Weighed]) -> tuple[str, ...]:
    """Effects that are not excluded, alone or among several.

    Those of the class of the best are held against it by the values that earn their place: what
    looks the same in these tows is not told apart by how many values it has.
    """
    best = weighed[0]
    of_class = frozenset(like_any(test, best.refit))
    least = sparing(test, best.refit, best.delta_chi2) - RIVAL
    rivals = []
    for other in weighed[1:]:
        new = [name for name in other.refit.names if name not in best.refit.names]
        if other.refit.at_bound() or other.refit.in_part():
            continue
        if new and of_class.issuperset(new):
            if sparing(test, other.refit, other.delta_chi2) > least:
                rivals += new
        elif best.delta_bic - other.delta_bic < RIVAL:
            rivals += [name for name in new if name not in of_class]
    return tuple(dict.fromkeys(rivals))


def not_told_apart(test: ScoreTest, weighed: Sequence[Weighed]) -> tuple[str, ...]:
    """Effects of the best one's class; none that was refitted and explains much less, for what is
    alike to first order may need a size that is not possible.
    """
    best = weighed[0]
    told = {
        other.refit.names[0]
        for other in weighed[1:]
        if best.delta_bic - other.delta_bic > to_be_there(best)
    }
    return tuple(name for name in twins(test, best.refit) if name not in told)


def sparing(test: ScoreTest, refit: Refit, explained: float) -> float:
    """Decrease of BIC by those values of a refit that earn their place.

    Boards that are turned about one axis are named with all three angles; a change of the gear
    file, which has one size, would stand ahead of them for that alone. What each choice of the
    values lacks of the χ² that all of them explain is found to first order. Values of an effect
    that was searched from several starts all count: one of them was chosen with the start.

    Parameters
    ----------
    test
        Has the refitted effects.
    refit
        The refit.
    explained
        χ² that all of its values explain.
    """
    block = block_of(test, refit)
    names = [candidate.name for candidate in test.wanted]
    chosen = {
        place
        for candidate in refit.wanted
        if names.count(candidate.name) > 1
        for place in test.block(candidate)
    }
    whole, penalty = test.evidence.chi2(block), float(np.log(test.readings))
    return max(
        explained
        - (whole - test.evidence.chi2(some))
        - max(test.evidence.degrees_of_freedom(some), len(chosen)) * penalty
        for number in range(1, len(block) + 1)
        for some in combinations(block, number)
        if chosen <= set(some)
    )


def block_of(test: ScoreTest, refit: Refit) -> list[int]:
    """Places of the values of all effects of a refit."""
    return [place for candidate in refit.wanted for place in test.block(candidate)]


def to_be_there(best: Weighed) -> float:
    """Required decrease of the criterion by one more effect: less is the best's other form."""
    return max(LEAST_BIC, LEFT_SHARE * best.delta_chi2)


def left_over(base: Refit, test: ScoreTest, refit: Refit) -> LeftOver:
    """Test of the residual patterns of the most improbable channel beside a refit, with all errors
    `DOUBT` times as large: calibration and model are not known better here than where something is
    detected.

    Parameters
    ----------
    base
        The boards alone.
    test
        The score test, whose noise and patterns are used.
    refit
        The refit.
    """
    effects = refit.fit.prior.slice_of('effect')
    fit = replace(refit.fit, scales=test.fit.scales)
    # The same windows in the same order: a refit that loses one is none.
    columns = [
        np.hstack((linear.by_coefficients[:, effects], own))
        for linear, own in zip(fit.windows, test.shapes, strict=True)
    ]
    number = refit.number
    units = np.concatenate((fit.prior.std[effects], np.ones(len(test.patterns))))
    of_patterns = evidence(fit, columns, units).without(range(number))
    blocks = blocks_of(test.patterns, number).values()
    worst = max(blocks, key=lambda block: of_patterns.strength(block, DOUBT))
    explained = 2.0 * (base.cost(fit.scales) - refit.cost(fit.scales))
    return LeftOver(
        probability=min(1.0, len(blocks) * 10.0 ** -of_patterns.strength(worst, DOUBT)),
        share=of_patterns.chi2(worst) / max(explained, 1.0),
    )
