# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Redundancy of readings: the share of their variance that is their own; roots of covariances."""

import numpy as np
from scipy.special import erf, ndtr

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.nuisance import NuisanceElimination
from trawl_ros.estimation.least_squares.information import extended_root


def redundancy_numbers(
    elimination: NuisanceElimination, jacobian: FloatArray, root: FloatArray
) -> FloatArray:
    """Redundancy numbers (windows, k): share of each reading's variance kept by its own error.

    The rest goes into inputs, calibration, the model's errors and the coefficients: diagonal of
    D P with P = V⁻¹ - V⁻¹ X C Xᵀ V⁻¹, where C is the posterior covariance of all those.

    Parameters
    ----------
    elimination
        From `eliminate_nuisance` with the same ``jacobian``.
    jacobian
        Sensitivities (windows, k, q) per prior std.
    root
        Of the posterior covariance (q, q) of the coefficients, S Sᵀ, in prior std.
    """
    shares = np.zeros(jacobian.shape[:2])
    for tow_part, every in zip(elimination.tows, tow_roots(elimination, root), strict=True):
        tow = tow_part.errors
        columns = np.concatenate((jacobian[tow.rows], tow.model, tow.calibration), axis=2)
        inverse = np.linalg.inv(tow_part.roots)
        known = inverse.transpose(0, 2, 1) @ (inverse @ (columns @ every))
        own = np.einsum('nij,nij->nj', inverse, inverse) - np.einsum('nkt,nkt->nk', known, known)
        shares[tow.rows] = np.where(tow.present, tow_part.std**2 / tow_part.weights * own, 0.0)
    return shares


def shared_root(elimination: NuisanceElimination, root: FloatArray) -> FloatArray:
    """Root (q + m, q + m) of the posterior covariance of coefficients and the model's errors.

    ``root`` (q, q) is that of the coefficients alone.
    """
    return extended_root(elimination.joined.matrix, elimination.joined.precision, root)


def tow_roots(elimination: NuisanceElimination, root: FloatArray) -> list[FloatArray]:
    """Roots (q + m + p, q + m + p) of the posterior covariance of all parameters of each tow."""
    shared = shared_root(elimination, root)
    found = []
    for tow in elimination.tows:
        precision = np.ones(len(tow.information.right))
        found.append(extended_root(tow.information.matrix, precision, shared))
    return found


def clipped_variance(limit: FloatArray) -> FloatArray:
    """Mean of min(|z|, limit)² for a standard normal z."""
    density = np.exp(-0.5 * limit**2) / np.sqrt(2.0 * np.pi)
    mean: FloatArray = erf(limit / np.sqrt(2.0)) + 2.0 * limit * (limit * ndtr(-limit) - density)
    return mean
