"""Set points from outside are held to limits, and given up when they fall silent."""

import math

import pytest

from trawl_ros.control.set_points import SetPointGuard, SetPointLimits
from trawl_ros.core.time import SECOND

LIMITS = SetPointLimits(min_length=100.0, max_length=600.0, max_step=20.0, timeout_ns=5 * SECOND)


@pytest.fixture
def guard():
    guard = SetPointGuard(LIMITS)
    guard.see((400.0, 401.0))
    return guard


@pytest.mark.parametrize(
    ('wanted', 'reason'),
    [
        ((99.0, 400.0), 'port warp: .* 100 to 600'),
        ((400.0, 601.0), 'starboard warp: .* 100 to 600'),
        ((math.inf, 400.0), 'port warp'),
        ((400.0, 425.0), 'starboard warp: .* 20 m'),
    ],
)
def test_warps_beyond_the_limits_are_refused_and_wake_nothing(guard, wanted, reason):
    with pytest.raises(ValueError, match=reason):
        guard.warps(wanted, 0)
    assert not guard.active
    assert guard.silence(100 * SECOND) is None


def test_nothing_is_wanted_of_winches_whose_counters_are_unknown():
    with pytest.raises(ValueError, match=r'port warp: .* counter'):
        SetPointGuard(LIMITS).warps((400.0, math.nan), 0)


def test_silence_holds_what_the_counters_show_once(guard):
    assert guard.warps((410.0, math.nan), 0) == pytest.approx((410.0, math.nan), nan_ok=True)
    guard.see((405.0, 401.0))
    assert guard.silence(5 * SECOND) is None
    assert guard.silence(5 * SECOND + 1) == (405.0, 401.0)
    assert guard.silence(60 * SECOND) is None
    assert not guard.active


@pytest.mark.parametrize('asked', [(-0.1, 0.0), (9.0, 0.0), (math.nan, 0.0), (2.0, 0.1)])
def test_a_ship_beyond_the_limits_is_refused(guard, asked):
    with pytest.raises(ValueError, match=r'speed|turn'):
        guard.ship(*asked)
    assert guard.ship(2.0, -0.01) == (2.0, -0.01)
