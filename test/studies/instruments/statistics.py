"""Statistics of a sensor's readings in a haul, the same of measured and of simulated ones."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from studies.instruments.course import NEAR_S, running_median, towing
from studies.instruments.survey import Series
from trawl_ros.core.arrays import BoolArray, FloatArray

SILENCE_S = 10.0
SLOW_LAG_S = 30.0
WIDEST_STEP = 0.5
"""Values (m) further apart are so by the course and not by rounding."""


@dataclass(frozen=True)
class Limits:
    """Limits (m) of a sensor's residuals: ``near`` of what counts as scatter, ``outlier`` beyond
    which a reading is one, ``far`` beyond which it is off by another kind of error.
    """

    near: float
    outlier: float
    far: float


SPREAD_LIMITS = Limits(near=1.5, outlier=1.5, far=100.0)
HEIGHT_LIMITS = Limits(near=0.45, outlier=0.45, far=2.0)

STATISTICS: Mapping[str, tuple[str, str]] = {
    'rate': ('readings per minute of towing', '1/min'),
    'interval': ('median interval', 's'),
    'interval_95': ('interval that 5 % exceed', 's'),
    'silent': ('time within silences of more than 10 s', '%'),
    'longest': ('longest silence', 's'),
    'scatter': ('standard deviation of near residuals', 'm'),
    'tail': ('near residuals beyond 2.5 of it', '%'),
    'above': ('outliers above', '%'),
    'below': ('outliers below', '%'),
    'far': ('readings far above', '%'),
    'excess': ('median excess of outliers above that are not far', 'm'),
    'runs': ('outliers above followed by another', '%'),
    'next': ('correlation of near residuals, one reading to the next', ''),
    'slow': ('correlation of near residuals, half a minute apart', ''),
    'repeated': ('readings equal to the one before', '%'),
    'shooting': ('rate while shooting and hauling, over that of towing', ''),
    'step': ('mean step from one value that near readings have to the next', 'm'),
}
"""Statistics by their keys: sentence and unit. The list, but for ``step``, was fixed before any
value was fitted."""


def statistics(series: Series, limits: Limits) -> dict[str, float]:
    """Compute all statistics of a haul; NaN where there is nothing to compute it from.

    Parameters
    ----------
    series
        Readings with no second twice.
    limits
        Of its residuals.

    Returns
    -------
    dict
        Key of `STATISTICS` → value in its unit.
    """
    begin, end = towing(series)
    towed = (series.time >= begin) & (series.time <= end)
    time, value = series.time[towed], series.value[towed]
    residual = value - running_median(time, value, NEAR_S)
    interval = np.diff(time)
    near = np.abs(residual) <= limits.near
    above, far = residual > limits.outlier, residual > limits.far
    scatter = float(residual[near].std())
    lag = float(np.median(interval))
    outside = float(np.ptp(series.time)) - (end - begin)
    rate = len(time) / (end - begin)
    return {
        'rate': 60.0 * rate,
        'interval': lag,
        'interval_95': float(np.percentile(interval, 95)),
        'silent': 100.0 * float(interval[interval > SILENCE_S].sum()) / (end - begin),
        'longest': float(interval.max()),
        'scatter': scatter,
        'tail': 100.0 * float(np.mean(np.abs(residual[near]) > 2.5 * scatter)),
        'above': 100.0 * float(np.mean(above & ~far)),
        'below': 100.0 * float(np.mean(residual < -limits.outlier)),
        'far': 100.0 * float(np.mean(far)),
        'excess': _median(residual[above & ~far]),
        'runs': _share(above[1:], above[:-1]),
        'next': _correlation(time[near], residual[near], lag),
        'slow': _correlation(time[near], residual[near], SLOW_LAG_S),
        'repeated': 100.0 * float(np.mean(np.diff(value) == 0.0)),
        'shooting': np.count_nonzero(~towed) / outside / rate if outside > 0.0 else np.nan,
        'step': _step(value[near]),
    }


def _step(values: FloatArray) -> float:
    steps = np.diff(np.unique(np.round(values, 6)))
    steps = steps[steps < WIDEST_STEP]
    return float(steps.mean()) if len(steps) else np.nan


def _median(values: FloatArray) -> float:
    return float(np.median(values)) if len(values) else np.nan


def _share(of: BoolArray, among: BoolArray) -> float:
    return 100.0 * float(np.mean(of[among])) if among.any() else np.nan


def _correlation(time: FloatArray, residual: FloatArray, lag_s: float) -> float:
    """Correlation of residuals that are ``lag_s`` apart, to within a second."""
    at = np.searchsorted(time, time + lag_s - 0.5)
    there = at < len(time)
    there[there] &= np.abs(time[at[there]] - time[there] - lag_s) <= 0.5
    if np.count_nonzero(there) < 20:
        return np.nan
    return float(np.mean(residual[there] * residual[at[there]]) / np.mean(residual**2))
