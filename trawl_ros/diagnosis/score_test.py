"""Screening by score tests: all effects and patterns beside the fit of the boards."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.candidates import (
    Candidate,
    candidates,
    extended,
    lower_edges,
    signatures,
    values_vector,
)
from trawl_ros.diagnosis.evidence import Evidence, detectable, evidence, threshold
from trawl_ros.diagnosis.patterns import ResidualPattern, patterns
from trawl_ros.diagnosis.rules import DOUBT, FALSE_ALARMS, NOISE_SEEN, NOISE_TO_EXPLAIN
from trawl_ros.effects.base.effect import Effect
from trawl_ros.estimation.fit.error_terms import TowErrors
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.gauss_newton import gauss_newton_step
from trawl_ros.estimation.fit.nuisance import reweighted
from trawl_ros.estimation.fit.parameters import ParameterGroup, ParameterVector
from trawl_ros.solver.predict import Predictor

USUAL_PATTERN, FAR = 3.0, 1e3
"""Usual and largest size of a pattern where something is wrong, in std of a reading."""


@dataclass(frozen=True)
class ScoreTest:
    """Score tests of every candidate and every pattern.

    Attributes
    ----------
    fit
        Of the boards alone, with noise as it is where any of the effects may be there.
    weights
        Huber weights of its tows, likewise.
    wanted, columns
        The candidates, and what they change in each window.
    patterns, shapes
        The patterns, and the same of them.
    evidence
        For values of the candidates in `Candidate.scale`, and behind them sizes of the patterns.
    limit
        The `strength` that chance reaches in one of a hundred trials, in any of all blocks.
    """

    fit: Fit
    weights: tuple[FloatArray, ...]
    wanted: tuple[Candidate, ...]
    columns: tuple[FloatArray, ...]
    patterns: tuple[ResidualPattern, ...]
    shapes: tuple[FloatArray, ...]
    evidence: Evidence
    limit: float

    @property
    def units(self) -> FloatArray:
        """Units of all candidates' values."""
        return np.concatenate([candidate.scale for candidate in self.wanted])

    def block(self, candidate: Candidate) -> range:
        """Slice of a candidate's values."""
        for other, block in zip(self.wanted, self._blocks, strict=True):
            if other is candidate:
                return block
        raise ValueError(f'{candidate.name} is not among those that are wanted')

    @cached_property
    def _blocks(self) -> tuple[range, ...]:
        return values_vector(self.wanted).blocks('effect')

    @property
    def channels(self) -> Mapping[str, range]:
        """Slices of each channel's patterns."""
        return blocks_of(self.patterns, self.number)

    @property
    def number(self) -> int:
        """Number of all candidates' values."""
        return sum(len(candidate.start) for candidate in self.wanted)

    @property
    def readings(self) -> int:
        """Number of readings in all windows."""
        return sum(len(linear.channels) for linear in self.fit.windows)

    def strength(self, candidate: Candidate) -> float:
        """Strength of a candidate: of all its values together, or of the strongest alone."""
        looks = looks_at(self.block(candidate))
        return max(self.evidence.strength(look, DOUBT) for look in looks)

    @property
    def strongest(self) -> float:
        """Strength of the strongest candidate or pattern."""
        of_channels = [self.evidence.strength(block, DOUBT) for block in self.channels.values()]
        return max([self.strength(candidate) for candidate in self.wanted] + of_channels)

    @property
    def detected(self) -> bool:
        """True if something beyond the model is detected."""
        return self.strongest > self.limit or max(self.fit.scales) > NOISE_SEEN

    def detectable(self, candidate: Candidate) -> FloatArray:
        """Detectable departures (m,) from the candidate's start, each value alone."""
        return candidate.scale * detectable(self.evidence, self.block(candidate), self.limit, DOUBT)

    def penalised(self, candidate: Candidate, among: Evidence | None = None) -> float:
        """Decrease of the BIC (Bayesian information criterion) with a candidate, first order."""
        among = among or self.evidence
        block = self.block(candidate)
        penalty = among.degrees_of_freedom(block) * float(np.log(self.readings))
        return among.chi2(block) - penalty

    def resampled(self, tows: Sequence[int]) -> Evidence:
        """Evidence of tows chosen with replacement, by their place (bootstrap)."""
        errors: list[TowErrors] = [self.fit.errors[tow] for tow in tows]
        weights = [self.weights[tow] for tow in tows]
        return evidence(self.fit, self.columns, self.units, tows=errors, weights=weights)

    def of_windows(self, rows: Sequence[int]) -> Evidence:
        """Evidence of some of the windows."""
        fit = replace(self.fit, windows=tuple(self.fit.windows[row] for row in rows))
        return evidence(fit, [self.columns[row] for row in rows], self.units)


def score_test(predictor: Predictor, base: Fit, effects: Mapping[str, Effect]) -> ScoreTest:
    """Screen all effects.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    base
        Fit of the boards alone, at rest.
    effects
        The catalogue.
    """
    depths = lower_edges(base.windows)
    wanted = candidates(effects, predictor, depths)
    columns = signatures(predictor, base.windows, wanted)
    shapes, of_shapes = patterns(base.windows)
    # Noise is what no effect explains: found with all of them free.
    free = extended(base, wanted, columns, base.options)
    explained = gauss_newton_step(
        replace(free, scales=base.scales), free.prior.low, free.prior.high
    )
    if max(explained.scales) > NOISE_TO_EXPLAIN:
        # Then it is no noise, but something that no effect knows: patterns are to have it.
        free = with_patterns(free, shapes, of_shapes)
        explained = gauss_newton_step(
            replace(free, scales=base.scales), free.prior.low, free.prior.high
        )
    weights = reweighted(explained.elimination, base.options.huber)
    fit = replace(base, scales=explained.scales)
    both = [np.hstack(pair) for pair in zip(columns, of_shapes, strict=True)]
    units = np.concatenate([*(candidate.scale for candidate in wanted), np.ones(len(shapes))])
    of_all = evidence(fit, both, units, weights=weights)
    number = len(units) - len(shapes)
    looks = [look for block in values_vector(wanted).blocks('effect') for look in looks_at(block)]
    limit = threshold(of_all, [*looks, *blocks_of(shapes, number).values()], FALSE_ALARMS)
    return ScoreTest(fit, weights, wanted, tuple(columns), shapes, tuple(of_shapes), of_all, limit)


def looks_at(block: range) -> list[range]:
    """A block, and each of its values alone: an effect of four parameters commonly has but one of
    them, and would have to be larger to be seen among four.
    """
    alone = [range(place, place + 1) for place in block]
    return [block, *alone] if len(block) > 1 else [block]


def with_patterns(
    fit: Fit, shapes: Sequence[ResidualPattern], columns: Sequence[FloatArray]
) -> Fit:
    """Fit with sizes of patterns appended to all else."""
    number = len(shapes)
    nothing, far = np.zeros(number), np.full(number, FAR)
    names = tuple(f'{pattern.channel} {pattern.shape}' for pattern in shapes)
    group = ParameterGroup('pattern', names, ('std',) * number)
    sizes = ParameterVector(nothing, np.full(number, USUAL_PATTERN), -far, far, (group,))
    return replace(
        fit,
        windows=tuple(
            linear.followed_by(nothing, own)
            for linear, own in zip(fit.windows, columns, strict=True)
        ),
        coefficients=np.concatenate((fit.coefficients, nothing)),
        prior=fit.prior.followed_by(sizes),
    )


def blocks_of(shapes: Sequence[ResidualPattern], first: int) -> dict[str, range]:
    """Slices of each channel's patterns, the first of all at ``first``."""
    blocks: dict[str, range] = {}
    for place, pattern in enumerate(shapes, first):
        begin = blocks[pattern.channel].start if pattern.channel in blocks else place
        blocks[pattern.channel] = range(begin, place + 1)
    return blocks
