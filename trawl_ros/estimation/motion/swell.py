# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Swell that a tow feels, by how its warps' tension swings within stretches."""

import numpy as np

from trawl_ros.estimation.motion.series import Series, TowReadings, about_line

TENSIONS = 'port_tension', 'starboard_tension'

FEWEST = 8
"""Readings of a stretch by which a swing is told, at least."""

LEAST = 0.01
"""Swing, in std over the mean, below which nothing is said of a swell: in a calm sea that of the
median stretch is below 0.001, and 2.3 to 4.7 % in a swell of 2.5 m in 10 s
(docs/studies/lessons.md)."""


def swell_of(read: TowReadings, stretch_s: float) -> float:
    """Swing of the tension beyond its noise, in std over its mean.

    Parameters
    ----------
    read
        Readings of a tow.
    stretch_s
        Length of a stretch.

    Returns
    -------
    float
        Swing of the median stretch, of the warp that swings more; 0 below `LEAST`, and where no
        tension is read often enough to tell waves from noise, once a second or so.
    """
    swings = [_swing(read.series[name], stretch_s) for name in TENSIONS if name in read.series]
    swell = max(swings, default=0.0)
    return swell if swell >= LEAST else 0.0


def _swing(tension: Series, stretch_s: float) -> float:
    breaks = np.flatnonzero(np.diff((tension.times / stretch_s).astype(int))) + 1
    parts = zip(np.split(tension.times, breaks), np.split(tension.values, breaks), strict=True)
    variances = [float(np.var(about_line(*part))) for part in parts if len(part[0]) >= FEWEST]
    if not variances:
        return 0.0
    # A winch that starts within a stretch bends its line; half of the stretches have none.
    excess = max(float(np.median(variances)) - tension.noise**2, 0.0)
    return float(np.sqrt(excess) / np.median(np.abs(tension.values)))
