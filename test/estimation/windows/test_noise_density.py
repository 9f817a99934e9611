"""Steady windows tell what averaging leaves of errors that neighbouring readings share."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.estimation.motion.series import series_of
from trawl_ros.estimation.windows.noise_density import noise_densities
from trawl_ros.estimation.windows.statistics import error_of_mean
from trawl_ros.records.channels import CHANNELS

WHITE, SLOW, TIME_S = 0.03, 0.02, 15.0
"""Std (m/s) of a log's errors, and the correlation time of the second, as of bags/sea_trial."""


def log_readings(rng, seconds):
    slow, kept = np.empty(seconds), math.exp(-1.0 / TIME_S)
    slow[0] = SLOW * rng.standard_normal()
    for place, drawn in enumerate(rng.standard_normal(seconds - 1), start=1):
        slow[place] = kept * slow[place - 1] + SLOW * math.sqrt(1.0 - kept**2) * drawn
    return 2.2 + slow + WHITE * rng.standard_normal(seconds)


def test_windows_show_errors_that_neighbours_do_not():
    rng = np.random.default_rng(5)
    windows = [
        SimpleNamespace(
            start_ns=0, end_ns=60 * SECOND,
            noise={'speed': error_of_mean(log_readings(rng, 60), WHITE)},
        )
        for _ in range(200)
    ]  # fmt: skip
    means = [log_readings(rng, 30).mean() for _ in range(2000)]
    told = noise_densities(windows)['speed'] / math.sqrt(30.0)
    # A minute is too short to show all of errors of 15 s.
    assert told == pytest.approx(np.std(means), rel=0.25)
    series = series_of(CHANNELS['speed'], np.arange(600.0), log_readings(rng, 600), WHITE)
    assert series.noise / math.sqrt(30.0) < 0.5 * np.std(means)


def test_all_windows_count_by_their_squares_and_times():
    first = SimpleNamespace(start_ns=0, end_ns=60 * SECOND, noise={'speed': 3.0, 'roll': 1.0})
    other = SimpleNamespace(start_ns=0, end_ns=240 * SECOND, noise={'speed': 2.0})
    told = noise_densities([first, other])
    assert told['roll'] == pytest.approx(math.sqrt(60.0))
    assert told['speed'] == pytest.approx(math.sqrt(0.5 * (9.0 * 60.0 + 4.0 * 240.0)))
    assert noise_densities([]) == {}
