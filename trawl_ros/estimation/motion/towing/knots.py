# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of inputs along a tow: hat functions on equal knots, with their covariance.

A log errs differently with each reading, and the gear feels its speed in all channels at once. The
course of that error is estimated along: its values at the knots are parameters, whose covariance
before the fit is that of a least-squares fit of the knots to the log's readings, and of a slow
error beside. A counter is wrong by another amount after each time that its winch has run: a
first-order Gauss-Markov process.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky_banded, solve_triangular

from trawl_ros.core.arrays import FloatArray


@dataclass(frozen=True)
class Knots:
    """Equal knots of one input's error, from the beginning of a tow on.

    Attributes
    ----------
    channel
        The input.
    number
        Of the knots.
    spacing_s
        Time between two of them: that of a stretch, or of several.
    columns
        Knots that act on the gear at one time: later ones have been forgotten by it.
    root : (number, number) array
        Root S of the covariance S Sᵀ of the errors (SI) at the knots.
    """

    channel: str
    number: int
    spacing_s: float
    columns: int
    root: FloatArray

    def hats(self, time: float) -> FloatArray:
        """Values (number,) of the hat functions at a time, s since the tow began."""
        values: FloatArray = hats(np.array([time]), self.number, self.spacing_s)[0]
        return values

    def hat_rates(self, time: float) -> FloatArray:
        """Rates of change (number,) of the hat functions up to a time, 1/s."""
        rates = np.zeros(self.number)
        before = min(max(int(np.ceil(time / self.spacing_s - 1e-9)) - 1, 0), self.number - 2)
        rates[before : before + 2] = -1.0 / self.spacing_s, 1.0 / self.spacing_s
        return rates

    def acting(self, time: float) -> range:
        """Knots that act at a time: from a spacing before them to where they are forgotten."""
        last = min(int(time / self.spacing_s) + 1, self.number - 1)
        return range(max(0, last - self.columns + 1), last + 1)


def hats(times: FloatArray, number: int, spacing_s: float) -> FloatArray:
    """Hat functions (n, number) at times (n,), s since the tow began."""
    away = np.abs(times[:, None] / spacing_s - np.arange(number))
    return np.maximum(0.0, 1.0 - away)


def knots_of_log(
    times: FloatArray,
    std: float,
    duration_s: float,
    spacing_s: float,
    memory_s: float,
    slow_std: float = 0.0,
    slow_time_s: float = 900.0,
) -> Knots:
    """Knots of a log's error.

    Parameters
    ----------
    times
        Of the log's readings (n,), s since the tow began.
    std
        Standard deviation of a reading, m/s.
    duration_s
        Of the tow.
    spacing_s, memory_s
        Time between knots; time after which the gear has forgotten an error.
    slow_std, slow_time_s
        Std (m/s) and correlation time of an error that no averaging wears down.
    """
    number = int(np.ceil(duration_s / spacing_s)) + 1
    rows = hats(times, number, spacing_s) / std
    normal = rows.T @ rows
    # Where the log is silent its error is a reading's, no more.
    banded = np.zeros((2, number))
    banded[0], banded[1, :-1] = np.diag(normal) + std**-2, np.diag(normal, 1)
    lower = cholesky_banded(banded, lower=True)
    factor = np.diag(lower[0]) + np.diag(lower[1, :-1], -1)
    root = solve_triangular(factor, np.eye(number), lower=True).T
    if slow_std:
        slow = slow_std**2 * np.exp(-_apart(number, spacing_s) / slow_time_s)
        root = np.linalg.cholesky(root @ root.T + slow)
    return Knots('speed', number, spacing_s, _columns(spacing_s, memory_s), root)


def knots_of_counter(
    channel: str, std: float, time_s: float, duration_s: float, spacing_s: float, memory_s: float
) -> Knots:
    """Knots of a counter's error, a process of a std (m) and a correlation time; else as above."""
    number = int(np.ceil(duration_s / spacing_s)) + 1
    root = std * np.linalg.cholesky(np.exp(-_apart(number, spacing_s) / time_s))
    return Knots(channel, number, spacing_s, _columns(spacing_s, memory_s), root)


def _apart(number: int, spacing_s: float) -> FloatArray:
    apart: FloatArray = spacing_s * np.abs(np.subtract.outer(np.arange(number), np.arange(number)))
    return apart


def _columns(spacing_s: float, memory_s: float) -> int:
    return int(np.ceil(memory_s / spacing_s)) + 2
