"""Each kind of error has the size and the memory that its parameters state."""

import math

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.channel import ErrorChannel, ErrorModel
from trawl_ros.instruments.errors.random_processes import NoiseModel

N = 20_000


def readings(errors: ErrorModel, *, seed: int = 5, name: str = 'a/b', n: int = N) -> np.ndarray:
    channel = ErrorChannel(name, errors, seed)
    return np.array([channel.measure(100.0, k * SECOND) for k in range(n)])


def test_without_errors_the_truth_is_reported() -> None:
    assert ErrorChannel('a', ErrorModel(), 0).measure(math.pi, 0) == math.pi


def test_white_noise_is_normal_unbiased_and_without_memory() -> None:
    noise = readings(ErrorModel(white=NoiseModel(2.0))) - 100.0
    assert noise.mean() == pytest.approx(0.0, abs=4 * 2.0 / math.sqrt(N))
    assert noise.std() == pytest.approx(2.0, rel=4 / math.sqrt(2 * N))
    assert np.mean(np.abs(noise) < 2.0) == pytest.approx(0.6827, abs=0.015)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(0.0, abs=4 / math.sqrt(N))


@pytest.mark.parametrize('lag', [1, 5, 10])
def test_correlated_noise_forgets_with_its_correlation_time(lag: int) -> None:
    noise = readings(ErrorModel(correlated_std=2.0, correlation_time=10.0)) - 100.0
    expected = math.exp(-lag / 10.0)
    assert np.corrcoef(noise[lag:], noise[:-lag])[0, 1] == pytest.approx(expected, abs=0.06)
    # About N / 20 independent values are left.
    assert noise.std() == pytest.approx(2.0, rel=0.1)


def test_correlated_noise_is_stationary_from_the_first_reading() -> None:
    errors = ErrorModel(correlated_std=2.0, correlation_time=1000.0)
    first = [ErrorChannel('a', errors, seed).measure(0.0, 0) for seed in range(2000)]
    assert np.std(first) == pytest.approx(2.0, rel=0.07)


def test_correlation_goes_by_time_and_not_by_the_number_of_samples() -> None:
    errors = ErrorModel(correlated_std=1.0, correlation_time=10.0)
    pairs = []
    for seed in range(3000):
        channel = ErrorChannel('a', errors, seed)
        pairs.append([channel.measure(0.0, stamp * SECOND) for stamp in (0, 20)])
    assert np.corrcoef(np.transpose(pairs))[0, 1] == pytest.approx(math.exp(-2.0), abs=0.07)


def test_a_bias_stays_within_a_state_and_is_drawn_anew_for_the_next() -> None:
    errors = ErrorModel(bias_std=3.0)
    channel = ErrorChannel('a', errors, 1)
    biases = [[channel.measure(0.0, 0, state) for _ in range(3)] for state in range(2000)]
    assert np.ptp(biases, axis=1).max() == 0.0
    assert np.std([b[0] for b in biases]) == pytest.approx(3.0, rel=0.07)


def test_the_bias_of_a_state_does_not_depend_on_the_states_seen_before() -> None:
    errors = ErrorModel(bias_std=3.0)
    all_of_them, late = ErrorChannel('a', errors, 1), ErrorChannel('a', errors, 1)
    seen = [all_of_them.measure(0.0, 0, state) for state in range(5)]
    assert late.measure(0.0, 0, 4) == seen[4]


def test_readings_are_multiples_of_the_resolution_nearest_to_the_truth() -> None:
    channel = ErrorChannel('a', ErrorModel(resolution=0.1), 0)
    truth = np.linspace(-3.0, 900.0, 777)
    measured = np.array([channel.measure(value, 0) for value in truth])
    assert np.abs(measured - truth).max() <= 0.05 + 1e-9
    assert np.abs(measured / 0.1 - np.round(measured / 0.1)).max() < 1e-9


def test_the_same_seed_gives_the_same_readings_and_another_seed_others() -> None:
    errors = ErrorModel(
        white=NoiseModel(1.0), correlated_std=1.0, correlation_time=5.0, bias_std=1.0
    )
    assert np.array_equal(readings(errors, n=50), readings(errors, n=50))
    assert not np.any(readings(errors, n=50) == readings(errors, n=50, seed=6))


def test_channels_of_one_seed_are_independent() -> None:
    errors = ErrorModel(white=NoiseModel(1.0))
    pair = readings(errors, name='door/port/pressure'), readings(errors, name='door/spread')
    assert abs(np.corrcoef(pair)[0, 1]) < 4 / math.sqrt(N)


def test_one_kind_of_error_leaves_the_draws_of_the_others_alone() -> None:
    white = readings(ErrorModel(white=NoiseModel(1.0)), n=50)
    both = ErrorModel(white=NoiseModel(1.0), bias_std=0.5)
    assert np.ptp(readings(both, n=50) - white) < 1e-12


def test_an_unknown_truth_stays_unknown() -> None:
    channel = ErrorChannel('a', ErrorModel(white=NoiseModel(1.0), resolution=0.1), 0)
    assert math.isnan(channel.measure(math.nan, 0))


def test_a_share_of_readings_is_the_one_before_once_more() -> None:
    plain = readings(ErrorModel(white=NoiseModel(1.0)), n=4000)
    repeated = readings(ErrorModel(white=NoiseModel(1.0), repeated=0.2), n=4000)
    again = np.diff(repeated) == 0.0
    assert np.mean(again) == pytest.approx(0.2, abs=0.02)
    assert np.array_equal(repeated[1:][~again], plain[1:][~again])
