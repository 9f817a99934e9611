# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Plausibility screening of channels by the model, within the prior of the board.

Before any tow the board is known within its prior. A steady state far outside what that allows
is no news about the board: an instrument speaks in a wrong unit, or is wrong altogether.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.fit.prediction import SteadyPrediction, SteadyPredictor
from trawl_ros.estimation.windows.operation import Unheld
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.estimation.windows.unit_errors import (
    PITCHES,
    ROLLS,
    Misreading,
    misreadings,
    towable,
)
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED

if TYPE_CHECKING:
    from trawl_ros.solver.equilibrium import Equilibrium

NumberT = TypeVar('NumberT', int, float)

MODEL_FRACTION, MODEL_ANGLE = 0.1, 0.05
"""Error of the model, as part of an observable and in rad, wide enough for any kept gear."""

SUSPICIOUS = 40.0
"""Squared distance of some ten channels beyond which units are tried."""

CREDIBLE = 20.0
"""Squared distance to which a unit must bring them to be named."""

IMPLAUSIBLE = 300.0
"""Squared distance beyond which a window is refused though no unit explains it."""


@dataclass(frozen=True)
class ScreeningResult:
    """Judgement: channels to leave out and why, or the window ``refused``; None when sound."""

    found: Unheld | None = None
    without: tuple[str, ...] = ()
    refused: bool = False


class Screening:
    """Screening of windows by the model and the prior of the coefficients.

    Parameters
    ----------
    predictor, prior, observables
        The model, the spread of its coefficients, and the names of what it predicts.
    """

    def __init__(
        self, predictor: SteadyPredictor, prior: ParameterVector, observables: Sequence[str]
    ) -> None:
        self._predictor = predictor
        self._prior = prior
        self._observables = tuple(observables)
        self.reset()

    def reset(self) -> None:
        """Reset to no windows."""
        self._start: Equilibrium | None = None
        self._state: int | None = None
        self._judgement = ScreeningResult()
        self._tow: int | None = None
        self._unit: Misreading | None = None

    @property
    def near(self) -> 'Equilibrium | None':
        """Newest steady state found, as a start for nearby ones; None before any."""
        return self._start

    def judge(self, window: SteadyWindow, coefficients: FloatArray) -> ScreeningResult:
        """Judge a window around the present coefficients (q,); once for each steady state.

        A unit that was found wrong stays so through the tow, unless a window says otherwise.
        """
        if window.tow != self._tow:
            self._tow, self._unit = window.tow, None
        if window.state != self._state:
            self._judgement = self._judge(window, coefficients)
            self._state = window.state
        return self._judgement

    def _judge(self, window: SteadyWindow, coefficients: FloatArray) -> ScreeningResult:
        distance = self._distance(window, coefficients)
        stated = distance(window.means)
        known = self._unit
        if known is not None and distance(known.repaired(window.means)) < stated:
            return _unit_judgement(known, window)
        if stated <= SUSPICIOUS:
            return ScreeningResult()
        if units := _explanations(window.means, distance):
            self._unit = units[0]
            return _unit_judgement(units[0], window, units[1:])
        if not IMPLAUSIBLE < stated < np.inf:
            return ScreeningResult()
        for channels in (('vertical_opening',), PITCHES, ROLLS, (*PITCHES, *ROLLS)):
            rest = {name: mean for name, mean in window.means.items() if name not in channels}
            if len(rest) < len(window.means) and distance(rest) <= SUSPICIOUS:
                names = ' and '.join(channels)
                refusal = Unheld('implausible', f'{names} contradict all other channels')
                return ScreeningResult(refusal, channels)
        refusal = Unheld(
            'implausible',
            f'the channels contradict each other: whatever the board may be, they lie '
            f'{stated**0.5:.0f} standard deviations from what the model expects',
        )
        return ScreeningResult(refusal, refused=True)

    def _distance(
        self, window: SteadyWindow, coefficients: FloatArray
    ) -> Callable[[Mapping[str, float]], float]:
        """Return the squared Mahalanobis distance of means from the model as a function."""
        solved: dict[tuple[float, float, float], SteadyPrediction | None] = {}

        def distance(means: Mapping[str, float]) -> float:
            inputs = means['port_length'], means['starboard_length'], means['speed']
            if inputs not in solved:
                solved[inputs] = self._solve(inputs, coefficients)
            prediction = solved[inputs]
            return np.inf if prediction is None else self._compare(prediction, window, means)

        return distance

    def _compare(
        self, prediction: SteadyPrediction, window: SteadyWindow, means: Mapping[str, float]
    ) -> float:
        names = [name for name in MEASURED if name in means and name in self._observables]
        rows = [self._observables.index(name) for name in names]
        values, jacobian = prediction.values[rows], prediction.jacobian[rows]
        inputs = np.array([CHANNELS[name].steady_std(means[name]) for name in INPUTS])
        known = jacobian * np.concatenate((self._prior.std, inputs))
        own = [
            window.own_noise(name) ** 2 + CHANNELS[name].steady_std(means[name]) ** 2
            for name in names
        ]
        model = [
            MODEL_ANGLE if CHANNELS[name].unit == 'rad' else MODEL_FRACTION * abs(value)
            for name, value in zip(names, values, strict=True)
        ]
        covariance = known @ known.T + np.diag(np.array(own) + np.square(model))
        off = np.array([means[name] for name in names]) - values
        return float(off @ np.linalg.solve(covariance, off))

    def _solve(
        self, inputs: tuple[float, float, float], coefficients: FloatArray
    ) -> SteadyPrediction | None:
        starts = [None] if self._start is None else [self._start, None]
        for start in starts:
            try:
                steady = self._predictor.predict(coefficients, *inputs, start)
            except NoSteadyState:
                continue
            self._start = steady.state
            return steady
        return None


def _explanations(
    means: Mapping[str, float], distance: Callable[[Mapping[str, float]], float]
) -> list[Misreading]:
    """Misreadings of units that reconcile the channels, the best first."""
    tried = [
        (distance(repaired), unit)
        for unit in misreadings(means)
        if towable(repaired := unit.repaired(means))
    ]
    credible = [(distance, unit) for distance, unit in tried if distance <= CREDIBLE]
    return [unit for _, unit in sorted(credible, key=lambda pair: pair[0])]


def _unit_judgement(
    unit: Misreading, window: SteadyWindow, others: Sequence[Misreading] = ()
) -> ScreeningResult:
    sentence = unit.sentence(window.means)
    rivals = [other for other in others if not set(other.channels) & set(unit.channels)]
    if rivals:
        sentence += f' (or {" and ".join(rivals[0].channels)} are in {rivals[0].unit})'
    refusal = Unheld('wrong unit', sentence)
    return (
        ScreeningResult(refusal, unit.channels)
        if unit.optional
        else ScreeningResult(refusal, refused=True)
    )


def without(window: SteadyWindow, channels: Sequence[str]) -> SteadyWindow:
    """Copy of the window without some channels."""

    def rest(values: Mapping[str, NumberT]) -> dict[str, NumberT]:
        return {name: value for name, value in values.items() if name not in channels}

    return replace(
        window,
        means=rest(window.means),
        noise=rest(window.noise),
        to_come=rest(window.to_come),
        bias=rest(window.bias),
        counts=rest(window.counts),
    )
