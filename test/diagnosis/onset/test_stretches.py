"""Stretches of a tow that goes on tell by how much a counter has leapt beside its winch."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from trawl_ros.diagnosis.onset.stretches import counter_leap, counter_leap_shares
from trawl_ros.estimation.motion.series import Series

TIMES = np.arange(0.0, 120.0, 0.5)


def test_a_leap_is_seen_while_the_winch_runs_and_a_pay_out_is_none():
    speeds = 0.8 * np.clip(np.minimum(TIMES - 40.0, 70.0 - TIMES) / 5.0, 0.0, 1.0)
    true = 400.0 + cumulative_trapezoid(speeds, TIMES, initial=0.0)
    shown = true + np.where(TIMES >= 47.0, 1.5, 0.0)
    counter = Series(TIMES, shown, 0.05)
    stretches = [
        counter_leap(counter, Series(TIMES, speeds), begin, begin + 30.0) for begin in (30.0, 60.0)
    ]
    assert stretches[0].length == pytest.approx(1.5, abs=0.15)
    assert stretches[1].length == pytest.approx(0.0, abs=0.15)
    assert 0.02 < stretches[0].std < 0.15


def test_a_course_has_followed_a_leap_when_the_minutes_before_are_all_behind_it():
    shares = counter_leap_shares(20)
    assert (np.diff(shares) >= 0.0).all()
    assert 0.05 < shares[0] < 0.15
    assert shares[12:] == pytest.approx(np.ones(8))
