"""Residuals that follow each other are told from those that scatter."""

import numpy as np
import pytest

from trawl_ros.estimation.fit.whiteness import ljung_box

SERIES = np.array([
    0.3, -0.1, 0.8, 1.2, 0.4, -0.7, -1.1, 0.2, 0.5, 1.6,
    0.9, -0.3, -1.4, -0.6, 0.1, 0.7, 1.3, 0.2, -0.9, -0.5,
])  # fmt: skip


@pytest.mark.parametrize(
    ('lags', 'statistic', 'p_value'),
    [(1, 4.884858, 0.027093), (3, 22.251649, 5.8e-05), (4, 29.458143, 6e-06)],
)
def test_one_series_gives_what_statsmodels_gives(lags, statistic, p_value):
    """``acorr_ljungbox`` of statsmodels 0.15.0."""
    found = ljung_box([SERIES], lags)
    assert found.statistic == pytest.approx(statistic, abs=1e-6)
    assert found.p_value == pytest.approx(p_value, abs=6e-7)


def test_a_fifth_of_the_residuals_is_looked_at_and_ten_lags_at_most():
    assert ljung_box([SERIES]).lags == 4
    assert ljung_box([np.random.default_rng(0).normal(size=400)]).lags == 10


def test_tows_that_differ_by_a_constant_are_white():
    rng = np.random.default_rng(4)
    tows = [rng.normal(size=30) + offset for offset in (-5.0, 0.0, 5.0)]
    assert ljung_box(tows).white
    assert not ljung_box([np.concatenate(tows)]).white


def test_no_pair_spans_two_tows():
    """Runs that would look periodic end to end."""
    parts = [SERIES[:10], SERIES[10:]]
    about = [part - part.mean() for part in parts]
    power = sum(part @ part for part in about)
    first = sum(part[1:] @ part[:-1] for part in about) / power
    assert ljung_box(parts, 1).statistic == pytest.approx(20 * 22 * first**2 / 19)


def test_white_noise_is_called_coloured_once_in_a_hundred():
    rng = np.random.default_rng(1)
    called = [not ljung_box([rng.normal(size=60)]).white for _ in range(1000)]
    assert 0.002 < np.mean(called) < 0.03


def test_a_first_order_memory_is_found():
    rng = np.random.default_rng(2)
    series = np.zeros(80)
    for i in range(1, 80):
        series[i] = 0.7 * series[i - 1] + rng.normal()
    assert not ljung_box([series]).white


def test_nothing_is_said_of_few_or_constant_residuals():
    assert ljung_box([SERIES[:5], SERIES[:4]]) is None
    assert ljung_box([np.ones(30)]) is None
    assert ljung_box([]) is None
