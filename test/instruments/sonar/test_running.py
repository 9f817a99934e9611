"""Running mean, median and least value are those of scipy.ndimage."""

import numpy as np
import pytest
from scipy.ndimage import median_filter, minimum_filter1d, uniform_filter1d

from trawl_ros.instruments.sonar.running import running_least, running_mean, running_median


@pytest.mark.parametrize(('shape', 'width'), [((40, 90), 3), ((90,), 9), ((5,), 3)])
def test_the_mean_is_mirrored_at_the_ends(shape: tuple[int, ...], width: int) -> None:
    brightness = np.random.default_rng(1).integers(0, 256, shape).astype(float)
    assert np.array_equal(running_mean(brightness, width), uniform_filter1d(brightness, width))


def test_median_and_least_go_on_beyond_the_ends() -> None:
    values = np.random.default_rng(2).standard_normal(60)
    assert np.array_equal(running_median(values, 3), median_filter(values, 3, mode='nearest'))
    values[::7] = np.inf
    assert np.array_equal(running_least(values, 7), minimum_filter1d(values, 7, mode='nearest'))
