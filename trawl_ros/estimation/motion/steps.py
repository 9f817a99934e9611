"""Steps of the fit in motion: least squares within bounds, damped, and the cost of a place."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import cholesky

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.information import Information, joined, own_values
from trawl_ros.estimation.motion.nuisances import ADDED_MASS_STD
from trawl_ros.estimation.motion.processes import ErrorSizes
from trawl_ros.estimation.motion.sizes import LinearData

MOST_ADDED_MASS = 2.0
"""Bound on the boards' added mass, as a part of the cylinder of water around them."""

Place = Sequence[FloatArray]
"""Parameters (p,) of each tow, in units of their prior std."""


def step(
    data: LinearData,
    here: Place,
    prior: ParameterVector,
    sizes: ErrorSizes,
    largest: float,
    damping: float = 0.0,
) -> list[FloatArray]:
    """Levenberg-Marquardt step of all parameters, its coefficients within bounds.

    Parameters
    ----------
    data
        Linearised tows.
    here
        Place where they are linearised.
    prior
        Of the twelve coefficients.
    sizes
        Of the errors.
    largest
        Largest change of a coefficient, in prior std.
    damping
        Weight of staying, as a part of what is known of each parameter before; 0 is Gauss-Newton.
    """
    shared = data.shared
    tows, precisions = data.information(sizes), data.precisions(sizes.log)
    if damping:
        pairs = [_damped(*each, damping) for each in zip(tows, precisions, here, strict=True)]
        tows = pairs
    found = joined(tows, precisions, shared)
    triangle = cholesky(found.matrix + np.eye(shared))
    right = np.linalg.solve(triangle.T, found.right)
    low, high = np.full(shared, -np.inf), np.full(shared, np.inf)
    box = prior.box(prior.start + prior.std * here[0][:12], largest)
    low[:12], high[:12] = (prior.departure(edge) for edge in box)
    # Water that goes with a board has no negative mass.
    low[12], high[12] = 0.0, MOST_ADDED_MASS / ADDED_MASS_STD
    # Imported here: it takes a node's start long, and no node fits a tow in motion.
    from scipy.optimize import lsq_linear

    common = lsq_linear(triangle, right, (low, high), 'bvls', max_iter=300).x
    return [
        np.concatenate((common, own_values(tow, precision, common)))
        for tow, precision in zip(tows, precisions, strict=True)
    ]


def _damped(tow: Information, precision: FloatArray, z: FloatArray, damping: float) -> Information:
    """Information of a tow with that of staying at a place (p,) beside it."""
    # By the prior's std: by what the data know, a step along what several parameters share all but
    # ends, since each of them alone seems well known.
    stays = damping * precision
    return tow + Information(np.diag(stays), stays * z, 0.0, 0.0)


def shared_std(data: LinearData, sizes: ErrorSizes) -> FloatArray:
    """Posterior std (s,) of the shared parameters, in prior std."""
    found = joined(data.information(sizes), data.precisions(sizes.log), data.shared)
    return np.sqrt(np.diag(np.linalg.inv(found.matrix + np.eye(data.shared))))


def cost(data: LinearData, here: Place, sizes: ErrorSizes) -> float:
    """Cost of parameters at the place where the tows are linearised."""
    precisions = data.precisions(sizes.log)
    total = 0.5 * float(np.sum(here[0][: data.shared] ** 2))
    for tow, z, precision in zip(data.information(sizes), here, precisions, strict=True):
        total += 0.5 * (tow.square + float(z @ (tow.matrix @ z - 2.0 * tow.right)))
        total += 0.5 * float(np.sum((precision * z**2)[data.shared :]))
    return float(total)


def misfit(data: LinearData, here: Place, sizes: ErrorSizes) -> float:
    """Root mean square of the whitened residuals."""
    squares, rows = 0.0, 0
    for groups, tow, z in zip(data.tows, data.information(sizes), here, strict=True):
        squares += tow.square + float(z @ (tow.matrix @ z - 2.0 * tow.right))
        rows += sum(len(group.residual) for group in groups)
    return float(np.sqrt(max(squares, 0.0) / max(rows, 1)))
