"""State of live links: counts in bounded memory, one source for each topic, and clocks."""

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.sentences.codec import Spoken
from trawl_ros.sentences.links import (
    MOST_REASONS,
    OTHERS,
    SHOWN,
    SILENT_NS,
    LinkClock,
    Source,
    SourceArbiter,
    Tally,
)


def test_reasons_without_end_are_counted_together():
    tally = Tally()
    for number in range(1000):
        tally.refuse(f'sentence ${number}', b'\x1b[2J' + b'x' * 5000)
    assert tally.refused == 1000
    assert len(tally.reasons) == MOST_REASONS + 1
    assert tally.reasons[OTHERS] == 1000 - MOST_REASONS
    line, reason = tally.last
    assert len(line) <= SHOWN
    assert line.isprintable()
    assert reason == 'sentence $999'


def test_of_two_that_tell_a_topic_the_first_is_believed_until_it_is_silent():
    tellers = SourceArbiter()

    def rival(system, link, now):
        spoken = Spoken(system, 'x', '', {('door/spread', 'distance'): 80.0}, None)
        kept, rival = tellers.believed(spoken, Source(link, system, '', '', 0), now)
        assert bool(kept.readings) == (rival is None)
        return rival

    assert not rival('marport', 'udp', 0)
    assert rival('scanmar', 'udp', SECOND)
    assert rival('marport', 'serial', SECOND)
    assert not rival('marport', 'udp', 2 * SECOND)
    assert rival('scanmar', 'udp', SILENT_NS)
    assert not rival('scanmar', 'udp', 2 * SECOND + SILENT_NS)
    assert rival('marport', 'udp', 2 * SECOND + SILENT_NS)


def test_of_a_ships_sentences_the_first_row_is_preferred_and_each_tells_what_no_other_does():
    tellers = SourceArbiter()
    fix, velocity = ('vessel/fix', 'latitude'), ('vessel/velocity_ground', 'speed')

    def topics(name, rank, *readings):
        spoken = Spoken('ship', name, 'GP', dict.fromkeys(readings, 1.0), None)
        kept, rival = tellers.believed(spoken, Source('udp', 'ship', 'GP', name, rank), SECOND)
        assert rival is None
        return kept.topics

    assert topics('RMC', 3, fix, velocity) == ('vessel/fix', 'vessel/velocity_ground')
    assert topics('GGA', 0, fix) == ('vessel/fix',)
    assert topics('RMC', 3, fix, velocity) == ('vessel/velocity_ground',)
    assert topics('GLL', 4, fix) == ()


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
