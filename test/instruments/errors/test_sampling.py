"""Samples are due by the stamps of truth alone."""

from itertools import pairwise

import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.instrument import Sampler


def sampled(rate: float, stamps: list[int]) -> list[int]:
    sampler = Sampler(rate)
    taken = []
    for stamp in stamps:
        sampler.restarted(stamp)
        if sampler.due(stamp):
            taken.append(stamp)
    return taken


@pytest.mark.parametrize('rate', [0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 7.0, 10.0])
@pytest.mark.parametrize('truth_rate', [7.3, 10.0, 12.5, 30.0])
def test_the_mean_rate_is_kept_whatever_the_rate_of_truth(rate: float, truth_rate: float) -> None:
    stamps = [round(k * SECOND / truth_rate) for k in range(int(200 * truth_rate) + 1)]
    expected = min(rate, truth_rate) * 200
    assert len(sampled(rate, stamps)) == pytest.approx(expected + 1, abs=1)


def test_the_first_truth_is_sampled_and_the_grid_starts_there() -> None:
    start = 1_700_000_000_123_456_789
    stamps = [start + k * SECOND // 10 for k in range(31)]
    assert sampled(1.0, stamps) == [start + k * SECOND for k in range(4)]


def test_stamps_made_from_floating_point_seconds_lose_no_sample() -> None:
    stamps = [int((1.7e9 + 0.1 * k) * 1e9) for k in range(6001)]
    taken = sampled(2.0, stamps)
    assert len(taken) == 1201
    assert {round((b - a) / 1e6) for a, b in pairwise(taken)} == {500}


def test_slower_truth_than_the_sensor_gives_each_stamp_once() -> None:
    stamps = [k * SECOND for k in range(20)]
    assert sampled(2.0, sorted(stamps + stamps)) == stamps


def test_a_gap_in_truth_leaves_a_gap_and_no_burst() -> None:
    stamps = [*range(0, 3 * SECOND, SECOND // 10), *range(60 * SECOND, 62 * SECOND, SECOND // 10)]
    assert sampled(1.0, stamps) == [k * SECOND for k in (0, 1, 2, 60, 61)]


def test_a_backward_jump_starts_anew() -> None:
    first = [k * SECOND // 10 for k in range(15)]
    second = [SECOND // 2 + k * SECOND // 10 for k in range(11)]
    taken = sampled(1.0, first + second)
    assert taken == [0, SECOND, SECOND // 2, SECOND // 2 + SECOND]
