"""How the histories of two programs are compared."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.lab.reference_codes.manoeuvre import History, apart


@pytest.fixture
def fine() -> History:
    times = np.linspace(0.0, 10.0, 101)
    return History(times, 300.0 + times, 4e4 - 100.0 * times, seconds=0.1)


def test_the_largest_difference_at_any_instant_counts(fine: History) -> None:
    bent = fine.depth.copy()
    bent[50] *= 1.02
    found = apart(replace(fine, depth=bent), fine)
    assert found.depth == pytest.approx(0.02)
    assert found.depth_rms == pytest.approx(0.02 / np.sqrt(101))
    assert found.tension == found.tension_rms == 0.0
    assert found.largest == found.depth


def test_histories_at_different_instants_are_compared_at_the_coarser_ones(fine: History) -> None:
    coarse = History(fine.times[::7], fine.depth[::7], fine.tension[::7], seconds=0.1)
    assert apart(coarse, fine).largest < 1e-12
    assert apart(fine, coarse).largest < 1e-12


def test_a_run_that_broke_down_is_infinitely_far(fine: History) -> None:
    broken = fine.tension.copy()
    broken[60:] = np.nan
    found = apart(replace(fine, tension=broken), fine)
    assert found.tension == found.largest == np.inf


def test_the_factor_is_time_towed_over_time_taken(fine: History) -> None:
    assert fine.factor == pytest.approx(100.0)
