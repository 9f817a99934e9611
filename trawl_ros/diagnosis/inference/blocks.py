# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Adapter from the estimator to the inference: whitened rows of each tow.

All that the inference knows of readings passes through here, so that another estimator takes the
place of this one by another `blocks_of`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import GROUP_OF, GROUPS, TowErrors, in_all_channels
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.records.channels import MEASURED


@dataclass(frozen=True)
class ErrorSize:
    """Size of what readings do not tell of themselves; fitted on trials of development seeds.

    Attributes
    ----------
    calibration
        Factor on the stated errors of calibration, and of warp lengths and speed.
    model
        Factor on the error of the model.
    form
        Error of the form of a cause, as a part of what it changes, in each quantity.
    """

    calibration: float = 1.2
    model: float = 1.2
    form: float = 0.1


@dataclass(frozen=True)
class Blocks:
    """Whitened rows of all tows.

    Attributes
    ----------
    residual : (n,) array
        Readings minus model, at the prior mean of the boards and the start of the hypotheses.
    shared : (n, p) array
        Change by one prior std of each nuisance that all tows share: boards, error of the model.
    columns : (n, q) array
        Change by one unit of each value of the hypotheses.
    log_det
        Logarithm of the determinant of the root that whitens.
    """

    residual: FloatArray
    shared: FloatArray
    columns: FloatArray
    log_det: float


def blocks_of(
    fit: Fit,
    columns: Sequence[FloatArray],
    *,
    errors: ErrorSize,
    weights: Sequence[FloatArray] | None = None,
    tows: Sequence[TowErrors] | None = None,
    away: FloatArray | None = None,
    form: Sequence[FloatArray] = (),
) -> Blocks:
    """Whiten the rows of a fit.

    Parameters
    ----------
    fit
        Fit of boards, with noise as it counts; its windows may have more than boards' columns.
    columns
        For each window (channels, q): change by one unit of each value.
    errors
        Size of errors that readings do not tell.
    weights
        Huber weights of each tow; 1 if None.
    tows
        Errors of those tows that count; all if None.
    away
        Departure (q,) of the values from the start, where the fit was linearised; 0 if None.
    form
        For each window (channels, f): change by one std of each error of form.
    """
    boards = fit.prior.slice_of('coefficients')
    windows, channels = fit.residual.shape
    number = columns[0].shape[1]
    values = np.zeros((windows, channels, number))
    forms = np.zeros((windows, channels, form[0].shape[1] if form else 0))
    for row, (linear, own) in enumerate(zip(fit.windows, columns, strict=True)):
        values[row] = in_all_channels(linear, own)
        if form:
            forms[row] = in_all_channels(linear, form[row])
    board = fit.jacobian[:, :, boards]
    residual = fit.residual + board @ fit.prior.departure(fit.coefficients)[boards]
    if away is not None:
        residual = residual + values @ away
    scales = np.array(fit.scales)[GROUP_OF]
    parts, log_det = [], 0.0
    for place, tow in enumerate(fit.errors if tows is None else tows):
        rows, shown = tow.rows, tow.present.ravel()
        weight = np.ones(tow.noise.shape) if weights is None else weights[place]
        root = np.linalg.cholesky(_covariance(tow, scales, weight, errors)[np.ix_(shown, shown)])
        model = errors.model * tow.model.reshape(len(shown), -1)
        every = np.column_stack(
            [
                residual[rows].ravel(),
                board[rows].reshape(len(shown), -1),
                model,
                forms[rows].reshape(len(shown), -1),
                values[rows].reshape(len(shown), -1),
            ]
        )[shown]
        parts.append(solve_triangular(root, every, lower=True))
        log_det += float(np.log(np.diag(root)).sum())
    whole: FloatArray = np.vstack(parts)
    last = whole.shape[1] - number
    return Blocks(whole[:, 0], whole[:, 1:last], whole[:, last:], log_det)


def _covariance(
    tow: TowErrors, scales: FloatArray, weight: FloatArray, errors: ErrorSize
) -> FloatArray:
    """Covariance (n k, n k) of the readings of a tow, without what all tows share."""
    windows, channels = tow.noise.shape
    number = windows * channels
    covariance = np.diag((scales * tow.noise).ravel() ** 2 / weight.ravel())
    calibration = errors.calibration * tow.calibration.reshape(number, -1)
    covariance += calibration @ calibration.T
    for row, inputs in enumerate(errors.calibration * tow.inputs):
        place = slice(row * channels, (row + 1) * channels)
        covariance[place, place] += inputs @ inputs.T
    return covariance


def form_errors(fit: Fit, changed: Sequence[FloatArray], part: float) -> list[FloatArray]:
    """Errors of the form of a cause: a part of its change, by quantity, throughout and by length.

    Parameters
    ----------
    fit
        Fit with windows as they are counted.
    changed
        For each window (channels,): change of its readings by the cause.
    part
        Std, as a part of the change.
    """
    length = np.array([np.log(linear.inputs[:2].mean()) for linear in fit.windows])
    spread = float(length.std())
    trend = (length - length.mean()) / spread if spread > 1e-9 else np.zeros(len(length))
    found = []
    for linear, change, longer in zip(fit.windows, changed, trend, strict=True):
        groups = GROUP_OF[[MEASURED.index(name) for name in linear.channels]]
        own = np.zeros((len(change), len(GROUPS)))
        own[np.arange(len(change)), groups] = part * change
        found.append(np.hstack((own, longer * own)))
    return found
