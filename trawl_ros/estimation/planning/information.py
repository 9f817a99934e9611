# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Information of planned windows on the board's coefficients.

Windows share errors of calibration of the tow and errors of the model. With these among the
unknowns, the information of windows adds up, so a plan adds or drops a window at little cost.
The order is coefficients, model, calibration, as in a fit; each is in units of its prior std.
"""

from collections.abc import Sequence

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import CALIBRATION, GROUP_OF, model_errors
from trawl_ros.estimation.fit.estimate import posterior_of
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import AS_STATED, Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.information import LEAST_PRECISION, joined


def unknowns(prior: ParameterVector, options: EstimatorOptions) -> ParameterVector:
    """Return the unknowns of a tow: coefficients, errors of the model, errors of calibration."""
    return prior.followed_by(model_errors(options)).followed_by(CALIBRATION)


def information_of(
    linearised: Sequence[Linearised],
    prior: ParameterVector,
    options: EstimatorOptions,
    scales: Sequence[float] = AS_STATED,
) -> FloatArray:
    """Return the information matrix (u, u) on the u `unknowns` of windows in one steady state.

    Parameters
    ----------
    linearised
        All windows expected in the state.
    prior
        Prior of the coefficients, whose std is their scale.
    options
        Division of the errors.
    scales
        Factors on the stated noise, by group of channels.
    """
    weights = (np.ones((len(linearised), len(GROUP_OF))),)
    windows, at = tuple(linearised), linearised[0].at
    (tow,) = Fit(windows, at, tuple(scales), prior, options, weights).elimination.tows
    return tow.information.matrix


def information_before(prior: ParameterVector, options: EstimatorOptions) -> FloatArray:
    """Return the prior's information matrix (u, u) on the `unknowns`."""
    weights = np.ones(len(unknowns(prior, options)))
    # Without a prior, a std of a million keeps the matrix invertible.
    weights[: len(prior)] = max(options.prior_weight, LEAST_PRECISION)
    return np.diag(weights)


def information_in(fit: Fit) -> FloatArray:
    """Return the information matrix (u, u) of a fit on the `unknowns` of its newest tow.

    Calibration of its other tows is eliminated.

    Parameters
    ----------
    fit
        Fit of at least one window.
    """
    *others, newest = (tow.information for tow in fit.elimination.tows)
    information = newest.matrix + information_before(fit.prior, fit.options)
    if others:
        shared = len(information) - len(CALIBRATION)
        ones = np.ones(len(information))
        information[:shared, :shared] += joined(others, [ones] * len(others), shared).matrix
    return information


def covariance_from(information: FloatArray, prior: ParameterVector) -> FloatArray:
    """Return the covariance (q, q) of the coefficients from an information matrix (u, u)."""
    q = len(prior)
    less = information[:q, q:] @ np.linalg.solve(information[q:, q:], information[q:, :q])
    # The prior is in the information already.
    return posterior_of(information[:q, :q] - less, prior.std, 0.0).covariance
