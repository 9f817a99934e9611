# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Screen of all hypotheses to first order, from the fit of the boards alone."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.inference.blocks import ErrorSize, blocks_of
from trawl_ros.diagnosis.inference.candidates import Candidate, signatures
from trawl_ros.diagnosis.inference.marginal import Marginal, marginal
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.patterns import ResidualPattern, patterns
from trawl_ros.diagnosis.inference.variants import Variant, variants_of
from trawl_ros.diagnosis.library.entries import Entry
from trawl_ros.diagnosis.library.gear_file_change import GearFileChange
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.nuisance import reweighted
from trawl_ros.estimation.fit.parameters import ParameterGroup, ParameterVector
from trawl_ros.estimation.fit.window_search import most_likely
from trawl_ros.solver.predict import Predictor

USUAL_PATTERN, LARGEST_PATTERN = 3.0, 1e3
"""Usual and largest size of a pattern where something is wrong, in std of a reading."""

LARGEST_NOISE = 1.5
"""Largest noise over the noise stated: it is measured by the scatter of the readings themselves."""


@dataclass(frozen=True)
class Suspect:
    """Hypothesis with the values from which it is searched.

    Attributes
    ----------
    entry, candidate
        Entry of the library; its effect with a start.
    block
        Places of its values among those of all suspects.
    log_odds
        Logarithm of the prior odds.
    variants
        Which of its values differ, and by how much.
    """

    entry: Entry
    candidate: Candidate
    block: range
    log_odds: float
    variants: tuple[Variant, ...]


@dataclass(frozen=True)
class Screen:
    """Information of the tows on all hypotheses, to first order.

    Attributes
    ----------
    fit
        Of the boards alone, with noise as it is around any smooth function of the covariates.
    weights
        Huber weights of its tows, likewise.
    errors
        Size of errors that readings do not tell.
    suspects, columns
        The hypotheses, and what they change in each window per unit.
    patterns, shapes
        Patterns of residuals, and the same of them.
    marginal
        Of values of the suspects in their std, and behind them sizes of the patterns.
    """

    fit: Fit
    weights: tuple[FloatArray, ...]
    errors: ErrorSize
    suspects: tuple[Suspect, ...]
    columns: tuple[FloatArray, ...]
    patterns: tuple[ResidualPattern, ...]
    shapes: tuple[FloatArray, ...]
    marginal: Marginal = field(repr=False)

    @property
    def number(self) -> int:
        """Number of values of all suspects."""
        return sum(len(suspect.block) for suspect in self.suspects)

    def counted(self, fit: Fit) -> Fit:
        """Return another fit of the same windows with the noise of this one."""
        return replace(fit, scales=self.fit.scales, weights=None)


def ready_for(predictor: Predictor, effects: Sequence[object]) -> Predictor:
    """Return a gear whose file can be changed: such a change must act before all effects."""
    neutral = tuple(
        ActiveEffect(effect, effect.neutral)
        for effect in dict.fromkeys(effects)
        if isinstance(effect, GearFileChange)
    )
    return replace(predictor, fixed=EffectSet((*neutral, *predictor.fixed.effects)))


def screen(
    predictor: Predictor,
    base: Fit,
    entries: Sequence[Entry],
    depths: FloatArray,
    errors: ErrorSize,
) -> Screen:
    """Screen all hypotheses.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    base
        Converged fit of the boards alone.
    entries
        The library.
    depths
        Depths of the lower edge of the net's mouth in the tows at hand (n,), m.
    errors
        Size of errors that readings do not tell.
    """
    suspects: list[Suspect] = []
    first = 0
    for entry in entries:
        effect = entry.effect
        starts = effect.starts(depths)
        if any(active.name == effect.name for active in predictor.fixed.effects):
            starts = (predictor.fixed.of(effect).values,)
        for place, start in enumerate(starts):
            block = range(first, first + len(start))
            suspects.append(
                Suspect(
                    entry,
                    Candidate(effect, start, place),
                    block,
                    entry.log_odds - float(np.log(len(starts))),
                    variants_of(entry, start, alone=len(starts) == 1),
                )
            )
            first = block.stop
    wanted = tuple(suspect.candidate for suspect in suspects)
    ready = ready_for(predictor, [entry.effect for entry in entries])
    columns = signatures(ready, base.windows, wanted)
    shapes, of_shapes = patterns(base.windows)
    free = _with_patterns(base, shapes, of_shapes)
    explained = most_likely(replace(free, scales=base.scales), free.prior.low, free.prior.high)
    weights = reweighted(replace(explained, weights=None).elimination, base.options.huber)
    # A larger factor is no noise, but a cause that goes with none of the covariates.
    scales = tuple(min(scale, LARGEST_NOISE) for scale in explained.scales)
    fit = replace(base, scales=scales)
    units = np.concatenate([candidate.scale for candidate in wanted])
    both = [np.hstack((own * units, other)) for own, other in zip(columns, of_shapes, strict=True)]
    return Screen(
        fit=fit,
        weights=weights,
        errors=errors,
        suspects=tuple(suspects),
        columns=tuple(columns),
        patterns=shapes,
        shapes=tuple(of_shapes),
        marginal=marginal(blocks_of(fit, both, errors=errors, weights=weights)),
    )


def _with_patterns(
    fit: Fit, shapes: Sequence[ResidualPattern], columns: Sequence[FloatArray]
) -> Fit:
    """Return the fit with sizes of patterns appended to the coefficients."""
    number = len(shapes)
    nothing, far = np.zeros(number), np.full(number, LARGEST_PATTERN)
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


def names_of(suspects: Sequence[Suspect]) -> tuple[str, ...]:
    """Return the names of hypotheses."""
    return tuple(suspect.entry.name for suspect in suspects)


def detectable(
    found: Screen, suspect: Suspect, options: InferenceOptions | None = None
) -> FloatArray:
    """Return sizes (m,), in std, of each value alone that is detected in 80 % of trials.

    Its evidence, at the std of the table, then holds the cut against the boards alone.
    """
    chosen = options or InferenceOptions()
    std = found.marginal.std(suspect.block)
    information = np.where(np.isfinite(std), std, np.inf) ** -2.0
    odds = np.log(chosen.cut / (1.0 - chosen.cut)) - suspect.log_odds
    needed = chosen.temperature * odds + 0.5 * np.log1p(information)
    with np.errstate(invalid='ignore', divide='ignore'):
        sigmas = np.sqrt(2.0 * needed * (1.0 + 1.0 / information)) + chosen.power_quantile
    return np.where(np.isfinite(std), sigmas * std, np.inf)
