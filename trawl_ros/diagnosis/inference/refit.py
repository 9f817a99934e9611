# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Joint refit of boards and effects, all windows solved again, from first-order values."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.progress import WorkProgress
from trawl_ros.diagnosis.inference.candidates import Candidate, extended, with_candidates
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.fit.window_search import with_those_of
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

OPTIONS = EstimatorOptions(
    second_start=False,
    iterations_final=14,
    attempts=4,
    relinearise_final=0.1,
    set_aside=0.1,
    tolerance=0.05,
    model_trend=1.0,
    least_noise=1.0,
)
"""A fit that lacks an effect explains its readings badly, from wherever it is started, and on its
way some windows lose their steady state. What the model is wrong by changes with the length of the
warps, which would pass for an effect. Readings that scatter less than is stated make neither model
nor the form of an effect better, so that what these are wrong by must not count the more."""

POOR_MISFIT = 3.0
"""A misfit from where the boards are fitted again, another way."""

REFITTING = replace(OPTIONS, iterations_final=8, attempts=3)
"""Options of a refit, which starts near to where it converges."""

LIKE_THE_GEAR = 3.0
"""Noise found over noise stated below which a baseline shows that it is the same gear."""


@dataclass(frozen=True)
class Refit:
    """Joint fit of boards and some effects (none: the boards alone).

    Attributes
    ----------
    wanted
        The effects.
    estimator
        At rest, with all windows that have a steady state.
    estimate
        Its estimate of coefficients (q,) and values behind them.
    predicted
        Windows that it was not fitted to, once they are predicted, by their numbers.
    """

    wanted: tuple[Candidate, ...]
    estimator: Estimator
    estimate: Estimate
    predicted: dict[int, Linearised] = field(default_factory=dict, repr=False, compare=False)

    @property
    def fit(self) -> Fit:
        """Fit of the windows."""
        return self.estimator.fit

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(candidate.name for candidate in self.wanted)

    @property
    def number(self) -> int:
        """Number of effects' values behind the coefficients."""
        return len(self.values)

    @property
    def values(self) -> FloatArray:
        """Effects' values (m,) behind the coefficients."""
        return self.estimate.values[self.fit.prior.slice_of('effect')]

    def cost(self, scales: tuple[float, ...]) -> float:
        """Cost at given noise scales, without the prior of the effects."""
        fit = replace(self.fit, scales=scales)
        away = fit.prior.departure(fit.coefficients)[fit.prior.slice_of('effect')]
        return fit.cost - 0.5 * self.fit.options.prior_weight * float(away @ away)

    def at_bound(self) -> bool:
        """True if a value of an effect rests on a bound."""
        effects = self.fit.prior.slice_of('effect')
        low, high = self.fit.prior.on_bounds(self.estimate.values)
        return bool(np.any(low[effects] | high[effects]))


def fit_boards(
    predictor: Predictor,
    prior: ParameterVector,
    windows: Sequence[SteadyWindow],
    options: EstimatorOptions = OPTIONS,
    start: FloatArray | None = None,
) -> Refit | None:
    """Fit the boards alone; None where no window has a steady state.

    The search begins at the coefficients ``start`` (q,), or where the prior does.
    """
    # All at once: what the first windows alone would say is not asked, and may lead astray.
    together = Estimator(predictor, prior, OBSERVABLES, options)
    if start is not None:
        together.begin((), prior.clipped(start))
    together.take(windows)
    estimate = together.finish()
    at_once = None if estimate is None else Refit((), together, estimate)
    if at_once is not None and at_once.fit.birge_ratio < POOR_MISFIT:
        return at_once
    # Far from where they start boards may get stuck, which window by window they need not.
    by_turns = Estimator(predictor, prior, OBSERVABLES, options)
    for window in windows:
        by_turns.add(window)
    estimate = by_turns.finish()
    return likelier(at_once, None if estimate is None else Refit((), by_turns, estimate))


def was_in_order(
    predictor: Predictor,
    prior: ParameterVector,
    windows: Sequence[SteadyWindow],
    baseline: frozenset[int],
) -> bool:
    """True if the baseline alone agrees with this gear."""
    before = [window for window in windows if window.tow in baseline]
    of_baseline = fit_boards(predictor, prior, before) if before else None
    return of_baseline is not None and float(np.median(of_baseline.fit.scales)) < LIKE_THE_GEAR


def likelier(first: Refit | None, second: Refit | None) -> Refit | None:
    """The fit with more windows, or else the likelier, of two fits of the same ones."""
    if first is None or second is None:
        return first or second
    if len(first.fit.windows) != len(second.fit.windows):
        return max(first, second, key=lambda fit: len(fit.fit.windows))
    return min(first, second, key=lambda fit: fit.fit.negative_log_likelihood)


def refitted(
    predictor: Predictor,
    base: Refit,
    wanted: Sequence[Candidate],
    columns: Sequence[FloatArray],
    away: FloatArray,
) -> Refit | None:
    """Refit boards and effects together.

    Parameters
    ----------
    predictor
        The gear without them.
    base
        Fit of the boards alone, from which to start.
    wanted
        The effects.
    columns
        For each window (channels, m): what these effects change per unit.
    away
        Values (m,) to first order, in their std about the start.

    Returns
    -------
    Refit or None
        None where a state that was towed has no steady state then: that explains nothing.
    """
    windows = extended(base.fit, wanted, columns, base.fit.options).windows
    scale = np.concatenate([candidate.scale for candidate in wanted])
    starts = np.concatenate([candidate.start for candidate in wanted])
    best: Refit | None = None
    # First order may lead astray: then from where there is nothing but the boards.
    for values in (starts + scale * away, starts):
        best = likelier(best, converged(predictor, base, wanted, values, windows))
        lower = best is not None and (
            best.fit.negative_log_likelihood < base.fit.negative_log_likelihood
        )
        if lower and not lost_by(base, best):
            break
    return None if lost_by(base, best) else best


def converged(
    predictor: Predictor,
    base: Refit,
    wanted: Sequence[Candidate],
    values: FloatArray,
    windows: Sequence[Linearised],
) -> Refit | None:
    """Fit boards and effects together from these values of the effects."""
    free = replace(predictor, free=tuple(candidate.effect for candidate in wanted))
    prior = with_candidates(base.fit.prior, wanted)
    board = base.fit.coefficients[base.fit.prior.slice_of('coefficients')]
    estimator = Estimator(free, prior, OBSERVABLES, REFITTING)
    estimator.begin(windows, prior.clipped(np.concatenate((board, values))))
    estimate = estimator.finish()
    return None if estimate is None else Refit(tuple(wanted), estimator, estimate)


def lost_by(base: Refit, fitted: Refit | None) -> frozenset[int]:
    """Windows that have a steady state with the boards alone, and none in a refit."""
    if fitted is None:
        return frozenset(linear.window.index for linear in base.fit.windows)
    return frozenset(window.index for window in with_those_of(base.fit, fitted.fit)[1])


def told(*names: str) -> WorkProgress:
    """Progress of a diagnosis that refits with these effects."""
    return WorkProgress('diagnosing', detail=f'refitting with {" and ".join(names)}')
