"""Between two times that a ship's clock says readings keep their order and their distance."""

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.sentences.link_clock import LinkClock

NOON = 12 * 3600 * SECOND


def test_it_goes_on_with_the_wall_between_two_times():
    clock = LinkClock()
    assert clock.stamp(5) is None
    stamps = []
    for tenth in range(30):
        arrived = 7 * SECOND + tenth * SECOND // 10
        if tenth % 10 == 0:
            clock.hear(NOON + tenth // 10 * SECOND, arrived)
        stamps.append(clock.stamp(arrived))
    assert stamps == [NOON + tenth * SECOND // 10 for tenth in range(30)]


def test_it_never_comes_to_the_next_time_when_data_are_slower_than_the_wall():
    clock = LinkClock()
    clock.hear(NOON, 0)
    assert clock.stamp(5 * SECOND) == NOON + SECOND - 1
    clock.hear(NOON + 10 * SECOND, 20 * SECOND)
    assert clock.stamp(29 * SECOND) == NOON + 19 * SECOND
    assert clock.stamp(99 * SECOND) == NOON + 20 * SECOND - 1


def test_data_that_are_faster_than_the_wall_keep_their_order():
    """Twenty times as fast: a second is over in 50 ms."""
    clock, stamps = LinkClock(), []
    for tenth in range(50):
        arrived = tenth * SECOND // 200
        if tenth % 10 == 0:
            clock.hear(NOON + tenth // 10 * SECOND, arrived)
        stamps.append(clock.stamp(arrived))
    assert (np.diff(stamps) > 0).all()
    true = NOON + np.arange(50) * SECOND // 10
    assert np.abs(stamps - true).max() < SECOND


def test_a_time_that_went_back_is_believed_when_three_agree():
    clock = LinkClock()
    assert clock.hear(NOON, 0)
    assert [clock.hear(n * SECOND, n * SECOND) for n in (1, 2, 3)] == [False, False, True]
    assert clock.stamp(3 * SECOND) == 3 * SECOND


def test_a_false_time_leaves_the_clock_as_it_is():
    clock = LinkClock()
    assert clock.hear(NOON, 0)
    assert not clock.hear(NOON * 1000, SECOND)
    assert clock.hear(NOON + 2 * SECOND, 2 * SECOND)
    assert clock.stamp(2 * SECOND) == NOON + 2 * SECOND
