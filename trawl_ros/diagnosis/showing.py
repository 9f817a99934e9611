"""Third look: tows that decided nothing, predicted without the effect, with it, with another."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.diagnosis.refit import Refit
from trawl_ros.errors import NoSteadyState
from trawl_ros.identification.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.identification.linearised import linearise
from trawl_ros.identification.window_records import SteadyWindow
from trawl_ros.model.observables import OBSERVABLES
from trawl_ros.solver.effect_predictor import EffectPredictor

FEWEST_TOWS = 3
"""With fewer tows, steady states of all of them are kept back instead of a tow."""

EVERY = 3
"""One in so many is kept back."""


@dataclass(frozen=True)
class Split:
    """Windows that decide, and those kept back to show; ``by`` says what was kept back: tows, or
    steady states of tows that also decide.
    """

    deciding: tuple[SteadyWindow, ...]
    showing: tuple[SteadyWindow, ...]
    by: str


def split(windows: Sequence[SteadyWindow], baseline: frozenset[int]) -> Split:
    """Keep every third of the examined tows back, from the second on.

    Parameters
    ----------
    windows
        Of all tows.
    baseline
        Tows in which nothing is looked for.
    """
    examined = list(dict.fromkeys(w.tow for w in windows if w.tow not in baseline))
    if len(examined) >= FEWEST_TOWS:
        kept = set(examined[1::EVERY])
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
class Errors:
    """Root mean square errors by channel, in its unit, and ``expected``, what errors known of would
    make them.
    """

    rms: Mapping[str, float]
    expected: Mapping[str, float]
    windows: int

    @property
    def excess(self) -> float:
        """Mean square of all channels in what is expected, beyond what is expected."""
        if not self.rms:
            return 0.0
        ratios = [(self.rms[name] / self.expected[name]) ** 2 for name in self.rms]
        return max(0.0, float(np.mean(ratios)) - 1.0)


def errors(predictor: EffectPredictor, one: Refit, windows: Sequence[SteadyWindow]) -> Errors:
    """Errors of a fit on windows it has not seen; those without steady state are left out.

    Parameters
    ----------
    predictor
        The gear, with the effects of ``one`` free.
    one
        The fit.
    windows
        To be predicted.
    """
    near = [part.state for part in one.fit.windows]
    places = np.array([part.inputs for part in one.fit.windows])
    squares: dict[str, list[tuple[float, float]]] = {}
    seen = 0
    for window in windows:
        inputs = np.array([window.means[name] for name in INPUTS])
        closest = near[int(np.argmin(np.abs(places / inputs - 1.0).sum(axis=1)))]
        try:
            part = linearise(predictor, OBSERVABLES, window, one.estimate.values, (closest, None))
        except NoSteadyState:
            continue
        seen += 1
        of_inputs = np.array([window.std(name) for name in INPUTS])
        std = np.hypot(part.std(1), np.linalg.norm(part.by_inputs * of_inputs, axis=1))
        left = part.measured - part.solved
        for name, error, expected in zip(part.channels, left, std, strict=True):
            squares.setdefault(name, []).append((float(error) ** 2, float(expected) ** 2))
    ordered = [name for name in MEASURED if name in squares]
    means = {name: np.sqrt(np.mean(squares[name], axis=0)) for name in ordered}
    return Errors(
        rms={name: float(mean[0]) for name, mean in means.items()},
        expected={name: float(mean[1]) for name, mean in means.items()},
        windows=seen,
    )


def unit_of(channel: str) -> str:
    """The SI unit of a channel."""
    return CHANNELS[channel].unit
