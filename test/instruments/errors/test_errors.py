"""Errors of a channel beside noise: each does what its parameters state."""

import math

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.channel import ErrorChannel, ErrorModel
from trawl_ros.instruments.errors.random_processes import BurstModel, NoiseModel

HOUR = 3600


def readings(errors: ErrorModel, truth: np.ndarray, *, seed: int = 8) -> np.ndarray:
    channel = ErrorChannel('a/b', errors, seed)
    return np.array([channel.measure(value, k * SECOND) for k, value in enumerate(truth)])


def test_scale_and_offset_bend_the_reading_as_a_wrong_calibration_does() -> None:
    truth = np.linspace(-200.0, 900.0, 50)
    found = readings(ErrorModel(scale=0.02, offset=-3.0), truth)
    np.testing.assert_allclose(found, 1.02 * truth - 3.0)


def test_drift_grows_with_time_from_the_first_reading() -> None:
    channel = ErrorChannel('a', ErrorModel(drift=6.0), 0)
    start = 1_700_000_000 * SECOND
    found = [channel.measure(10.0, start + h * HOUR * SECOND // 2) for h in range(5)]
    assert found == pytest.approx([10.0, 13.0, 16.0, 19.0, 22.0])


def test_no_reading_leaves_the_limits() -> None:
    found = readings(ErrorModel(lowest=0.0, highest=250.0), np.array([-5.0, 100.0, 400.0]))
    assert list(found) == [0.0, 100.0, 250.0]


def test_outliers_are_as_many_and_as_large_as_stated() -> None:
    n = 20_000
    off = readings(ErrorModel(outlier_share=0.05, outlier_std=40.0), np.full(n, 100.0)) - 100.0
    hit = off != 0.0
    assert hit.mean() == pytest.approx(0.05, abs=4 * math.sqrt(0.05 * 0.95 / n))
    assert off[hit].std() == pytest.approx(40.0, rel=4 / math.sqrt(2 * hit.sum()))
    # Singly, not in bursts.
    assert np.corrcoef(hit[1:], hit[:-1])[0, 1] == pytest.approx(0.0, abs=0.03)


def test_a_channel_freezes_as_often_and_as_long_as_stated() -> None:
    n = 400_000
    model = ErrorModel(freezes=BurstModel(per_hour=30.0, mean_s=20.0))
    truth = np.arange(n, dtype=float)
    stuck = np.diff(readings(model, truth)) == 0.0
    begins = np.flatnonzero(np.diff(stuck.astype(int)) == 1)
    # Between two spells lie 120 s in the mean, and each takes 20 s.
    assert stuck.mean() == pytest.approx(20.0 / 140.0, rel=0.06)
    assert len(begins) == pytest.approx(n / 140.0, rel=0.06)


def test_after_a_spell_the_channel_reads_the_present_again() -> None:
    model = ErrorModel(freezes=BurstModel(per_hour=60.0, mean_s=10.0))
    truth = np.arange(5000, dtype=float)
    found = readings(model, truth)
    moving = np.diff(found) != 0.0
    np.testing.assert_array_equal(found[1:][moving], truth[1:][moving])


@pytest.mark.parametrize(
    'other',
    [
        ErrorModel(white=NoiseModel(1.0), outlier_share=0.5, outlier_std=3.0),
        ErrorModel(white=NoiseModel(1.0), scale=0.1, offset=3.0, drift=2.0),
    ],
)
def test_another_kind_of_error_leaves_the_noise_alone(other: ErrorModel) -> None:
    truth = np.full(200, 10.0)
    plain = readings(ErrorModel(white=NoiseModel(1.0)), truth)
    found = readings(other, truth)
    rest = found - plain - (readings(ErrorModel(scale=other.scale, offset=other.offset,
                                                drift=other.drift), truth) - truth)  # fmt: skip
    assert np.count_nonzero(np.abs(rest) > 1e-9) == pytest.approx(
        200 * other.outlier_share, abs=4 * math.sqrt(200) / 2 if other.outlier_share else 0
    )
