# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Estimator of the coefficients from steady windows, robust and within bounds.

For constant parameters this is an iterated Kalman filter: every window stays in memory with
its linearisation, and is solved again when the estimate has moved so far that first order
would no longer do. There is no forgetting: without excitation it would wind up.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.estimate import Estimate, Innovation
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import AS_STATED, Fit
from trawl_ros.estimation.fit.fitted_estimate import innovation_of, posterior_estimate
from trawl_ros.estimation.fit.linearised import (
    Linearised,
    linearise,
    measured_inputs,
    nearest_state,
    paper_rows,
)
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.fit.prediction import SteadyPredictor
from trawl_ros.estimation.fit.window_search import NO_STEADY_STATE, WindowSearch
from trawl_ros.estimation.least_squares.descent import DescentOptions, Rest, descend
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.solver.predict import Predictor

if TYPE_CHECKING:
    from trawl_ros.solver.equilibrium import Equilibrium

POOR_MISFIT = 1.2
"""Misfit from which a fit may have converged to a wrong minimum. Chance alone does not reach it
with the readings of a tow. With those of one window it may, and then a second fit costs little."""


AS_LIKELY = 0.1
"""Difference of log-likelihoods below which two fits are equally likely (that of half a std of one
coefficient): of such two the converged one is taken."""


@dataclass(frozen=True)
class Progress:
    """Record of an accepted step: ``windows`` in the fit, its cost, and the objective of eq. 35."""

    windows: int
    cost: float
    objective: float


class Estimator:
    """Estimator of the coefficients from steady windows.

    Parameters
    ----------
    predictor
        The model of the gear.
    prior
        Start, std and bounds.
    observables
        Names of the predictor's values, in their order.
    options
        Options of the estimator.

    Attributes
    ----------
    estimate : Estimate or None
        The newest estimate.
    history : list of Progress
        One entry per accepted step.
    """

    def __init__(
        self,
        predictor: SteadyPredictor,
        prior: ParameterVector,
        observables: Sequence[str],
        options: EstimatorOptions | None = None,
    ) -> None:
        self.predictor = predictor
        self.prior = prior
        self.observables = tuple(observables)
        self.options = options or EstimatorOptions()
        self.reset()

    def reset(self) -> None:
        """Reset to no windows."""
        self.estimate: Estimate | None = None
        self.history: list[Progress] = []
        self._fit = Fit((), np.array(self.prior.start), AS_STATED, self.prior, self.options)
        self._without: list[SteadyWindow] = []
        self._start = self.prior.start
        self._stood_in: set[int] = set()
        self._revision = 0

    @property
    def windows(self) -> tuple[SteadyWindow, ...]:
        """Windows in the fit."""
        return tuple(linear.window for linear in self._fit.windows)

    @property
    def coefficients(self) -> FloatArray:
        """Present coefficients (q,)."""
        return self._fit.coefficients

    @property
    def fit(self) -> Fit:
        """Fit of the windows at the present coefficients."""
        return self._fit

    @property
    def without_steady_state(self) -> int:
        """Number of windows for which the model has no steady state; `finish` tries them again."""
        return len(self._without)

    def add(self, window: SteadyWindow, near: 'Equilibrium | None' = None) -> Estimate | None:
        """Add one window; None when the model has no steady state there.

        ``near`` is a steady state to start from, in addition to those of other windows.
        """
        try:
            linear = self._linearise(window, self.coefficients, self._inputs_of(window), start=near)
        except NoSteadyState:
            stood = None if self._fit.windows else self._stood(window)
            if stood is None:
                self._without.append(window)
                return None
            linear = stood
        innovation = self._innovation(linear)
        self._fit = replace(self._fit, windows=(*self._fit.windows, linear))
        rest, obstacle = self._descend(self.options.relinearise, self.options.iterations_per_window)
        reason = f'the last step was {rest.size:.2g} std; the fit converges at the end'
        return self._publish(innovation, False, obstacle or reason)

    def finish(self) -> Estimate | None:
        """Iterate over all windows to convergence; None when no window can be used."""
        self._solve_all()
        if self._without and not self._fit.windows:
            # First order has led the estimate where the gear has no steady state at all.
            self._from_start()
        if not self._fit.windows and any(self._stood(window) for window in self._without):
            self._solve_all()
        converged, reason = self._rest_with_all()
        doubtful = self._fit.birge_ratio > POOR_MISFIT or not converged
        if self.options.second_start and self._fit.windows and doubtful:
            # The first windows, with what was known then, may have led into another valley.
            first, without, course = self._fit, self._without, list(self.history)
            self._from_start()
            again, why = self._rest_with_all()
            margin = AS_LIKELY if again and not converged else 0.0
            if _likelier(self._fit, first, margin):
                converged, reason = again, why
            else:
                self._fit, self._without, self.history = first, without, course
        return self._publish(None, converged, reason) if self._fit.windows else None

    def begin(self, linearised: Sequence[Linearised], coefficients: FloatArray) -> None:
        """Take windows that were solved elsewhere.

        `finish` solves them again where they are wanted at these coefficients.
        """
        self._fit = replace(
            self._fit, windows=tuple(linearised), coefficients=np.array(coefficients)
        )

    def take(self, windows: Sequence[SteadyWindow]) -> None:
        """Take windows unsolved; `finish` solves all of them at once."""
        self._without += windows

    def subset(self, states: set[int], options: EstimatorOptions | None = None) -> 'Estimator':
        """Return an estimator with the windows of some states only, starting from this estimate."""
        subset = Estimator(self.predictor, self.prior, self.observables, options or self.options)
        chosen = tuple(linear for linear in self._fit.windows if linear.window.state in states)
        subset._fit = replace(self._fit, windows=chosen, options=subset.options)
        return subset

    def predictions(
        self,
        coefficients: FloatArray,
        windows: Sequence[SteadyWindow] | None = None,
        net: FloatArray | None = None,
        inputs: FloatArray | None = None,
    ) -> FloatArray:
        """Predict the four channels of eq. 35 in windows.

        They are predicted at the inputs as measured, or ``inputs`` (n, 3), with factors ``net``
        (2,) on the net's drag and weight, or those of the fit.

        Returns
        -------
        (n, 4) array in the order of `PAPER_CHANNELS`, NaN where there is no steady state.
        """
        windows = self.windows if windows is None else windows
        net = self._fit.net if net is None else net
        near = [state for window in windows for state in nearest_state(window, self._fit.windows)]
        return paper_rows(self.solve(coefficients, windows, net, inputs, near), inputs)

    def solve(
        self,
        coefficients: FloatArray,
        windows: Sequence[SteadyWindow] | None = None,
        net: FloatArray | None = None,
        inputs: FloatArray | None = None,
        own: Sequence['Equilibrium'] = (),
    ) -> list[Linearised | None]:
        """Solve the model at the inputs of each window.

        It is solved from its own state where that is known, else from the nearest one already
        solved.

        Parameters
        ----------
        coefficients
            Shape (q,).
        windows
            Windows (n); those of the fit if None.
        net
            Factors (2,) on drag and weight of the net; as in the gear file if None.
        inputs
            Warp lengths and speed (n, 3); as measured if None.
        own
            Steady states of the windows at these coefficients or nearby.

        Returns
        -------
        list
            In the order of the windows; None where the model has no steady state.
        """
        windows = self.windows if windows is None else windows
        found: list[Linearised | None] = []
        without: set[int] = set()
        for row, window in enumerate(windows):
            if window.state in without:
                # It takes long to find that there is none, and is the same throughout a state.
                found.append(None)
                continue
            starts = (*own[row : row + 1], *nearest_state(window, found), None)
            place = None if inputs is None else inputs[row]
            try:
                linear = linearise(
                    self.predictor, self.observables, window, coefficients, starts, place, net
                )
            except NoSteadyState:
                without.add(window.state)
                found.append(None)
            else:
                found.append(linear)
        return found

    def inputs_of(self, windows: Sequence[SteadyWindow]) -> FloatArray:
        """Warp lengths and speed (n, 3) of windows, corrected for errors as they are estimated."""
        return np.array([self._inputs_of(window) for window in windows])

    def _inputs_of(self, window: SteadyWindow) -> FloatArray:
        """Warp lengths and speed of a window, corrected for their estimated errors.

        One that is new is taken to share those of the last window of its tow.
        """
        measured = measured_inputs(window)
        corrected = measured
        for linear, inputs in zip(self._fit.windows, self._fit.inputs, strict=True):
            if linear.window.index == window.index:
                corrected = inputs
                break
            if linear.window.tow == window.tow:
                corrected = measured + inputs - measured_inputs(linear.window)
        return corrected

    def _linearise(
        self,
        window: SteadyWindow,
        coefficients: FloatArray,
        inputs: FloatArray | None = None,
        *,
        start: 'Equilibrium | None' = None,
        near: Sequence[Linearised] = (),
    ) -> Linearised:
        """Linearise the model at a window, from a given state or that of the nearest window."""
        given = () if start is None else (start,)
        starts = (*given, *nearest_state(window, (*self._fit.windows, *near)), None)
        return linearise(
            self.predictor, self.observables, window, coefficients, starts, inputs, self._fit.net
        )

    def _stood(self, window: SteadyWindow) -> Linearised | None:
        """Start where the boards stand as a window shows them, once for each of a few states."""
        if window.state in self._stood_in or len(self._stood_in) >= self.options.standing_states:
            return None
        if not isinstance(self.predictor, Predictor):
            return None
        # SciPy's optimisers load slowly, and few boards fall.
        from trawl_ros.estimation.fit.standing import standing_starts

        self._stood_in.add(window.state)
        for start in standing_starts(self.predictor.model, self.prior, window.means):
            try:
                linear = self._linearise(window, start)
            except NoSteadyState:
                continue
            self._start = start
            self._fit = replace(self._fit, coefficients=start)
            return linear
        return None

    def _from_start(self) -> None:
        """Linearise all windows where the fit began, as if none had been seen."""
        self._fit = replace(self._fit, coefficients=np.array(self._start), scales=AS_STATED)
        self._solve_all()

    def _rest_with_all(self) -> tuple[bool, str]:
        """Converge with the windows that had no steady state on the way but have one there."""
        converged, reason = self._rest()
        if self._without and self._fit.windows:
            number = len(self._fit.windows)
            self._solve_all()
            if len(self._fit.windows) != number:
                converged, reason = self._rest()
        return converged, reason

    def _solve_all(self) -> None:
        """Linearise all windows at the present coefficients; set aside those without a state."""
        solved = {linear.window.index: linear for linear in self._fit.windows}
        windows = sorted((*self.windows, *self._without), key=lambda window: window.index)
        self._without = []
        linearised: list[Linearised] = []
        for window in windows:
            linear, inputs = solved.get(window.index), self._inputs_of(window)
            threshold = self.options.relinearise_final
            if linear is None or linear.is_far(self.coefficients, inputs, self._fit.net, threshold):
                try:
                    linear = self._linearise(window, self.coefficients, inputs, near=linearised)
                except NoSteadyState:
                    self._without.append(window)
                    continue
            linearised.append(linear)
        self._fit = replace(self._fit, windows=tuple(linearised))

    def _rest(self) -> tuple[bool, str]:
        """Iterate to convergence; return its success and reason."""
        if not self._fit.windows:
            return False, 'no window has a steady state in the model'
        rest, _ = self._descend(self.options.relinearise_final, self.options.iterations_final)
        return rest.converged, rest.reason

    def _descend(self, relinearise: float, iterations: int) -> tuple[Rest, str]:
        """Step towards the least cost; return the end, and what obstructs a further step."""
        search = WindowSearch(
            self._fit, self.predictor, self.observables, relinearise, self._note_step
        )
        left = iterations
        while True:
            options = DescentOptions(left, self.options.attempts, self.options.tolerance)
            rest = descend(search, options)
            left -= rest.iterations
            number = len(search.fit.windows) + len(self._without) + len(search.lost)
            aside = int(self.options.set_aside * number) - len(self._without) - len(search.lost)
            # Windows are left out only where no shorter step keeps them all.
            if rest.converged or search.obstacle != NO_STEADY_STATE or min(left, aside) <= 0:
                break
            if search.spare:
                break
            search.spare = aside
        self._fit = search.fit if rest.place is None else search.at(rest.place)
        self._without += search.lost
        return rest, search.obstacle

    def _note_step(self, fit: Fit) -> None:
        self.history.append(Progress(len(fit.windows), fit.cost, fit.objective))

    def _innovation(self, linear: Linearised) -> Innovation:
        known = np.diag(self.prior.std**2) if self.estimate is None else self.estimate.covariance
        return innovation_of(linear, self._fit, known)

    def _publish(self, innovation: Innovation | None, converged: bool, reason: str) -> Estimate:
        self._revision += 1
        self.estimate = posterior_estimate(self._fit, self._revision, innovation, converged, reason)
        return self.estimate


def _likelier(fit: Fit, other: Fit, margin: float) -> bool:
    """True if a fit explains more windows than another, or as many as well.

    Its log-likelihood then is higher, or lower by no more than a margin.
    """
    return (-len(fit.windows), fit.negative_log_likelihood - margin) < (
        -len(other.windows),
        other.negative_log_likelihood,
    )
