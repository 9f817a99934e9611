# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Statistics of correlated readings: means, their errors, trends, outliers and stuck sensors."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtr

from trawl_ros.core.arrays import BoolArray, FloatArray

MAD_TO_STD = 1.4826

MOST_CORRELATED = 3.0
"""The variance of a mean is at most this many times that of a reading about it: a window that is
not longer than its noise is slow cannot tell."""


def effective_number(values: FloatArray) -> float:
    """Effective number of independent readings in ``values`` (n,).

    From the lag-1 autocorrelation ρ as n (1 − ρ)/(1 + ρ), with Kendall's correction of the
    estimate's bias in short series. Negative ρ is not credited.
    """
    n = len(values)
    if n < 4:
        return float(n)
    deviation = values - values.mean()
    power = float(deviation @ deviation)
    # A constant is a sensor's quantum, not evidence of correlation.
    if power <= 1e-24 * n * (1.0 + float(np.max(np.abs(values))) ** 2):
        return float(n)
    rho = float(deviation[1:] @ deviation[:-1]) / power
    rho += (1.0 + 4.0 * rho) / n
    rho = min(max(rho, 0.0), 0.98)
    return max(1.0, n * (1.0 - rho) / (1.0 + rho))


def error_of_mean(values: FloatArray, stated: float) -> float:
    """Standard error of the mean of ``values`` (n,), ``stated`` std used when they are few.

    Autocovariances are summed as long as those of two successive lags together are positive
    (Geyer's initial positive sequence), so that a slow part beneath white noise counts, which the
    first lag alone does not show. Each is raised by the variance of the mean itself, which
    deviations from the mean have lost.
    """
    n = len(values)
    scatter = float(np.std(values, ddof=1)) if n > 1 else 0.0
    if n < 8 or scatter == 0.0:
        return max(scatter, stated) / math.sqrt(effective_number(values))
    deviation = values - values.mean()
    covariance = np.correlate(deviation, deviation, 'full')[n - 1 :] / n
    pairs = covariance[: n - n % 2].reshape(-1, 2).sum(axis=1)
    lags = 2 * (len(pairs) if np.all(pairs > 0.0) else int(np.argmax(pairs <= 0.0)))
    least, most = scatter**2 / n, MOST_CORRELATED * covariance[0]
    # The variance of the mean is (Σ over the lags of both signs of what the mean left + itself)/n.
    summed = 2.0 * float(covariance[:lags].sum()) - covariance[0]
    share = (2 * lags - 1) / n
    variance = summed / n / (1.0 - share) if share < 1.0 else most
    return math.sqrt(min(max(variance, least), most))


@dataclass(frozen=True)
class Trend:
    """Trend of a series.

    It is the change over the series by its fitted slope, the two-sided p-value, and the std of
    the change.
    """

    drift: float
    p_value: float
    error: float = 0.0

    @property
    def beyond_noise(self) -> float:
        """Drift in excess of its noise: root of its square less its error's square."""
        return math.sqrt(max(0.0, self.drift**2 - self.error**2))


def trend(seconds: FloatArray, values: FloatArray) -> Trend:
    """Linear trend of ``values`` (n,) at ``seconds`` (n,), tested against its noise.

    The degrees of freedom and the slope's error use the effective number of readings of the
    residual, so a slow wander of the sensor is not taken for a trend of the gear.
    """
    n = len(values)
    span = float(seconds[-1] - seconds[0]) if n else 0.0
    if n < 6 or span <= 0.0:
        return Trend(0.0, 1.0)
    time = seconds - seconds.mean()
    slope = float(time @ values) / float(time @ time)
    residual = values - values.mean() - slope * time
    number = effective_number(residual)
    freedom = max(number - 2.0, 1.0)
    variance = float(residual @ residual) / n * number / freedom
    error = math.sqrt(variance * n / number / float(time @ time))
    if error <= 1e-12 * (abs(slope) + 1e-300):
        return Trend(slope * span, 0.0 if slope else 1.0)
    p_value = float(2.0 * stdtr(freedom, -abs(slope) / error))
    return Trend(slope * span, p_value, error * span)


def outliers(values: FloatArray, stated: float, limit: float) -> BoolArray:
    """Mask (n,) of values further than ``limit`` robust std from the median (Hampel).

    Half the stated std is the least spread assumed: a quantised sensor has a median
    absolute deviation of 0.
    """
    distance = np.abs(values - np.median(values))
    spread = max(MAD_TO_STD * float(np.median(distance)), 0.5 * stated)
    return distance > limit * spread


def leaps(values: FloatArray, leap: float) -> BoolArray:
    """Mask (n,) of values further than ``leap`` from the median: no quantity moves so far."""
    if len(values) == 0:
        return np.zeros(0, dtype=np.bool_)
    far: BoolArray = np.abs(values - np.median(values)) > leap
    return far


def wrapped(angles: FloatArray) -> FloatArray:
    """Wrap angles (n,) in rad into ±π."""
    return (angles + math.pi) % (2.0 * math.pi) - math.pi


def circular_median(angles: FloatArray) -> float:
    """Median of angles (n,) in rad that may lie on both sides of ±π."""
    middle = math.atan2(float(np.sin(angles).sum()), float(np.cos(angles).sum()))
    return middle + float(np.median(wrapped(angles - middle)))


def longest_run(values: FloatArray) -> int:
    """Length of the longest run of exactly equal successive values."""
    if len(values) == 0:
        return 0
    changes = np.flatnonzero(np.diff(values) != 0.0)
    edges = np.concatenate(([-1], changes, [len(values) - 1]))
    return int(np.max(np.diff(edges)))
