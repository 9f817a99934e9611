# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Noise density of each channel, estimated from the standard errors of steady windows."""

from collections.abc import Mapping, Sequence

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.estimation.windows.records import SteadyWindow


def noise_densities(windows: Sequence[SteadyWindow]) -> Mapping[str, float]:
    """Return the noise density d of each channel, in its unit per √Hz, two-sided.

    The mean over T seconds has the standard error σ = d / √T. The estimate of d² is the mean of
    σ² T over the windows. σ allows for the correlation of successive readings; the scatter of
    readings about their neighbours would miss it.

    Parameters
    ----------
    windows
        Steady windows of any tows. The estimate of a single window is poor, so all are averaged.
    """
    squares: dict[str, list[float]] = {}
    for window in windows:
        duration_s = (window.end_ns - window.start_ns) / SECOND
        for name, noise in window.noise.items():
            squares.setdefault(name, []).append(noise**2 * duration_s)
    return {name: float(np.sqrt(np.mean(densities))) for name, densities in squares.items()}
