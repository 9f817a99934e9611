# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rows of a comparison, measured and reference values of all channels, and their errors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.estimation.fit.error_terms import TowErrors


@dataclass(frozen=True)
class ErrorBudget:
    """Errors of the differences of n rows by k channels, as changes by one std.

    Attributes
    ----------
    own : (n, k) array
        Std of the error that a difference shares with no other.
    by_row : (n, k, p) array
        Errors that the channels of one row share, such as those of warp lengths and speed.
    shared
        Errors that rows share: (m,) indices of rows, and an (m, k, p) array.
    """

    own: FloatArray
    by_row: FloatArray
    shared: Sequence[tuple[IntArray, FloatArray]]

    @classmethod
    def of_tows(cls, tows: Sequence[TowErrors]) -> 'ErrorBudget':
        """Return the budget of the fit: readings, inputs, calibration by tow, and the model."""
        rows = np.concatenate([tow.rows for tow in tows])
        order = np.argsort(rows)
        model = np.concatenate([tow.model for tow in tows])
        own = np.concatenate([np.where(tow.present, tow.noise, 0.0) for tow in tows])
        inputs = np.concatenate([tow.inputs for tow in tows])
        calibration = [(tow.rows, tow.calibration) for tow in tows]
        return cls(own[order], inputs[order], [*calibration, (rows, model)])

    def covariance(self, weights: FloatArray) -> FloatArray:
        """Return the covariance (q, q) of weighted sums of differences, weights (q, n, k)."""
        own = (weights * self.own).reshape(len(weights), -1)
        by_row = np.einsum('qnk,nkp->qnp', weights, self.by_row).reshape(len(weights), -1)
        parts = [own, by_row]
        parts += [np.einsum('qnk,nkp->qp', weights[:, rows], of) for rows, of in self.shared]
        root = np.concatenate(parts, axis=1)
        covariance: FloatArray = root @ root.T
        return covariance


@dataclass(frozen=True)
class Rows:
    """Rows of a comparison: n steady minutes or stretches by k channels, SI.

    Attributes
    ----------
    channels
        Names of the k channels.
    state, log : (n,) int arrays
        State that a row belongs to, from 0, and the log that the state is from.
    hours : (n,) array
        Time from the start of its log, h.
    inputs : (n, 3) array
        Measured warp lengths (m), port and starboard, and speed (m/s).
    measured, reference : (n, k) arrays
        Values that are compared, 0 where absent.
    present : (n, k) bool array
        True if the row has the channel.
    errors
        Errors of the differences.
    by_coefficients : (n, k, 12) array or None
        Change of the reference by the board's coefficients, per std of their prior.
    """

    channels: tuple[str, ...]
    state: IntArray
    log: IntArray
    hours: FloatArray
    inputs: FloatArray
    measured: FloatArray
    reference: FloatArray
    present: BoolArray
    errors: ErrorBudget
    by_coefficients: FloatArray | None = None

    @property
    def difference(self) -> FloatArray:
        """Measured minus reference (n, k)."""
        return np.where(self.present, self.measured - self.reference, 0.0)

    def by_state(self, column: int) -> tuple[FloatArray, IntArray]:
        """Return averages over the states that have a channel.

        Returns
        -------
        (s, n) array
            Weight of each row in the mean of each state.
        (s,) array
            The states.
        """
        present = self.present[:, column]
        states = np.unique(self.state[present])
        mine = (self.state == states[:, None]) & present
        weights: FloatArray = mine / mine.sum(axis=1, keepdims=True)
        return weights, states
