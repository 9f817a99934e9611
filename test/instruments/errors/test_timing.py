"""When an instrument samples, sends, and does not."""

from itertools import pairwise

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.channel import ErrorModel
from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.errors.random_processes import BurstModel, Bursts, NoiseModel
from trawl_ros.instruments.errors.timing import Timing
from trawl_ros.records.samples import HeadingSample


class Compass(Instrument[float, HeadingSample]):
    """An instrument of one quantity; a truth of NaN cannot be measured."""

    def __init__(self, timing: Timing, errors: ErrorModel | None = None, seed: int = 2) -> None:
        super().__init__('compass', timing, {'heading': errors or ErrorModel()}, SeedPlan(seed))

    def _read(self, part: float, stamp: int) -> HeadingSample | None:
        measured = self._measure('heading', part, stamp)
        return None if np.isnan(part) else HeadingSample(stamp, measured, 0.0)


def heard(compass: Compass, seconds: float, *, step: float = 0.1) -> list[tuple[float, float]]:
    """Give (sampled at, arrived at) in s of all that is sent."""
    found = []
    for k in range(round(seconds / step) + 1):
        now = round(k * step * SECOND)
        found += [(s.stamp / SECOND, now / SECOND) for s in compass.observe(1.0, now)]
    return found


def test_a_sample_carries_the_time_it_was_taken_and_arrives_later() -> None:
    found = heard(Compass(Timing(rate=1.0, latency=2.5)), 10.0)
    assert [taken for taken, _ in found] == list(range(8))
    assert {round(arrived - taken, 6) for taken, arrived in found} == {2.5}


def test_jitter_moves_samples_off_the_beat_by_as_much_as_stated() -> None:
    found = heard(Compass(Timing(rate=1.0, jitter=0.1)), 4000.0, step=0.02)
    taken = np.array([t for t, _ in found])
    off = taken - np.round(taken)
    assert len(taken) == pytest.approx(4001, abs=1)
    # Truth comes each 0.02 s, and a sample waits for it.
    assert off[1:].mean() == pytest.approx(0.01, abs=0.008)
    assert off[1:].std() == pytest.approx(0.1, rel=0.06)
    assert (np.diff(taken) > 0).all()


def test_even_wild_jitter_loses_no_sample_and_keeps_the_order() -> None:
    taken = [t for t, _ in heard(Compass(Timing(rate=1.0, jitter=5.0)), 300.0)]
    assert len(taken) == pytest.approx(301, abs=1)
    assert all(b > a for a, b in pairwise(taken))


def test_nothing_is_sampled_while_the_instrument_starts_up() -> None:
    taken = [t for t, _ in heard(Compass(Timing(rate=1.0, start_up=30.0)), 40.0)]
    assert taken == list(range(30, 41))


def test_dropouts_come_in_bursts_as_often_and_as_long_as_stated() -> None:
    timing = Timing(rate=1.0, dropouts=BurstModel(per_hour=60.0, mean_s=15.0))
    seconds = 200_000
    taken = np.array([t for t, _ in heard(Compass(timing), seconds, step=1.0)])
    gaps = np.diff(taken) - 1.0
    bursts = gaps[gaps > 0]
    assert len(taken) / seconds == pytest.approx(60.0 / 75.0, rel=0.02)
    # A thirtieth of the bursts falls between two samples, and some follow each other at once.
    assert len(bursts) == pytest.approx(0.96 * seconds / 75.0, rel=0.06)
    assert bursts.mean() == pytest.approx(15.0, rel=0.08)


def test_samples_are_missed_one_by_one_at_the_share_stated() -> None:
    found = heard(Compass(Timing(rate=1.0, missed=0.3)), 4000.0, step=1.0)
    gaps = np.diff([taken for taken, _ in found])
    assert len(found) / 4001 == pytest.approx(0.7, abs=0.02)
    # Without memory: after one that is missed the next is missed as often.
    assert np.mean(gaps == 1.0) == pytest.approx(0.7, abs=0.02)
    assert np.mean(gaps == 2.0) == pytest.approx(0.21, abs=0.02)


def test_bursts_of_log_normal_length_keep_the_mean_and_have_a_longer_tail() -> None:
    lengths = []
    for log_std in (0.0, 1.5):
        bursts = Bursts(BurstModel(60.0, 20.0, log_std), np.random.default_rng(5))
        on = np.array([bursts.on(k * SECOND // 2) for k in range(2_000_000)])
        edges = np.flatnonzero(np.diff(on.astype(int)))
        lengths.append(np.diff(edges)[::2] / 2 if not on[0] else np.diff(edges)[1::2] / 2)
    plain, wide = lengths
    assert plain.mean() == pytest.approx(20.0, rel=0.06)
    assert wide.mean() == pytest.approx(20.0, rel=0.12)
    assert np.mean(wide > 120.0) > 3 * np.mean(plain > 120.0)
    assert np.median(wide) == pytest.approx(20.0 * np.exp(-0.5 * 1.5**2), rel=0.15)


def test_what_cannot_be_measured_gives_no_sample() -> None:
    assert Compass(Timing(rate=1.0)).observe(float('nan'), 0) == []


def test_a_backward_jump_forgets_what_was_under_way() -> None:
    compass = Compass(Timing(rate=1.0, latency=5.0, jitter=0.2), ErrorModel(white=NoiseModel(1.0)))
    first = [repr(s) for k in range(200) for s in compass.observe(1.0, k * SECOND // 10)]
    again = [repr(s) for k in range(200) for s in compass.observe(1.0, k * SECOND // 10)]
    assert first == again
