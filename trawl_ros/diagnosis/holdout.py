# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hold-out comparison: kept-back windows predicted without the effect, with it, with a placebo.

All windows decide on the cause. For the comparison alone the fits are repeated without the windows
that are kept back.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.inference.refit import Refit
from trawl_ros.estimation.fit.linearised import Linearised, linearise, measured_inputs
from trawl_ros.estimation.report.residuals import residuals
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.model.observables import lies_over
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

FEWEST_TOWS = 3
"""With fewer tows, steady states of all of them are kept back instead of a tow."""

EVERY = 3
"""One in so many is kept back."""


@dataclass(frozen=True)
class Split:
    """Split into windows that are fitted in the comparison, and those that they predict.

    ``by`` says what is kept back: tows, or steady states of tows that are also fitted.
    """

    fitted: tuple[SteadyWindow, ...]
    kept_back: tuple[SteadyWindow, ...]
    by: str


def split(windows: Sequence[SteadyWindow], baseline: frozenset[int]) -> Split:
    """Keep every third of the examined tows back, from the second on, but not the last.

    Parameters
    ----------
    windows
        Of all tows.
    baseline
        Tows in which nothing is looked for.
    """
    examined = list(dict.fromkeys(w.tow for w in windows if w.tow not in baseline))
    if len(examined) >= FEWEST_TOWS:
        kept = set(examined[1:-1:EVERY])
        by = 'tow'
        kept_back = tuple(window for window in windows if window.tow in kept)
    else:
        states = list(dict.fromkeys(w.state for w in windows if w.tow not in baseline))
        kept = set(states[1::EVERY]) if len(states) >= 2 * EVERY else set()
        by = 'state'
        kept_back = tuple(window for window in windows if window.state in kept)
    left = {window.index for window in kept_back}
    return Split(tuple(w for w in windows if w.index not in left), kept_back, by)


@dataclass(frozen=True)
class HoldoutErrors:
    """Root mean square errors by channel, in its unit, and those expected from known errors."""

    rms: Mapping[str, float]
    expected: Mapping[str, float]
    windows: int

    def excess(self, expected: Mapping[str, float]) -> float:
        """Mean square over channels, relative to the expected one, beyond it."""
        if not self.rms:
            return 0.0
        ratios = [(self.rms[name] / expected[name]) ** 2 for name in self.rms]
        return max(0.0, float(np.mean(ratios)) - 1.0)


@dataclass(frozen=True)
class HoldoutComparison:
    """Errors on held-out windows without and with the effect, and with the best wrong one.

    The wrong one is the ``placebo``; ``instead`` is its name.
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


def without_kept_back(refit: Refit, halves: Split) -> Refit | None:
    """Repeat a fit without the windows kept back; None where none of the others is left."""
    estimator = refit.estimator.subset({window.state for window in halves.fitted})
    estimate = estimator.finish()
    return None if estimate is None else Refit(refit.wanted, estimator, estimate)


def errors(
    predictor: Predictor, refits: Sequence[Refit], windows: Sequence[SteadyWindow]
) -> list[HoldoutErrors]:
    """Errors of fits on windows that none of them was fitted to.

    Windows for which any of them has no steady state are left out for all.

    Parameters
    ----------
    predictor
        The gear.
    refits
        Of boards and effects.
    windows
        To be predicted.
    """
    rows = []
    for window in windows:
        try:
            rows.append([predicted(predictor, refit, window) for refit in refits])
        except NoSteadyState:
            continue
    return [_gathered([row[place] for row in rows]) for place in range(len(refits))]


def holdout_comparison(
    predictor: Predictor,
    base: Refit | None,
    best: Refit | None,
    placebo: Refit | None,
    windows: Sequence[SteadyWindow],
    instead: str | None = None,
) -> HoldoutComparison | None:
    """Compare refits on the windows kept back; None without such windows or a fit of the boards.

    Parameters
    ----------
    predictor
        The gear.
    base, best, placebo
        Refits of the boards alone, with the best effect, and with a wrong one.
    windows
        Kept back from all of them.
    instead
        Name of the wrong one.
    """
    if not windows or base is None:
        return None
    refits = [refit for refit in (base, best, placebo) if refit is not None]
    compared = iter(errors(predictor, refits, windows))
    return HoldoutComparison(
        before=next(compared),
        after=None if best is None else next(compared),
        placebo=None if placebo is None else next(compared),
        instead=instead,
    )


def predicted(predictor: Predictor, refit: Refit, window: SteadyWindow) -> Linearised:
    """Predict a window that a refit was not fitted to, from the state nearest to it.

    Parameters
    ----------
    predictor
        The gear.
    refit
        Of boards and effects.
    window
        To be predicted.

    Raises
    ------
    NoSteadyState
        If the gear has none there.
    """
    known = refit.predicted.get(window.index)
    if known is not None and known.window is window:
        return known
    free = replace(predictor, free=tuple(candidate.effect for candidate in refit.wanted))
    places = np.array([linear.inputs for linear in refit.fit.windows])
    away = np.abs(places / measured_inputs(window) - 1.0).sum(axis=1)
    near = refit.fit.windows[int(np.argmin(away))].state
    found = linearise(free, OBSERVABLES, window, refit.estimate.values, (near, None))
    if lies_over(predictor.model, found.state.state):
        # The way from a state nearby may lead past the upright one, which a cold start finds.
        with suppress(NoSteadyState):
            again = linearise(free, OBSERVABLES, window, refit.estimate.values)
            if not lies_over(predictor.model, again.state.state):
                found = again
    refit.predicted[window.index] = found
    return found


def _gathered(linearised: Sequence[Linearised]) -> HoldoutErrors:
    by_channel = residuals(linearised)
    return HoldoutErrors(
        rms={row.channel: float(np.sqrt(np.mean(row.values**2))) for row in by_channel},
        expected={row.channel: row.stated_std for row in by_channel},
        windows=len(linearised),
    )


def _removed(before: HoldoutErrors, after: HoldoutErrors | None) -> float | None:
    # In the same units: a gear with an effect may feel errors of warp lengths more.
    was = before.excess(before.expected)
    if after is None or was <= 0.0:
        return None
    return 1.0 - after.excess(before.expected) / was
