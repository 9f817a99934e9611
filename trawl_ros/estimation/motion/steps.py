# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Linear problem of the fit in motion, its coefficients within bounds."""

import numpy as np

from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.linear_problem import LinearProblem, Place
from trawl_ros.estimation.motion.nuisances import ADDED_MASS_STD
from trawl_ros.estimation.motion.processes import ErrorSizes
from trawl_ros.estimation.motion.sizes import LinearData

MOST_ADDED_MASS = 2.0
"""Bound on the boards' added mass, as a part of the cylinder of water around them."""


def linear_problem(
    data: LinearData, here: Place, prior: ParameterVector, sizes: ErrorSizes, largest: float
) -> LinearProblem:
    """Linear problem of tows.

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
    """
    shared, own = data.shared, slice(0, len(prior))
    low, high = np.full(shared, -np.inf), np.full(shared, np.inf)
    box = prior.box(prior.start + prior.std * here[0][own], largest)
    low[own], high[own] = (prior.departure(edge) for edge in box)
    # Water that goes with a board has no negative mass.
    low[own.stop], high[own.stop] = 0.0, MOST_ADDED_MASS / ADDED_MASS_STD
    precisions = data.precisions(sizes.log)
    return LinearProblem(data.information(sizes), precisions, here, low, high, len(prior))


def misfit(data: LinearData, problem: LinearProblem, place: Place) -> float:
    """Root mean square of the whitened residuals of a linear problem."""
    rows = sum(len(group.residual) for groups in data.tows for group in groups)
    return float(np.sqrt(problem.squared_misfit(place) / max(rows, 1)))
