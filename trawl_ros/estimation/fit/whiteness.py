# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Whiteness of residuals in order of time: the Ljung–Box test."""

from collections.abc import Sequence
from dataclasses import dataclass

from scipy.special import chdtrc

from trawl_ros.core.arrays import FloatArray

FEWEST = 10
"""With fewer residuals than this the statistic is far from χ² and nothing is said."""

LONGEST_LAG = 10

SIGNIFICANT = 0.01
"""p-value below which residuals are called coloured: with ten channels to look at, one in ten
reports has a false one."""


@dataclass(frozen=True)
class Whiteness:
    """Ljung–Box test: ``statistic`` Q of ``lags`` autocorrelations, and its ``p_value``."""

    statistic: float
    lags: int
    p_value: float

    @property
    def white(self) -> bool:
        """True if the residuals pass."""
        return self.p_value >= SIGNIFICANT


def ljung_box(series: Sequence[FloatArray], lags: int | None = None) -> Whiteness | None:
    """Test the autocorrelations of residuals (Ljung–Box), none of which spans two series.

    Q = n (n + 2) Σₖ ρₖ² / (n - k), which is χ² with as many degrees of freedom as there are
    lags when the residuals are white [1]_. Each series is taken about its own mean, for what
    is wrong throughout a tow is calibration and no sign of colour.

    Parameters
    ----------
    series
        Residuals (n_i,) in order of time, one array per tow.
    lags
        Number of lags; by default a fifth of the residuals, at most `LONGEST_LAG` [2]_.

    Returns
    -------
    Whiteness or None
        None with fewer than `FEWEST` residuals, or when they do not vary.

    References
    ----------
    .. [1] G. M. Ljung and G. E. P. Box, On a measure of lack of fit in time series models,
       Biometrika 65 (1978) 297-303.
    .. [2] R. J. Hyndman and G. Athanasopoulos, Forecasting: principles and practice, 3rd ed.,
       section 5.4.
    """
    centred = [residuals - residuals.mean() for residuals in series if len(residuals)]
    number = sum(map(len, centred))
    power = sum(float(residuals @ residuals) for residuals in centred)
    if number < FEWEST or power <= 0.0:
        return None
    lags = min(LONGEST_LAG, number // 5) if lags is None else lags
    statistic = 0.0
    for lag in range(1, lags + 1):
        product = sum(
            float(residuals[lag:] @ residuals[:-lag])
            for residuals in centred
            if len(residuals) > lag
        )
        statistic += (product / power) ** 2 / (number - lag)
    statistic *= number * (number + 2)
    return Whiteness(statistic, lags, float(chdtrc(lags, statistic)))
