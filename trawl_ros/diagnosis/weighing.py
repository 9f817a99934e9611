"""Comparison of refitted effects by BIC, bootstrap gains and residual patterns."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.candidates import Candidate
from trawl_ros.diagnosis.evidence import Evidence, evidence
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.rules import ALIKE, DOUBT, FEWEST_TOWS, FEWEST_UNITS, leaves_too_much
from trawl_ros.diagnosis.score_test import ScoreTest, blocks_of

DRAWS = 100
"""Number of bootstrap draws of the tows."""

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
        Part of resampled trials in which it is the best, or one of its class.
    others
        Best candidates of the others.
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


def weigh(base: Refit, seen: ScoreTest, refits: Sequence[Refit]) -> tuple[Weighed, ...]:
    """Weigh all refits at one noise scale, best first."""
    likeliest = min(refits, key=lambda one: one.fit.negative_log_likelihood)
    scales = likeliest.fit.scales
    before = base.cost(scales)
    penalty = float(np.log(seen.readings))
    deltas = [2.0 * (before - one.cost(scales)) for one in refits]
    criteria = [delta - one.number * penalty for delta, one in zip(deltas, refits, strict=True)]
    gains, bests = _resampled(seen, refits, criteria)
    classes = [{*one.names, *twins(seen, one)} for one in refits]
    found = [
        Weighed(
            refit=one,
            delta_chi2=delta,
            delta_bic=criterion,
            doubted_bic=criterion - delta * (1.0 - 1.0 / DOUBT**2),
            gains=gain,
            share=float(np.mean([name in alike for name in bests])),
            others=tuple(dict.fromkeys(name for name in bests if name not in alike)),
            cosine=_nearest(seen, one),
        )
        for one, delta, criterion, gain, alike in zip(
            refits, deltas, criteria, gains, classes, strict=True
        )
    ]
    return tuple(sorted(found, key=lambda one: one.delta_bic, reverse=True))


def _resampled(
    seen: ScoreTest, refits: Sequence[Refit], criteria: Sequence[float]
) -> tuple[list[FloatArray], list[str]]:
    """Bootstrap: gains of each unit left out, and the best effect of each resampled trial.

    Both to first order; ``criteria`` are what refits came to, by which the order is set right.
    """
    blocks = [[p for candidate in one.wanted for p in seen.block(candidate)] for one in refits]
    number = len(seen.fit.errors)
    if number >= FEWEST_UNITS:
        left_out = [
            seen.resampled([other for other in range(number) if other != tow])
            for tow in range(number)
        ]
    else:
        states = [part.window.state for part in seen.fit.windows]
        left_out = [
            seen.of_windows([row for row, own in enumerate(states) if own != state])
            for state in dict.fromkeys(states)
        ]
    trials = left_out
    if number >= FEWEST_TOWS:
        chance = np.random.default_rng(0)
        trials = [
            seen.resampled(chance.integers(number, size=number).tolist()) for _ in range(DRAWS)
        ]
    gains = [
        np.array([seen.evidence.chi2(block) - part.chi2(block) for part in left_out])
        for block in blocks
    ]
    # First order counts the same noise as smaller, and the more so the more there is to explain.
    first = int(np.argmax(criteria))
    scale = max(criteria[first], 0.0) / max(_penalised(seen, refits[first].wanted), 1.0)
    corrections = {
        one.names[0]: criterion - scale * _penalised(seen, one.wanted)
        for one, criterion in zip(refits, criteria, strict=True)
        if len(one.wanted) == 1
    }

    def best(part: Evidence) -> str:
        return max(
            seen.wanted,
            key=lambda one: scale * seen.penalised(one, part) + corrections.get(one.name, 0.0),
        ).name

    return gains, [best(part) for part in trials]


def _penalised(seen: ScoreTest, wanted: Sequence[Candidate]) -> float:
    """Decrease of BIC with candidates together, to first order."""
    block = [place for candidate in wanted for place in seen.block(candidate)]
    freedom = seen.evidence.degrees_of_freedom(block)
    return seen.evidence.chi2(block) - freedom * float(np.log(seen.readings))


def twins(seen: ScoreTest, one: Refit, alike: float = ALIKE) -> tuple[str, ...]:
    """Names of effects whose signatures have at least this cosine with the refitted one's."""
    if len(one.wanted) != 1:
        return ()
    (candidate,) = one.wanted
    return tuple(
        dict.fromkeys(
            other.name
            for other in seen.wanted
            if other.name != candidate.name and _cosine(seen, one, other) > alike
        )
    )


def _cosine(seen: ScoreTest, one: Refit, other: Candidate) -> float:
    """Cosine of the refitted effect's signature with another's."""
    rows = [place for candidate in one.wanted for place in seen.block(candidate)]
    starts = np.concatenate([candidate.start for candidate in one.wanted])
    scale = np.concatenate([candidate.scale for candidate in one.wanted])
    values = (one.values - starts) / scale
    return seen.evidence.covered(rows, values, seen.block(other))


def _nearest(seen: ScoreTest, one: Refit) -> float:
    others = [other for other in seen.wanted if other.name not in one.names]
    return max((_cosine(seen, one, other) for other in others), default=0.0)


def left_over(base: Refit, seen: ScoreTest, one: Refit) -> LeftOver:
    """Test of the residual patterns of the most improbable channel beside a refit.

    Parameters
    ----------
    base
        The boards alone.
    seen
        The first look, whose noise and patterns are used.
    one
        The refit.
    """
    effects = one.fit.prior.slice_of('effect')
    fit = replace(one.fit, scales=seen.fit.scales)
    # The same windows in the same order: a refit that loses one is none.
    columns = [
        np.hstack((part.by_coefficients[:, effects], own))
        for part, own in zip(fit.windows, seen.shapes, strict=True)
    ]
    number = one.number
    units = np.concatenate((fit.prior.std[effects], np.ones(len(seen.patterns))))
    found = evidence(fit, columns, units).without(range(number))
    blocks = blocks_of(seen.patterns, number).values()
    worst = max(blocks, key=found.strength)
    explained = 2.0 * (base.cost(fit.scales) - one.cost(fit.scales))
    return LeftOver(
        probability=min(1.0, len(blocks) * 10.0 ** -found.strength(worst)),
        share=found.chi2(worst) / max(explained, 1.0),
    )
