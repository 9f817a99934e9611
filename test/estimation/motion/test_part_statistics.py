"""Statistics of parts of a tow: scatter about lines, and periods that stand out of noise."""

import numpy as np
import pytest

from trawl_ros.estimation.motion.part_statistics import dominant_period, oscillation
from trawl_ros.estimation.motion.series import Series


@pytest.mark.parametrize('period', [5.0, 8.3, 14.0])
def test_a_swell_is_found_in_readings_of_a_moving_part(period):
    rng, times = np.random.default_rng(3), np.arange(0.0, 300.0) + 0.3
    values = 9e4 + 100.0 * times + 3e3 * np.sin(2.0 * np.pi * times / period)
    values += 1e3 * rng.standard_normal(len(times))
    found = oscillation(Series(times, values), 0.0, 300.0, 30.0)
    assert found.period_s == pytest.approx(period, rel=0.02)
    assert found.std == pytest.approx(np.hypot(3e3 / np.sqrt(2.0), 1e3), rel=0.1)


def test_white_noise_has_no_period():
    rng, times = np.random.default_rng(4), np.arange(0.0, 600.0, 2.0)
    periods = [dominant_period(times, rng.standard_normal(len(times))) for _ in range(50)]
    assert np.isnan(periods).sum() >= 49


def test_too_few_readings_have_no_statistics():
    times = np.arange(0.0, 100.0, 10.0)
    assert oscillation(Series(times, times), 0.0, 100.0, 30.0) is None
    still = oscillation(Series(np.arange(100.0), np.full(100, 7.0)), 0.0, 100.0, 30.0)
    assert still.std == 0.0
    assert np.isnan(still.period_s)
