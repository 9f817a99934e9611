# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Information matrices of windows, with the errors that windows share as unknowns.

Windows share errors of calibration of the tow and errors of the model. With these among the
unknowns, the information of windows adds up, so a plan adds or drops a window at little cost.
The order is calibration, model, coefficients; each is in units of its prior std. The estimator
computes the same (`trawl_ros.estimation.fit.nuisance`).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import solve_triangular

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import CALIBRATION, GROUP_OF, Scheme
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import AS_STATED, Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.information import joined


def unknowns(prior: ParameterVector, options: EstimatorOptions) -> ParameterVector:
    """Return the unknowns of a tow: errors of calibration, errors of the model, coefficients."""
    return CALIBRATION.followed_by(Scheme.of(options).model_errors).followed_by(prior)


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
        Scheme of the errors.
    scales
        Factors on the stated noise, by group of channels.
    """
    fit = Fit(tuple(linearised), linearised[0].at, tuple(scales), prior, options)
    (errors,) = fit.errors
    # Whiten the columns by errors of readings and of measured inputs, which no window shares.
    std = np.where(errors.present, errors.noise * np.array(scales)[GROUP_OF], 1.0)
    variance = std[:, :, None] ** 2 * np.eye(std.shape[1])
    root = np.linalg.cholesky(variance + errors.inputs @ errors.inputs.transpose(0, 2, 1))
    columns = np.concatenate((errors.calibration, errors.model, fit.jacobian), axis=2)
    rows = np.linalg.solve(root, columns).reshape(-1, columns.shape[2])
    information: FloatArray = rows.T @ rows
    return information


def information_before(prior: ParameterVector, options: EstimatorOptions) -> FloatArray:
    """Return the prior's information matrix (u, u) on the `unknowns`."""
    # Without a prior, a std of a million keeps the matrix invertible.
    among = unknowns(prior, options)
    weights = np.ones(len(among))
    weights[among.slice_of('coefficients')] = max(options.prior_weight, 1e-12)
    return np.diag(weights)


def information_in(fit: Fit) -> FloatArray:
    """Return the information matrix (u, u) of a fit on the `unknowns` of its newest tow.

    Calibration of its other tows is eliminated.

    Parameters
    ----------
    fit
        Fit of at least one window.
    """
    elimination = fit.elimination
    *others, newest = elimination.tows
    among = unknowns(fit.prior, fit.options)
    board = among.slice_of('coefficients')
    # The order of the estimator is coefficients, model, calibration.
    order = np.concatenate(
        (
            np.arange(len(among) - len(CALIBRATION), len(among)),
            np.arange(len(fit.prior), len(among) - len(CALIBRATION)),
            np.arange(len(fit.prior)),
        )
    )
    before = np.ones(len(among))
    before[board] = max(fit.options.prior_weight, 1e-12)
    information = newest.information.matrix[np.ix_(order, order)] + np.diag(before)
    if others:
        shared = len(among) - len(CALIBRATION)
        blocks = [tow.information for tow in others]
        of_others = joined(blocks, [np.ones(len(among))] * len(blocks), shared).matrix
        place = order[len(CALIBRATION) :]
        information[len(CALIBRATION) :, len(CALIBRATION) :] += of_others[np.ix_(place, place)]
    return information


def covariance_from(information: FloatArray, prior: ParameterVector) -> FloatArray:
    """Return the covariance (q, q) of the coefficients from an information matrix (u, u)."""
    root = np.linalg.cholesky(information)
    # Information = L Lᵀ, so the last block of its inverse needs only the last block of L.
    number = len(prior)
    inverse = solve_triangular(root[-number:, -number:], np.eye(number), lower=True)
    covariance: FloatArray = inverse.T @ inverse * np.outer(prior.std, prior.std)
    return covariance


def fitted_covariance(
    linearised: Sequence[Linearised],
    coefficients: FloatArray,
    prior: ParameterVector,
    options: EstimatorOptions,
) -> FloatArray:
    """Return the posterior covariance (q, q) that the estimator would give with these windows."""
    numbered = tuple(
        replace(linear, window=replace(linear.window, index=index))
        for index, linear in enumerate(linearised)
    )
    return Fit(numbered, coefficients, AS_STATED, prior, options).posterior.covariance
