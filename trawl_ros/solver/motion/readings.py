# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Observables of a gear in motion and their derivatives."""

from dataclasses import dataclass

from trawl_ros.core.arrays import FloatArray


@dataclass(frozen=True)
class MotionPrediction:
    """Observables (n_observables,) of an instant and their derivatives (n_observables, m)."""

    values: FloatArray
    slopes: FloatArray
