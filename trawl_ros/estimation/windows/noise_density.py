# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Noise density of each channel: what averaging over a time leaves, as steady windows show it."""

from collections.abc import Mapping, Sequence

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.estimation.windows.records import SteadyWindow


def noise_densities(windows: Sequence[SteadyWindow]) -> Mapping[str, float]:
    """Noise densities of all channels, in their unit by √Hz, of both signs of the frequency.

    The mean over T seconds is wrong by the density over √T. Errors that neighbouring readings share
    are in it, as in the errors of the windows' means; the scatter of a reading about its neighbours
    does not show them.

    Parameters
    ----------
    windows
        Of any tows; each of thirty or more readings tells its own noise badly, all together well.
    """
    squares: dict[str, list[float]] = {}
    for window in windows:
        duration_s = (window.end_ns - window.start_ns) / SECOND
        for name, noise in window.noise.items():
            squares.setdefault(name, []).append(noise**2 * duration_s)
    return {name: float(np.sqrt(np.mean(own))) for name, own in squares.items()}
