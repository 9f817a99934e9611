# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Robust weights of means: those that no other mean of their channels bears out count less."""

import numpy as np
from scipy.linalg import cho_solve

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.information import LinearGroup
from trawl_ros.estimation.motion.processes import ErrorTimes


def robust_factors(
    group: LinearGroup,
    here: FloatArray,
    sizes: FloatArray,
    times: ErrorTimes,
    stated: FloatArray,
    huber: float,
) -> FloatArray:
    """Factors (m,) on the noise of a group's means by Huber's weights.

    Each residual is held against what all other means of the group make of it by the processes of
    their errors, so an outlier is one though the residuals around it are large alike.

    Parameters
    ----------
    group
        Rows of the group, with noise as it was weighted last.
    here
        Parameters (p,).
    sizes, times
        Of the errors.
    stated : (m,) array
        Noise without weights.
    huber
        Std beyond which a residual counts less.
    """
    if not len(group.residual):
        return np.ones(0)
    inverse = cho_solve((group.root(sizes, times), True), np.eye(len(group.residual)))
    diagonal = np.diag(inverse)
    away = inverse @ (group.residual - group.columns @ here) / diagonal
    # The weighted noise is in the variance of a mean about the others, and comes out again.
    own, weighted = (sizes[0] * stated) ** 2, (sizes[0] * group.rows.noise) ** 2
    variance = np.maximum(1.0 / diagonal - weighted + own, 1e-300)
    beyond = np.maximum(np.abs(away) / np.sqrt(variance) / huber - 1.0, 0.0)
    factors: FloatArray = np.sqrt(1.0 + beyond * variance / np.maximum(own, 1e-300))
    return factors
