# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Objective of eq. 35 and the errors in its four channels."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray


@dataclass(frozen=True)
class PaperChannel:
    """Channel of eq. 35: the mean of its ``observables``, in ``unit``.

    ``paper`` is the mean normalised absolute error that the paper has on the points it fitted.
    """

    name: str
    unit: str
    observables: tuple[str, ...]
    paper: float

    @property
    def words(self) -> str:
        """Name for texts."""
        return self.name.replace('_', ' ')


PAPER_CHANNELS = (
    PaperChannel('door_spread', 'm', ('door_spread',), 0.048),
    PaperChannel('door_depth', 'm', ('port_door_depth', 'starboard_door_depth'), 0.045),
    PaperChannel('warp_tension', 'N', ('port_tension', 'starboard_tension'), 0.026),
    PaperChannel('net_depth', 'm', ('net_depth',), 0.074),
)


def paper_values(values: Mapping[str, float]) -> FloatArray:
    """Quantities (4,) of eq. 35 from observables or means by name, NaN where one is missing."""
    return np.array(
        [np.mean([values.get(name, np.nan) for name in row.observables]) for row in PAPER_CHANNELS]
    )


def mnae(predicted: FloatArray, measured: FloatArray) -> FloatArray:
    """Mean normalised absolute error: mean absolute error over mean measured value, per channel.

    Parameters
    ----------
    predicted, measured
        Shape (n, 4); rows whose prediction is NaN (no steady state) are left out.

    Returns
    -------
    (4,) array, NaN where no row is left.
    """
    usable = np.all(np.isfinite(predicted), axis=1) if len(predicted) else np.zeros(0, bool)
    if not np.any(usable):
        return np.full(len(PAPER_CHANNELS), np.nan)
    error = np.abs(predicted[usable] - measured[usable]).mean(axis=0)
    normalised: FloatArray = error / np.abs(measured[usable]).mean(axis=0)
    return normalised


def weights(measured: FloatArray) -> FloatArray:
    """Weights λ (4,) of eq. 35: 1/(n · mean measured value), so every channel counts alike."""
    weights: FloatArray = 1.0 / (len(measured) * np.abs(measured).mean(axis=0))
    return weights


def objective(predicted: FloatArray, measured: FloatArray) -> float:
    """Eq. 35 with these weights: the sum of the four channels' errors as given by `mnae`."""
    usable = np.all(np.isfinite(predicted), axis=1) if len(predicted) else np.zeros(0, bool)
    if not np.any(usable):
        return float('nan')
    deviation = np.abs(predicted[usable] - measured[usable])
    return float(np.sum(weights(measured[usable]) * deviation))


def stack(rows: Sequence[FloatArray]) -> FloatArray:
    """Rows (4,) as one array (n, 4), also for n = 0."""
    return np.array(rows).reshape(-1, len(PAPER_CHANNELS))
