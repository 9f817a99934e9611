# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fit of all windows at one set of coefficients: cost, linear problem, posterior."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import (
    CALIBRATION,
    GROUP_OF,
    GROUPS,
    TowErrors,
    in_all_channels,
    model_errors,
    tow_errors,
)
from trawl_ros.estimation.fit.estimate import Posterior, posterior_of
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.linearised import Linearised, measured_inputs
from trawl_ros.estimation.fit.nuisance import NuisanceElimination, eliminate_nuisance
from trawl_ros.estimation.fit.objective import objective, paper_values, stack
from trawl_ros.estimation.fit.parameters import FARTHEST, ParameterVector
from trawl_ros.estimation.fit.redundancy import clipped_variance, redundancy_numbers
from trawl_ros.estimation.least_squares.linear_problem import LinearProblem

AS_STATED = (1.0,) * len(GROUPS)
"""Factors on the stated noise before anything is known of it."""

LEAST_FACTOR = 0.2
"""The net is never taken to have less than this part of its drag and weight."""


Known = tuple[tuple[Linearised, ...], EstimatorOptions, tuple[TowErrors, ...]]


@dataclass(frozen=True)
class Fit:
    """Linearised windows, coefficients (q,), and factors on the stated noise by group.

    What ``prior`` has behind the coefficients of the boards stands behind them in ``coefficients``
    and in the windows' ``by_coefficients``. ``weights`` of the readings are found where none are
    given. ``known`` are windows and their errors as they were worked out once: fits that are made
    of each other share them.
    """

    windows: tuple[Linearised, ...]
    coefficients: FloatArray
    scales: tuple[float, ...]
    prior: ParameterVector
    options: EstimatorOptions
    weights: tuple[FloatArray, ...] | None = None
    known: Known | None = field(default=None, repr=False, compare=False)

    @property
    def errors(self) -> tuple[TowErrors, ...]:
        """Errors of the readings, tow by tow."""
        known = self.known
        if known is None or known[0] is not self.windows or known[1] is not self.options:
            known = (self.windows, self.options, tow_errors(self.windows, self.options))
            object.__setattr__(self, 'known', known)
        return known[2]

    @property
    def net(self) -> FloatArray | None:
        """Most likely factors (2,) on drag and weight of the net; None where it is held."""
        std = self.options.net_std
        if not std.any():
            return None
        factors = np.zeros(2)
        if self.windows:
            errors = model_errors(self.options)
            factors = errors.clipped(self.elimination.model)[errors.slice_of('net')]
        return np.maximum(1.0 + std * factors, LEAST_FACTOR)

    @cached_property
    def residual(self) -> FloatArray:
        """Residuals (windows, k), measured minus predicted, to first order; 0 where unmeasured."""
        rows = [
            in_all_channels(linear, linear.measured - linear.predicted(self.coefficients))
            for linear in self.windows
        ]
        return np.array(rows).reshape(-1, len(GROUP_OF))

    @cached_property
    def inputs(self) -> FloatArray:
        """Most likely warp lengths and speed (windows, 3), corrected for their estimated errors."""
        measured = [measured_inputs(linear.window) for linear in self.windows]
        inputs = np.array(measured).reshape(-1, 3)
        for tow in self.elimination.tows:
            own = np.clip(tow.inputs[:, :3], -FARTHEST, FARTHEST)
            calibration = CALIBRATION.clipped(tow.calibration)
            errors = tow.errors
            inputs[errors.rows] += errors.input_std * own - errors.input_calibration @ calibration
        return inputs

    @cached_property
    def jacobian(self) -> FloatArray:
        """Sensitivities (windows, k, q) per prior std."""
        std = self.prior.std
        rows = [in_all_channels(linear, linear.by_coefficients * std) for linear in self.windows]
        return np.array(rows).reshape(-1, len(GROUP_OF), len(self.prior))

    @cached_property
    def elimination(self) -> NuisanceElimination:
        """Information after elimination of all nuisance parameters."""
        return self._eliminated(self.errors, self.jacobian)

    def _eliminated(
        self, errors: tuple[TowErrors, ...], jacobian: FloatArray
    ) -> NuisanceElimination:
        scales = np.array(self.scales)[GROUP_OF]
        huber = self.options.huber
        return eliminate_nuisance(errors, scales, self.residual, jacobian, huber, self.weights)

    @property
    def cost(self) -> float:
        """Robust loss of all windows plus half the squared departure from the prior."""
        return self.elimination.cost + self._prior_cost

    def cost_with_nuisance_of(self, other: 'Fit') -> float:
        """Cost with the nuisance parameters' effect taken from another fit of the same windows.

        A step is judged with this effect fixed, as the step itself was found.
        """
        return self._eliminated(other.errors, self.jacobian[:, :, :0]).cost + self._prior_cost

    @property
    def _prior_cost(self) -> float:
        away = self.prior.departure(self.coefficients)
        return float(0.5 * self.options.prior_weight * away @ away)

    def linear_problem(self, low: FloatArray, high: FloatArray) -> LinearProblem:
        """Linear problem of all windows, in prior std, the coefficients within bounds (q,).

        Its blocks are the tows: coefficients and the model's errors are shared, the errors of
        calibration are their own.
        """
        here, prior, found = self.prior.departure(self.coefficients), self.prior, self.elimination
        q, free = len(here), np.full(len(found.model), np.inf)
        blocks, places, precisions = [], [], []
        for tow in found.tows:
            rest = np.concatenate((found.model, tow.calibration))
            blocks.append(tow.information.about(np.concatenate((here, np.zeros(len(rest))))))
            places.append(np.concatenate((here, rest)))
            of_prior = np.full(q, self.options.prior_weight)
            precisions.append(np.concatenate((of_prior, np.ones(len(rest)))))
        return LinearProblem(
            blocks,
            precisions,
            places,
            np.concatenate((prior.departure(low), -free)),
            np.concatenate((prior.departure(high), free)),
            q,
        )

    @cached_property
    def posterior(self) -> Posterior:
        """Posterior covariance and singular directions."""
        known = self.elimination.coefficients.matrix
        return posterior_of(known, self.prior.std, self.options.prior_weight)

    @property
    def std(self) -> FloatArray:
        """Standard deviations (q,) of the coefficients."""
        return np.sqrt(np.diag(self.posterior.covariance))

    @cached_property
    def redundancy_numbers(self) -> FloatArray:
        """Redundancy numbers (windows, k) of the readings, for their own errors."""
        return redundancy_numbers(self.elimination, self.jacobian, self.posterior.root)

    @property
    def degrees_of_freedom(self) -> float:
        """Degrees of freedom: readings less all that they determine."""
        return float((self.redundancy_numbers * self._numbers).sum())

    @property
    def birge_ratio(self) -> float:
        """Birge ratio: root mean square of the residuals over their expected spread; at least 1.

        The least cost is half a χ² with as many degrees of freedom as there are readings. Noise is
        found, so a misfit is of what is not: inputs, calibration, the model's own error.
        """
        readings = float(self._numbers.sum())
        if self.options.prior_weight == 0.0:
            readings -= len(self.coefficients)
        return float(np.sqrt(max(1.0, 2.0 * self.cost / max(readings, 1.0))))

    @property
    def negative_log_likelihood(self) -> float:
        """Negative log-likelihood, up to a constant of the windows alone.

        Unlike costs, these compare between fits that have found different noise.
        """
        scales = np.array(self.scales)[GROUP_OF]
        return self.cost + float((self._numbers * np.log(scales)).sum())

    @property
    def _numbers(self) -> FloatArray:
        numbers = np.zeros(self.residual.shape)
        for tow in self.errors:
            numbers[tow.rows] = tow.numbers
        return numbers

    @cached_property
    def objective(self) -> float:
        """Eq. 35, to first order around the last solutions."""
        predicted, measured = [], []
        for linear in self.windows:
            values = linear.predicted(self.coefficients)
            if self.net is not None:
                values = values + linear.by_net @ (self.net - 1.0)
            predicted.append(paper_values(dict(zip(linear.channels, values, strict=True))))
            measured.append(paper_values(linear.window.means))
        return objective(stack(predicted), stack(measured))

    def rescaled(self) -> 'Fit':
        """Copy of the fit with each group's noise scale estimated from its residuals.

        Clipped squares over those expected of normal noise (Huber's proposal 2), per
        degree of freedom (restricted maximum likelihood). What all groups have in common is
        pooled with imagined readings that speak for the stated noise, each group with imagined
        readings that speak for what they have in common.
        """
        # Windows that share an error vary less than each of them is taken to.
        shares = np.clip(self.redundancy_numbers, 0.0, 1.0) * self._numbers
        huber, stated = self.options.huber, self.options.stated_noise_readings
        own = np.zeros(shares.shape)
        for tow in self.elimination.tows:
            own[tow.errors.rows] = tow.own
        clipped = np.minimum(np.abs(own), huber) ** 2
        # A share of nothing has no noise to tell of.
        limit = huber / np.sqrt(np.maximum(shares, 1e-12))
        expected = shares * clipped_variance(limit)
        numbers = np.array([shares[:, group == GROUP_OF].sum() for group in range(len(GROUPS))])
        known = np.array(
            [
                self.scales[group] ** 2 * clipped[:, columns].sum() / expected[:, columns].sum()
                if numbers[group] > 0.0
                else 0.0
                for group in range(len(GROUPS))
                for columns in [group == GROUP_OF]
            ]
        )
        common = (stated + numbers @ known) / (stated + numbers.sum())
        alike = self.options.alike_readings
        pooled = (alike * common + numbers * known) / (alike + numbers)
        found = np.maximum(np.sqrt(pooled), self.options.least_noise)
        return replace(self, scales=tuple(found.tolist()))
