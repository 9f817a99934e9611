# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Other optimisers of the twelve coefficients, for comparison in the benchmark."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.objective import objective, paper_values, stack
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.channels import INPUTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.predict import Prediction, Predictor
from trawl_ros.solver.slow_mode import slow_mode

DIFFERENCE = 3e-4
"""Step of the finite differences: in std of a coefficient, in m, and in m/s.

With twice the step the error is that of the linearisation. With a third of it the error is that of
the residual force of the steady states, and random.
"""

FIRST_STEP, LAST_STEP = 0.5, 1e-6
"""Steps of the coordinate search, in std of each coefficient."""


class Counting(Predictor):
    """Predictor of the package that counts the steady states it is asked for."""

    def __init__(self, model: GearModel) -> None:
        super().__init__(model)
        self.solves = 0

    def predict(
        self,
        coefficients: FloatArray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Equilibrium | None = None,
    ) -> Prediction:
        """Count, and predict."""
        self.solves += 1
        return super().predict(coefficients, port_length, starboard_length, speed, start)


class FiniteDifferencePredictor(Counting):
    """Predictor with derivatives by forward differences, each a warm steady state."""

    def __init__(self, model: GearModel, std: FloatArray) -> None:
        super().__init__(model)
        self._steps = DIFFERENCE * np.concatenate([std, np.ones(len(INPUTS))])

    def predict(
        self,
        coefficients: FloatArray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Equilibrium | None = None,
    ) -> Prediction:
        """Predict, with derivatives by changing one parameter after another."""
        at = np.array([*coefficients, port_length, starboard_length, speed])
        found = self._solve(at, start)
        values = found.observables.array()
        jacobian = np.empty((len(OBSERVABLES), len(at)))
        for index, step in enumerate(self._steps):
            moved = at.copy()
            moved[index] += step
            jacobian[:, index] = (self._solve(moved, found).observables.array() - values) / step
        model = self.model.with_coefficients(at[:-3])
        return Prediction(values, jacobian, slow_mode(model, found).shape, found)

    def _solve(self, at: FloatArray, start: Equilibrium | None) -> Equilibrium:
        self.solves += 1
        model = self.model.with_coefficients(at[:-3])
        return find_equilibrium(model, OperatingPoint(*at[-3:]), start)


@dataclass(frozen=True)
class Searched:
    """Result of a coordinate search: objective, number of steady states, and its end."""

    objective: float
    solves: int
    reached: bool


class CoordinateSearch:
    """Cyclic search for the minimum of eq. 35 along one coefficient after another, within bounds.

    A step that lowers the objective is kept; where neither direction does, the coefficient's
    step is halved. Steady states start from those of the best coefficients so far.
    """

    def __init__(
        self, model: GearModel, windows: Sequence[SteadyWindow], prior: ParameterVector
    ) -> None:
        self._model, self._prior = model, prior
        self._points = [
            OperatingPoint(*(window.means[name] for name in INPUTS)) for window in windows
        ]
        self._measured = stack([paper_values(window.means) for window in windows])
        self._starts: list[Equilibrium | None] = [None] * len(windows)
        self.solves = 0

    def search(self, target: float, budget: int) -> Searched:
        """Search until the target or the budget is reached, or the steps become short.

        ``target`` is the objective to reach, ``budget`` the number of steady states that may be
        solved.
        """
        prior = self._prior
        best = np.array(prior.start)
        least = self._try(best, np.inf)
        steps = np.full(len(best), FIRST_STEP)
        while least > target and self.solves < budget and steps.max() > LAST_STEP:
            for index in range(len(best)):
                for direction in (1.0, -1.0):
                    if least <= target or self.solves >= budget:
                        return Searched(least, self.solves, least <= target)
                    trial = best.copy()
                    trial[index] += direction * steps[index] * prior.std[index]
                    trial = np.clip(trial, prior.low, prior.high)
                    value = self._try(trial, least)
                    if value < least:
                        best, least = trial, value
                        break
                else:
                    steps[index] *= 0.5
        return Searched(least, self.solves, least <= target)

    def _try(self, coefficients: FloatArray, least: float) -> float:
        """Return the objective; if it is below ``least``, its states become the next starts."""
        model = self._model.with_coefficients(coefficients)
        found: list[Equilibrium] = []
        try:
            for point, start in zip(self._points, self._starts, strict=True):
                self.solves += 1
                found.append(find_equilibrium(model, point, start))
        except NoSteadyState:
            return np.inf
        rows = [
            paper_values(dict(zip(OBSERVABLES, state.observables.array(), strict=True)))
            for state in found
        ]
        value = objective(stack(rows), self._measured)
        if value < least:
            self._starts = list(found)
        return value
