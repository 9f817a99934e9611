# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Redundancy of readings: the share of their variance that is their own; roots of covariances."""

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import erf, ndtr

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.nuisance import NuisanceElimination, TowPart


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
    joint = joint_root(elimination, root)
    for tow_part in elimination.tows:
        tow = tow_part.errors
        p = tow_part.triangle.shape[0]
        upper = np.concatenate((tow.model, jacobian[tow.rows]), axis=2)
        solved = solve_triangular(tow_part.triangle[:, :p], np.eye(p))
        of_tow = tow.calibration @ solved
        of_upper = upper - of_tow @ tow_part.triangle[:, p:]
        terms = np.concatenate((of_tow, of_upper @ joint), axis=2)
        inverse = np.linalg.inv(tow_part.roots)
        known = inverse.transpose(0, 2, 1) @ (inverse @ terms)
        own = np.einsum('nij,nij->nj', inverse, inverse) - np.einsum('nkt,nkt->nk', known, known)
        shares[tow.rows] = np.where(tow.present, tow_part.std**2 / tow_part.weights * own, 0.0)
    return shares


def joint_root(elimination: NuisanceElimination, root: FloatArray) -> FloatArray:
    """Root (m + q, m + q) of the posterior covariance of the model's errors and coefficients.

    ``root`` (q, q) is that of the coefficients alone.
    """
    m, q = len(elimination.model), len(root)
    solved = solve_triangular(elimination.model_triangle[:, :m], np.eye(m))
    joint = np.zeros((m + q, m + q))
    joint[:m, :m] = solved
    joint[:m, m:] = -solved @ elimination.model_triangle[:, m:] @ root
    joint[m:, m:] = root
    return joint


def calibration_root(tow_part: TowPart, joint: FloatArray) -> FloatArray:
    """Root (p, p + m + q) of the posterior covariance of a tow's errors of calibration.

    ``joint`` is from `joint_root`.
    """
    p = len(tow_part.triangle)
    solved = solve_triangular(tow_part.triangle[:, :p], np.eye(p))
    return np.hstack((solved, -solved @ tow_part.triangle[:, p:] @ joint))


def clipped_variance(limit: FloatArray) -> FloatArray:
    """Mean of min(|z|, limit)² for a standard normal z."""
    density = np.exp(-0.5 * limit**2) / np.sqrt(2.0 * np.pi)
    mean: FloatArray = erf(limit / np.sqrt(2.0)) + 2.0 * limit * (limit * ndtr(-limit) - density)
    return mean
