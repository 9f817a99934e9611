# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Search of a fit to steady windows: its linear problem, and windows solved where it leads.

Weights of the robust loss, noise found from residuals, and coefficients depend on each other. On
the linearised windows they converge together in some ten rounds, at next to no cost.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.linearised import Linearised, linearise
from trawl_ros.estimation.fit.nuisance import reweighted
from trawl_ros.estimation.fit.prediction import SteadyPredictor
from trawl_ros.estimation.least_squares.descent import NO_STEP
from trawl_ros.estimation.least_squares.linear_problem import LinearProblem, Place
from trawl_ros.estimation.windows.records import SteadyWindow

MAX_ROUNDS = 30
"""Rounds of weights and noise; what is left to do is seen when the model has been solved again."""

LAST_ROUND = 1e-3
"""Steps below this part of every coefficient's std, and factors on the noise that change by less,
end the rounds."""

SHORTER_STEP = 0.5
"""The part of a step that is taken where full steps lead to and fro."""

GETTING_ON = 0.5
"""The part of the step before to which one must have come down where full steps do lead on."""

WELL_KNOWN = 0.5
"""Range of the first order around a window's solution, in std of a reading."""

NO_STEADY_STATE = 'every further step leads to a gear without a steady state'


def most_likely(fit: Fit, low: FloatArray, high: FloatArray) -> Fit:
    """Return the fit of least cost within bounds (q,), to first order around its windows.

    Coefficients, noise and weights of the result belong together.
    """
    here = fit.rescaled()
    for _ in range(MAX_ROUNDS):
        problem = here.linear_problem(low, high)
        place = problem.target()
        size = problem.distance(place)
        weights = reweighted(here.elimination, fit.options.huber)
        coefficients = np.clip(_coefficients(fit, place), low, high)
        moved = replace(here, coefficients=coefficients, weights=weights).rescaled()
        change = np.max(np.abs(np.array(moved.scales) / np.array(here.scales) - 1.0))
        here = moved
        if size < LAST_ROUND and change < LAST_ROUND:
            break
    return here


def _coefficients(fit: Fit, place: Place) -> FloatArray:
    return fit.prior.start + fit.prior.std * place[0][: len(fit.prior)]


class WindowSearch:
    """Search for the coefficients of least cost, as `descend` leads it.

    Parameters
    ----------
    fit
        The fit before.
    predictor, observables
        The model of the gear, and the names of its values in their order.
    relinearise
        Windows that move by more, in std of their means, are solved again.
    on_step
        Called with the fit after each step that was taken.

    Attributes
    ----------
    fit
        The fit as it is; with the noise found last.
    lost
        Windows that have no steady state there, and were left out.
    spare
        Number of windows that the next step may leave out.
    obstacle
        Reason for which the last step was refused; '' if it was taken.
    """

    is_final, is_spent = True, False

    def __init__(
        self,
        fit: Fit,
        predictor: SteadyPredictor,
        observables: tuple[str, ...],
        relinearise: float,
        on_step: Callable[[Fit], None] = lambda fit: None,
    ) -> None:
        self.fit, self.lost, self.spare, self.obstacle = fit, list[SteadyWindow](), 0, ''
        self._predictor, self._observables = predictor, observables
        self._relinearise, self._on_step = relinearise, on_step
        self._last, self._pace = np.inf, 1.0

    def linearised(self) -> LinearProblem:
        """Return the linear problem here, with weights and noise that belong to its target."""
        self.obstacle = ''
        low, high = self.fit.prior.box(self.fit.coefficients, self.fit.options.largest_step)
        target = most_likely(self.fit, low, high)
        size = float(np.max(np.abs(target.coefficients - self.fit.coefficients) / target.std))
        # The share of the errors changes with a step, and may change back with the next.
        self._pace = SHORTER_STEP if size > GETTING_ON * self._last else 1.0
        self._last = size
        self.fit = replace(self.fit, scales=target.scales)
        return replace(self.fit, weights=target.weights).linear_problem(low, high)

    def is_predicted(self, place: Place) -> bool:
        """Return True if no window must be solved again at a place."""
        target = self.at(place)
        return not any(
            linear.is_far(target.coefficients, inputs, target.net, self._relinearise)
            for linear, inputs in zip(self.fit.windows, target.inputs, strict=True)
        )

    def move(self, place: Place, share: float) -> str:
        """Move to a place if the cost is lower there; return the reason if it is refused."""
        try:
            there = self._moved(self.at(place), share)
        except NoSteadyState:
            self.obstacle = NO_STEADY_STATE
            return self.obstacle
        left, lost = with_those_of(self.fit, there)
        # Errors do something else there; whichever way one looks at it, it is to be better.
        better = min(there.cost, there.cost_with_nuisance_of(left)) <= left.cost * (1.0 + 1e-12)
        if not better and _comparable(left, there):
            self.obstacle = NO_STEP
            return self.obstacle
        self.fit, self.spare, self.obstacle = there, 0, ''
        self.lost += lost
        self._on_step(there)
        return ''

    def at(self, place: Place) -> Fit:
        """Fit at other coefficients, to first order."""
        coefficients = self.fit.prior.clipped(_coefficients(self.fit, place))
        return replace(self.fit, coefficients=coefficients)

    def _moved(self, target: Fit, share: float) -> Fit:
        """Fit at a target, solved again where first order would not do.

        The newest window always is, lest many small steps walk out of the steady states. Inputs and
        net go as far as the coefficients do.

        Raises
        ------
        NoSteadyState
            If more windows have none there than may be left out.
        """
        fit, pace, spare, windows = self.fit, self._pace, self.spare, []
        share *= pace
        away = pace * (target.coefficients - fit.coefficients)
        coefficients = fit.prior.clipped(fit.coefficients + away)
        for linear, ahead in zip(fit.windows, target.inputs, strict=True):
            inputs = linear.inputs + share * (ahead - linear.inputs)
            net = None if target.net is None else linear.net + share * (target.net - linear.net)
            newest = linear is fit.windows[-1]
            if newest or linear.is_far(coefficients, inputs, net, self._relinearise):
                try:
                    linear = linearise(
                        self._predictor, self._observables, linear.window, coefficients,
                        (linear.state,), inputs, net, even=False,
                    )  # fmt: skip
                except NoSteadyState:
                    if not spare:
                        raise
                    spare -= 1
                    continue
            windows.append(linear)
        return replace(fit, windows=tuple(windows), coefficients=coefficients)


def with_those_of(fit: Fit, other: Fit) -> tuple[Fit, list[SteadyWindow]]:
    """Fit with the windows of another only, and the windows that it loses by that."""
    kept = {linear.window.index for linear in other.windows}
    lost = [linear.window for linear in fit.windows if linear.window.index not in kept]
    if not lost:
        return fit, lost
    return replace(fit, windows=tuple(p for p in fit.windows if p.window.index in kept)), lost


def _comparable(fit: Fit, other: Fit) -> bool:
    """True if the costs compare: windows solved again in another fit were well predicted before."""

    def is_same(linear: Linearised, old: Linearised, inputs: FloatArray) -> bool:
        return linear is old or not old.is_far(fit.coefficients, inputs, fit.net, WELL_KNOWN)

    triples = zip(other.windows, fit.windows, fit.inputs, strict=True)
    return all(is_same(*triple) for triple in triples)
