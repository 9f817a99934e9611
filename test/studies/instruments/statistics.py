"""Statistics of a sensor's readings in a haul, the same of measured and of simulated ones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from studies.instruments.survey import Series
from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.estimation.windows.statistics import MAD_TO_STD

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


EDGES_M = (0.0, 2.0, 4.0, 8.0, 12.0, 16.0, 20.0, 40.0)
"""Edges of the classes of distance."""

WITHIN_S = 8.0
"""Three readings further apart say more of the course than of the noise."""

FEWEST = 50
"""Readings of a class, at least."""


def noise_at(hauls: Sequence[Series]) -> list[tuple[float, int]]:
    """Return the robust standard deviation (m) of noise, and the number of readings, per class.

    Each reading is compared with the line through those before and after it, so that a steady
    change does not count; NaN where there are fewer than `FEWEST`.
    """
    pairs = [_residuals(series) for series in hauls]
    level, residual = (np.concatenate(side) for side in zip(*pairs, strict=True))
    found = []
    for low, high in pairwise(EDGES_M):
        here = np.abs(residual[(level >= low) & (level < high)])
        enough = len(here) >= FEWEST
        found.append((MAD_TO_STD * float(np.median(here)) if enough else np.nan, len(here)))
    return found


def _residuals(series: Series) -> tuple[FloatArray, FloatArray]:
    time, value = series.time, series.value
    near = time[2:] - time[:-2] <= WITHIN_S
    later = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
    residual = value[1:-1] - (1.0 - later) * value[:-2] - later * value[2:]
    # Of independent errors of the same size.
    residual /= np.sqrt(1.0 + later**2 + (1.0 - later) ** 2)
    level = np.median([value[:-2], value[1:-1], value[2:]], axis=0)
    return level[near], residual[near]
