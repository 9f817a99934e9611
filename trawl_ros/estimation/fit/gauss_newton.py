# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Gauss–Newton step of the linearised fit, iterated with weights and noise scales.

Weights of a robust loss, noise found from residuals and coefficients depend on each other, and
come to rest together in some ten rounds. On the linearised windows a round costs next to nothing.
"""

from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.nuisance import reweighted

ROUNDS = 30
"""A guard; what is left to do is seen when the model has been solved anew."""

SETTLED = 1e-3
"""Steps below this part of every coefficient's std, and factors on the noise that change by less,
are the end."""


def gauss_newton_step(fit: Fit, low: FloatArray, high: FloatArray) -> Fit:
    """Gauss–Newton step: the fit of least cost within bounds, to first order around its windows.

    Parameters
    ----------
    fit
        Start of the step, inside the box.
    low, high
        The box (12,).

    Returns
    -------
    Fit
        With coefficients and noise that belong together.
    """
    std = fit.prior.std
    here = fit.rescaled()
    # Imported here: it takes a node's start long, and nothing is fitted before the first window.
    from scipy.optimize import lsq_linear

    for _ in range(ROUNDS):
        triangle, right = here.system
        box = ((low - here.coefficients) / std, (high - here.coefficients) / std)
        move = lsq_linear(triangle, right, box, 'bvls', max_iter=200).x * std
        size = float(np.max(np.abs(move) / here.std))
        coefficients = np.clip(here.coefficients + move, low, high)
        weights = reweighted(here.elimination, fit.options.huber)
        moved = replace(here, coefficients=coefficients, weights=weights).rescaled()
        change = np.max(np.abs(np.array(moved.scales) / np.array(here.scales) - 1.0))
        here = moved
        if size < SETTLED and change < SETTLED:
            break
    return replace(here, weights=None)
