"""Noise has the stated standard deviation, with the tails and the growth that are asked for."""

import numpy as np
import pytest
from scipy import stats

from trawl_ros.instruments.errors.random_processes import Noise, NoiseModel


def drawn(model, value=0.0, n=40_000, seed=3):
    noise = Noise(model, np.random.default_rng(seed))
    return np.array([noise.draw(value) for _ in range(n)])


def test_noise_is_normal_unless_tails_are_given():
    plain = drawn(NoiseModel(2.0))
    assert plain.std() == pytest.approx(2.0, rel=0.02)
    assert stats.kurtosis(plain) == pytest.approx(0.0, abs=0.1)
    expected = 2.0 * np.random.default_rng(3).standard_normal(len(plain))
    assert np.array_equal(plain, expected)


def test_heavy_tails_keep_the_standard_deviation():
    heavy = drawn(NoiseModel(2.0, tail_dof=5.0))
    assert heavy.std() == pytest.approx(2.0, rel=0.04)
    far = np.mean(np.abs(heavy) > 6.0)
    scale = 2.0 * np.sqrt(3.0 / 5.0)
    assert far == pytest.approx(2 * stats.t.sf(6.0 / scale, 5.0), rel=0.2)
    assert far > 2 * np.mean(np.abs(drawn(NoiseModel(2.0))) > 6.0)


def test_noise_grows_with_the_reading():
    model = NoiseModel(0.3, of_reading=0.04)
    assert drawn(model, 0.0).std() == pytest.approx(0.3, rel=0.02)
    assert drawn(model, 10.0).std() == pytest.approx(0.5, rel=0.02)
    assert drawn(model, -10.0).std() == pytest.approx(0.5, rel=0.02)
