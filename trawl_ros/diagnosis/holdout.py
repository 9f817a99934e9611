"""Hold-out comparison: kept-back windows predicted without the effect, with it, with a placebo."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.estimation.fit.linearised import Linearised, linearise, measured_inputs
from trawl_ros.estimation.report.residuals import residuals
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

FEWEST_TOWS = 3
"""With fewer tows, steady states of all of them are kept back instead of a tow."""

EVERY = 3
"""One in so many is kept back."""


@dataclass(frozen=True)
class Split:
    """Split: windows that decide, and those kept back; ``by`` says what was kept back: tows, or
    steady states of tows that also decide.
    """

    deciding: tuple[SteadyWindow, ...]
    showing: tuple[SteadyWindow, ...]
    by: str


def split(windows: Sequence[SteadyWindow], baseline: frozenset[int]) -> Split:
    """Keep every third of the examined tows back, from the second on, but not the last.

    The last may have been towed to settle what those before it could not.

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
        showing = tuple(window for window in windows if window.tow in kept)
    else:
        states = list(dict.fromkeys(w.state for w in windows if w.tow not in baseline))
        kept = set(states[1::EVERY]) if len(states) >= 2 * EVERY else set()
        by = 'state'
        showing = tuple(window for window in windows if window.state in kept)
    left = {window.index for window in showing}
    return Split(tuple(w for w in windows if w.index not in left), showing, by)


@dataclass(frozen=True)
class HoldoutErrors:
    """Root mean square errors by channel, in its unit, and ``expected``, those that the
    known errors would make.
    """

    rms: Mapping[str, float]
    expected: Mapping[str, float]
    windows: int

    def excess(self, expected: Mapping[str, float]) -> float:
        """Mean square over channels, relative to the expected one, beyond it."""
        if not self.rms:
            return 0.0
        ratios = [(self.rms[name] / expected[name]) ** 2 for name in self.rms]
        return max(0.0, float(np.mean(ratios)) - 1.0)


def errors(
    fits: Sequence[tuple[Predictor, Refit]], windows: Sequence[SteadyWindow]
) -> list[HoldoutErrors]:
    """Errors of fits on windows that none of them was fitted to.

    Windows for which any of them has no steady state are left out for all.

    Parameters
    ----------
    fits
        The gear with the effects of each fit free, and the fit.
    windows
        To be predicted.
    """
    rows = []
    for window in windows:
        try:
            rows.append([_predicted(predictor, one, window) for predictor, one in fits])
        except NoSteadyState:
            continue
    return [_gathered([row[place] for row in rows]) for place in range(len(fits))]


def _predicted(predictor: Predictor, one: Refit, window: SteadyWindow) -> Linearised:
    places = np.array([part.inputs for part in one.fit.windows])
    away = np.abs(places / measured_inputs(window) - 1.0).sum(axis=1)
    near = one.fit.windows[int(np.argmin(away))].state
    return linearise(predictor, OBSERVABLES, window, one.estimate.values, (near, None))


def _gathered(parts: Sequence[Linearised]) -> HoldoutErrors:
    found = residuals(parts)
    return HoldoutErrors(
        rms={row.channel: float(np.sqrt(np.mean(row.values**2))) for row in found},
        expected={row.channel: row.stated_std for row in found},
        windows=len(parts),
    )
