"""Course of a measured quantity through a haul, without its sensor's errors."""

import numpy as np

from studies.instruments.survey import Series
from trawl_ros.core.arrays import FloatArray

COURSE_S, NEAR_S = 60.0, 30.0
"""Half widths (s) of the running medians that are taken for the truth, and for what readings
scatter about."""

STEADY_PART = 0.15
"""Towing is where the running median is within this part of that of the middle of the haul."""

EDGE_S = 60.0


def running_median(time: FloatArray, value: FloatArray, half_s: float) -> FloatArray:
    """Return the median (n,) of the readings within ``half_s`` of each."""
    first = np.searchsorted(time, time - half_s)
    last = np.searchsorted(time, time + half_s, side='right')
    return np.array([np.median(value[i:j]) for i, j in zip(first, last, strict=True)])


def towing(series: Series) -> tuple[float, float]:
    """Return the begin and end (s) of the part in which the net is towed, not shot or hauled."""
    time, value = series.time, series.value
    since = (time - time[0]) / (time[-1] - time[0])
    level = np.median(value[(since > 0.3) & (since < 0.7)])
    course = running_median(time, value, NEAR_S)
    there = time[np.abs(course - level) < STEADY_PART * level]
    if len(there) and there[-1] - there[0] > 2.0 * EDGE_S:
        return float(there[0]) + EDGE_S, float(there[-1]) - EDGE_S
    return float(time[0]), float(time[-1])


def course_of(series: Series) -> tuple[FloatArray, FloatArray]:
    """Return times (s) and values (m) of the course that is taken for the truth of a haul."""
    return series.time, running_median(series.time, series.value, COURSE_S)
