# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steps of the fit in motion: least squares within bounds, damped, and the cost of a place."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.bounded_step import bounded_step
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
        Of the boards' coefficients.
    sizes
        Of the errors.
    largest
        Largest change of a coefficient, in prior std.
    damping
        Weight of staying, as a part of what is known of each parameter before; 0 is Gauss-Newton.
    """
    shared, own = data.shared, slice(0, len(prior))
    low, high = np.full(shared, -np.inf), np.full(shared, np.inf)
    box = prior.box(prior.start + prior.std * here[0][own], largest)
    low[own], high[own] = (prior.departure(edge) for edge in box)
    # Water that goes with a board has no negative mass.
    low[own.stop], high[own.stop] = 0.0, MOST_ADDED_MASS / ADDED_MASS_STD
    precisions = data.precisions(sizes.log)
    return bounded_step(data.information(sizes), precisions, here, low, high, damping)


def cost(data: LinearData, here: Place, sizes: ErrorSizes) -> float:
    """Cost of parameters at the place where the tows are linearised."""
    precisions = data.precisions(sizes.log)
    total = 0.5 * float(np.sum(here[0][: data.shared] ** 2))
    for tow, z, precision in zip(data.information(sizes), here, precisions, strict=True):
        total += 0.5 * tow.squared_misfit(z)
        total += 0.5 * float(np.sum((precision * z**2)[data.shared :]))
    return float(total)


def misfit(data: LinearData, here: Place, sizes: ErrorSizes) -> float:
    """Root mean square of the whitened residuals."""
    squares, rows = 0.0, 0
    for groups, tow, z in zip(data.tows, data.information(sizes), here, strict=True):
        squares += tow.squared_misfit(z)
        rows += sum(len(group.residual) for group in groups)
    return float(np.sqrt(max(squares, 0.0) / max(rows, 1)))
