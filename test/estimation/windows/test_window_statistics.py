"""Errors of means, trends, outliers and stuck sensors are what they claim to be."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.windows.statistics import (
    effective_number,
    error_of_mean,
    longest_run,
    outliers,
    trend,
)


def correlated(rng, n, rho):
    values = np.empty(n)
    values[0] = rng.normal()
    for i in range(1, n):
        values[i] = rho * values[i - 1] + np.sqrt(1.0 - rho**2) * rng.normal()
    return values


@pytest.mark.parametrize('rho', [0.0, 0.5, 0.8])
def test_the_stated_error_of_a_mean_is_its_scatter_over_repeats(rho):
    rng = np.random.default_rng(11)
    series = [correlated(rng, 90, rho) for _ in range(600)]
    actual = np.std([values.mean() for values in series])
    stated = np.sqrt(np.mean([error_of_mean(values, 1.0) ** 2 for values in series]))
    assert stated == pytest.approx(actual, rel=0.2)


def test_slow_noise_beneath_white_noise_is_counted():
    # The first lag alone would state 0.43 of the scatter.
    rng = np.random.default_rng(12)
    rho = np.exp(-1.0 / 15.0)
    series = [rng.normal(size=60) + correlated(rng, 60, rho) for _ in range(600)]
    actual = np.std([values.mean() for values in series])
    stated = np.sqrt(np.mean([error_of_mean(values, 1.0) ** 2 for values in series]))
    assert stated == pytest.approx(actual, rel=0.25)


def test_the_quietest_half_of_the_windows_is_not_believed(sea, model, prior):
    windows = [
        replace(window, noise=dict(window.bias))
        for window in sea.trial_windows(model, np.random.default_rng(0), noise=0.1)
    ]
    lucky = [
        replace(window, noise={name: 0.1 * noise for name, noise in window.noise.items()})
        if window.index in (2, 5)
        else window
        for window in windows
    ]
    fits = []
    for trial in (windows, lucky):
        estimator = Estimator(model, prior, sea.OBSERVABLES)
        for window in trial:
            estimator.add(window)
        fits.append(estimator.finish())
    np.testing.assert_allclose(fits[1].std, fits[0].std, rtol=1e-3)


def test_ninety_correlated_readings_are_worth_far_fewer():
    values = correlated(np.random.default_rng(1), 2000, 0.8)
    assert effective_number(values) == pytest.approx(2000 / 9.0, rel=0.25)


def test_few_readings_have_at_least_their_stated_error():
    assert error_of_mean(np.array([3.0]), 0.5) == 0.5
    assert error_of_mean(np.array([3.0, 3.0, 3.0]), 0.5) == pytest.approx(0.5 / np.sqrt(3.0))


@pytest.mark.parametrize('rho', [0.0, 0.7])
def test_noise_is_seldom_taken_for_a_trend(rho):
    rng = np.random.default_rng(5)
    seconds = np.arange(90.0)
    found = [trend(seconds, correlated(rng, 90, rho)).p_value < 0.001 for _ in range(500)]
    assert np.mean(found) < 0.02


def test_a_trend_is_found_with_its_size():
    rng = np.random.default_rng(6)
    seconds = np.arange(90.0)
    found = trend(seconds, 200.0 + 3.0 * seconds / 89.0 + 0.3 * rng.normal(size=90))
    assert found.drift == pytest.approx(3.0, abs=0.3)
    assert found.p_value < 1e-6


def test_a_spike_is_an_outlier_and_a_quantum_is_not():
    values = np.full(50, 100.0)
    values[::7] += 0.1
    values[20] = 130.0
    assert np.flatnonzero(outliers(values, 0.3, 6.0)).tolist() == [20]


def test_the_longest_run():
    assert longest_run(np.array([1.0, 2.0, 2.0, 2.0, 3.0, 3.0])) == 3
    assert longest_run(np.array([])) == 0
    assert longest_run(np.array([1.0, 2.0])) == 1
