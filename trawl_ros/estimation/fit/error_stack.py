# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of tows with different numbers of windows as one stack, that all are worked on at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import TowErrors


@dataclass(frozen=True)
class ErrorStack:
    """Errors of all t tows of n windows at most.

    Tows with fewer windows are filled up with windows in which no channel is present.

    Attributes
    ----------
    present : (t, n, k) array
        1 for channels that are present, else 0.
    std : (t, n, k) array
        Of the reading's own error, noise scale included; 1 where there is none.
    inputs : (t, n, k, 4) array
        Change of the readings by errors of a window's inputs and rest, G.
    shared : (t, n, k, k) array
        G Gᵀ.
    columns : (t, n, k, q + m + p + 1) array
        Of the coefficients, the model's errors and calibration, and residuals.
    """

    present: FloatArray
    std: FloatArray
    inputs: FloatArray
    shared: FloatArray
    columns: FloatArray


def stacked(
    tows: Sequence[TowErrors], scales: FloatArray, residual: FloatArray, jacobian: FloatArray
) -> ErrorStack:
    """Stack the errors of tows.

    Given are noise scales (k,), residuals (windows, k) and sensitivities (windows, k, q).
    """
    n = max(len(tow.rows) for tow in tows)
    p, m, k = tows[0].calibration.shape[2], tows[0].model.shape[2], residual.shape[1]
    q = jacobian.shape[2]
    present = np.zeros((len(tows), n, k))
    std = np.ones(present.shape)
    inputs = np.zeros((*present.shape, tows[0].inputs.shape[2]))
    columns = np.zeros((*present.shape, q + m + p + 1))
    for place, tow in enumerate(tows):
        own = place, slice(len(tow.rows))
        present[own] = tow.present
        std[own] = np.where(tow.present, tow.noise * scales, 1.0)
        inputs[own] = tow.inputs
        columns[own][..., :q] = jacobian[tow.rows]
        columns[own][..., q : q + m] = tow.model
        columns[own][..., q + m : -1] = tow.calibration
        columns[own][..., -1] = residual[tow.rows]
    shared = inputs @ inputs.swapaxes(2, 3)
    return ErrorStack(present, std, inputs, shared, columns)
