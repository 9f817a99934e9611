"""Log times of the recorder: the header's stamp where it can be, else the time of receipt."""

import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.nodes.bag_recorder import LONGEST_WAIT_NS, LogTimes

NOW = 1_785_000_000 * SECOND
LATE = SECOND // 5


def logged(stamps, *, now=NOW):
    """Log times by message of stamps that come once a second, and the number of those replaced."""
    times = LogTimes()
    written = []
    for number, stamp in enumerate(stamps):
        written += times.take(stamp, now + number * SECOND, number)
    written += times.give_up(0, whole=True)
    by_message = {message: log_time for log_time, message in written}
    assert sorted(by_message) == list(range(len(stamps)))
    return [by_message[number] for number in range(len(stamps))], times.replaced


def test_stamps_are_log_times():
    stamps = [NOW + number * SECOND - LATE for number in range(5)]
    assert logged(stamps) == (stamps, 0)


@pytest.mark.parametrize(
    ('false', 'place'),
    [
        (0, 0),
        (315_964_800 * SECOND, 0),
        (2_100_000_000 * SECOND, 0),
        (0, 4),
        (1_115_251_200 * SECOND, 2),
        (NOW + 86_400 * SECOND, 4),
    ],
)
def test_a_stamp_that_cannot_be_is_replaced_by_the_time_of_receipt(false, place):
    stamps = [NOW + number * SECOND - LATE for number in range(8)]
    expected = [*stamps]
    expected[place] = NOW + place * SECOND
    stamps[place] = false
    assert logged(stamps) == (expected, 1)


def test_a_driver_that_never_stamps_is_logged_at_the_time_of_receipt():
    assert logged([0] * 4) == ([NOW + number * SECOND for number in range(4)], 4)


def test_what_never_stamps_does_not_wait_for_long():
    times = LogTimes()
    assert times.take(0, NOW, 'a') == []
    assert times.give_up(1) == []
    assert times.give_up(2 + LONGEST_WAIT_NS) == [(NOW, 'a')]


def test_a_simulation_from_zero_keeps_its_first_instant():
    stamps = [0, 0, SECOND, 2 * SECOND]
    assert logged(stamps, now=0) == (stamps, 0)


def test_a_bag_that_is_played_by_the_clock_of_the_wall_keeps_its_stamps_and_scale():
    year = 365 * 86_400 * SECOND
    stamps = [NOW - year + number * SECOND for number in range(3)]
    following = [stamps[-1] + SECOND, stamps[-1] + 2 * SECOND]
    assert logged([*stamps, 0, None]) == ([*stamps, *following], 1)


def test_a_bag_that_begins_again_keeps_its_stamps():
    round_of = [NOW + number * SECOND for number in range(4)]
    again = [stamp - 3600 * SECOND for stamp in round_of]
    assert logged([*round_of, *again]) == ([*round_of, *again], 0)
