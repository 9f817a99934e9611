# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Refit of the twelve coefficients to all states of the sample trial at once, as in Fig. 4."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.resources import share_path
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.objective import objective, paper_values, stack
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.validation.paper.sweeps import gear
from trawl_ros.lab.validation.paper.trial import SCENARIO, trial_windows
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.scenario.scenario import true_coefficients
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.predict import Prediction, Predictor


class _Remembering(Predictor):
    """Predictor that keeps the boards' mean attack angle (rad) of the newest prediction per input.

    Once the fit has converged, these are the angles of the estimate.
    """

    def __init__(self, model: GearModel) -> None:
        super().__init__(model)
        self.attack: dict[tuple[float, float, float], float] = {}

    def predict(
        self,
        coefficients: FloatArray,
        port_length: float,
        starboard_length: float,
        speed: float,
        start: Equilibrium | None = None,
    ) -> Prediction:
        found = super().predict(coefficients, port_length, starboard_length, speed, start)
        seen = found.state.observables
        self.attack[port_length, starboard_length, speed] = 0.5 * (
            seen.port_attack + seen.starboard_attack
        )
        return found


@dataclass(frozen=True)
class PaperRefit:
    """Fit, prior and true coefficients of the trial of the paper.

    ``objective`` is that of eq. 35 at the start and after each iteration. ``attack`` holds the
    smallest and largest mean α (rad) of the boards in the fitted states.
    """

    estimate: Estimate
    prior: ParameterVector
    truth: FloatArray
    objective: FloatArray
    attack: tuple[float, float]

    def line(self, values: FloatArray, slope: str, attack: FloatArray) -> FloatArray:
        """A straight line of eq. 14, drag (``a1``) or lift (``a2``), at angles in rad."""
        first = COEFFICIENTS.index(slope)
        law: FloatArray = values[first] * attack + values[first + 1]
        return law

    def half_width(self, slope: str, attack: FloatArray) -> FloatArray:
        """Standard deviation of the fitted line at angles in rad."""
        first = COEFFICIENTS.index(slope)
        part = self.estimate.covariance[first : first + 2, first : first + 2]
        basis = np.stack([attack, np.ones_like(attack)], -1)
        std: FloatArray = np.sqrt(np.sum(basis @ part * basis, -1))
        return std


@cache
def refit_trial(quick: bool) -> PaperRefit:
    """Fit the gear of the paper to the sample trial; in a process once."""
    return refit_paper_trial(gear(quick), trial_windows(quick))


def refit_paper_trial(record: GearRecord, windows: Sequence[SteadyWindow]) -> PaperRefit:
    """Fit a gear to steady windows, all together from the first iteration on.

    `trawl identify` takes windows one by one, as they come; an objective that gains terms on the
    way could not be compared with Fig. 4.

    Raises
    ------
    NoSteadyState
        If the gear has no steady state at the start in any window.
    """
    prior = board_prior(record)
    predictor = _Remembering(build_model(record))
    fit = Estimator(predictor, prior, OBSERVABLES)
    at_start = fit.predictions(prior.start, windows)
    predictor.attack.clear()
    measured = stack([paper_values(window.means) for window in windows])
    fit.take(windows)
    estimate = fit.finish()
    if estimate is None:
        raise NoSteadyState('the gear has no steady state at the start in any window of the trial')
    steps = [entry.objective for entry in fit.history[:-1]]
    return PaperRefit(
        estimate=estimate,
        prior=prior,
        truth=true_coefficients(share_path(*SCENARIO)),
        objective=np.array([objective(at_start, measured), *steps, estimate.objective]),
        attack=(min(predictor.attack.values()), max(predictor.attack.values())),
    )
