# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Step of a bounded least-squares problem whose parameters have unit normal priors."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import cholesky

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.least_squares.information import Information, joined, own_values


def bounded_step(
    blocks: Sequence[Information],
    precisions: Sequence[FloatArray],
    here: Sequence[FloatArray],
    low: FloatArray,
    high: FloatArray,
    damping: float = 0.0,
) -> list[FloatArray]:
    """Levenberg-Marquardt step of all parameters, the shared ones within bounds.

    Parameters
    ----------
    blocks, precisions
        Information of each block of data, and prior precisions (p,) of its parameters.
    here
        Parameters (p,) of each block at which it is linearised.
    low, high : (s,) arrays
        Bounds of the shared parameters, the first of each block.
    damping
        Weight of staying, as a part of the prior precision; 0 is Gauss-Newton.

    Returns
    -------
    list of (p,) arrays
        Parameters of each block after the step.
    """
    shared = len(low)
    if damping:
        each = zip(blocks, precisions, here, strict=True)
        blocks = [block.damped(precision, at, damping) for block, precision, at in each]
    found = joined(blocks, precisions, shared)
    triangle = cholesky(found.matrix + np.eye(shared))
    right = np.linalg.solve(triangle.T, found.right)
    # Imported here: it takes a node's start long, and no node steps before a tow has begun.
    from scipy.optimize import lsq_linear

    common = lsq_linear(triangle, right, (low, high), 'bvls', max_iter=300).x
    return [
        np.concatenate((common, own_values(block, precision, common)))
        for block, precision in zip(blocks, precisions, strict=True)
    ]


def shared_std(
    blocks: Sequence[Information], precisions: Sequence[FloatArray], shared: int
) -> FloatArray:
    """Posterior std (s,) of the shared parameters, in prior std."""
    found = joined(blocks, precisions, shared)
    return np.sqrt(np.diag(np.linalg.inv(found.matrix + np.eye(shared))))
