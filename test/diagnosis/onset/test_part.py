"""Stretches of a tow that goes on stay as they were judged, and say what is silent."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.part import (
    SETTLING,
    WatchedPart,
    counter_leap_shares,
    manoeuvres,
)
from trawl_ros.estimation.motion.stretches import FEWEST
from trawl_ros.gear.load import load_gear
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import WinchSample


@pytest.fixture
def part(coarse_gear):
    return WatchedPart(build_water(load_gear(coarse_gear)).depth)


def cut(part, samples):
    """Tow after each stretch; None where there is none."""
    for sample in samples:
        if part.feed(sample):
            try:
                yield part.cut()
            except TrawlError:
                yield None


def test_means_stay_as_they_were_when_their_stretch_ended(part, onset_samples):
    tows = [tow for tow in cut(part, onset_samples(9)) if tow is not None]
    assert len(tows[0]) == FEWEST
    assert tows[0].channels == WATCHED
    assert not np.isfinite(tows[-1].means[:SETTLING]).any()
    assert np.isfinite(tows[-1].means[SETTLING:]).any(axis=1).all()
    for tow in tows:
        np.testing.assert_array_equal(tows[-1].means[: len(tow)], tow.means)


def test_an_input_that_falls_silent_is_told(part, onset_samples):
    found = [
        tow is None
        for tow in cut(
            part, (one for one in onset_samples(14) if not 480.0 < one.stamp / SECOND < 600.0)
        )
    ]
    heard = found[FEWEST - 1 :]
    assert not heard[0]
    assert heard[-1]


def test_winches_that_run_are_a_manoeuvre(part, onset_samples):
    def running(sample):
        late = sample.stamp / SECOND - 400.0
        if not isinstance(sample, WinchSample) or late < 0.0:
            return sample
        length = 200.0 + 0.5 * min(late, 50.0)
        pace = 0.5 if late < 50.0 else 0.0
        return replace(sample, lengths=(length, length), speeds=(pace, pace))

    *_, tow = cut(part, map(running, onset_samples(9)))
    runs = np.flatnonzero(manoeuvres(tow))
    assert set(runs) >= {13, 14}
    assert set(runs) <= set(range(12, 17))


def test_a_course_has_followed_a_leap_when_the_minutes_before_are_all_behind_it():
    shares = counter_leap_shares(40)
    assert (np.diff(shares) >= 0.0).all()
    assert 0.0 < shares[0] < 0.15
    assert shares[22:] == pytest.approx(np.ones(18))
