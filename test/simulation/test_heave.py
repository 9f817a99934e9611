"""The ship moves up and down as the weather asked for, and smoothly."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import welch

from trawl_ros.simulation.heave import (
    HIGHEST_TO_PEAK_FREQUENCY,
    Heave,
    irregular_heave,
    regular_heave,
)


def irregular(seed: int = 1) -> Heave:
    return irregular_heave(2.0, 8.0, np.random.default_rng(seed), begin=0.0, growth=30.0)


def heights(heave: Heave, seconds: float, dt: float) -> np.ndarray:
    """Heights (n,) once it is fully grown."""
    times = heave.begin + heave.growth + np.arange(0.0, seconds, dt)
    return np.array([heave.at(t)[0] for t in times])


def test_irregular_heave_has_the_significant_height_and_the_peak_period_asked_for() -> None:
    found = heights(irregular(), 6 * 3600.0, 0.5)
    assert 4 * found.std() == pytest.approx(2.0, rel=0.02)
    # The mean of the highest third, from trough to crest; of waves as broad-banded as these it
    # lies some per cent below four standard deviations.
    up = np.flatnonzero((found[:-1] < 0.0) & (found[1:] >= 0.0))
    waves = np.sort([np.ptp(found[a:b]) for a, b in pairwise(up)])
    assert waves[-len(waves) // 3 :].mean() == pytest.approx(2.0, rel=0.08)
    frequencies, density = welch(found, fs=2.0, nperseg=512)
    peak = frequencies[density.argmax()]
    assert 1 / peak == pytest.approx(8.0, rel=0.08)
    # Nothing above the band, and nothing below half of the peak's frequency.
    outside = (frequencies > (HIGHEST_TO_PEAK_FREQUENCY + 0.1) / 8.0) | (frequencies < 0.4 / 8.0)
    assert density[outside].sum() < 0.01 * density.sum()


def test_irregular_heave_has_the_shape_of_its_spectrum() -> None:
    frequencies, density = welch(heights(irregular(2), 12 * 3600.0, 0.5), fs=2.0, nperseg=256)
    peak = 1 / 8.0
    inside = (frequencies > 0.7 * peak) & (frequencies < 1.8 * peak)
    ratio = peak / frequencies[inside]
    expected = 5 / 16 * 2.0**2 / peak * ratio**5 * np.exp(-1.25 * ratio**4)
    # What lies above the band was given to what lies in it.
    expected /= math.exp(-1.25 / HIGHEST_TO_PEAK_FREQUENCY**4)
    assert density[inside] == pytest.approx(expected, abs=0.12 * expected.max())


def test_waves_do_not_come_round_again() -> None:
    found = heights(irregular(), 4 * 3600.0, 1.0)
    first = found[:600]
    for start in range(600, len(found) - 600, 600):
        best = np.correlate(found[start : start + 1200], first, 'valid').max()
        assert best < 0.8 * (first @ first)


@pytest.mark.parametrize(
    'heave', [irregular(), regular_heave(3.0, 9.0, begin=12.0, growth=20.0)], ids=['many', 'one']
)
def test_the_rate_is_the_derivative_of_the_height_from_the_first_moment_on(heave: Heave) -> None:
    for t in np.arange(-1.0, 60.0, 0.37):
        slope = (heave.at(t + 1e-4)[0] - heave.at(t - 1e-4)[0]) / 2e-4
        assert heave.at(t)[1] == pytest.approx(slope, abs=1e-6)


def test_regular_heave_is_a_sine_of_the_height_from_trough_to_crest() -> None:
    heave = regular_heave(3.0, 9.0, begin=100.0, growth=20.0)
    assert heave.shortest_period == pytest.approx(9.0)
    assert [heave.at(t) for t in (0.0, 99.9, 100.0)] == [(0.0, 0.0)] * 3
    quarters = [heave.at(100.0 + (12 + k / 4) * 9.0)[0] for k in range(4)]
    assert quarters == pytest.approx([0.0, 1.5, 0.0, -1.5], abs=1e-9)


def test_heave_grows_without_a_jerk() -> None:
    heave = regular_heave(2.0, 8.0, begin=0.0, growth=30.0)
    accelerations = [
        (heave.at(t + 1e-3)[1] - heave.at(t - 1e-3)[1]) / 2e-3 for t in np.arange(-1.0, 60.0, 0.1)
    ]
    assert np.abs(np.diff(accelerations)).max() < 1.2 * 0.1 * (2 * math.pi / 8.0) ** 3
    assert abs(heave.at(3.0)[0]) < 0.05


def test_the_same_seed_gives_the_same_waves_and_another_seed_others() -> None:
    assert irregular(5).at(77.0) == irregular(5).at(77.0)
    assert irregular(5).at(77.0) != irregular(6).at(77.0)


def test_a_calm_sea_has_no_heave() -> None:
    assert Heave().at(1234.5) == (0.0, 0.0)
    assert Heave().shortest_period == math.inf
