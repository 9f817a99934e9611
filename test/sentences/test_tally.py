"""What cannot be read is counted in bounded memory; of two tellers the first is believed."""

from trawl_ros.core.time import SECOND
from trawl_ros.sentences.codec import Spoken
from trawl_ros.sentences.tally import MOST_REASONS, OTHERS, SHOWN, Tally
from trawl_ros.sentences.tellers import SILENT_NS, Tellers


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
    tellers = Tellers()
    spread = {('door/spread', 'distance'): 80.0}
    first, second = (Spoken(system, 'x', '', spread, None) for system in ('marport', 'scanmar'))
    assert not tellers.rival(first, 'udp', '', 0)
    assert tellers.rival(second, 'udp', '', SECOND)
    assert tellers.rival(first, 'serial', '', SECOND)
    assert not tellers.rival(first, 'udp', '', 2 * SECOND)
    assert tellers.rival(second, 'udp', '', SILENT_NS)
    assert not tellers.rival(second, 'udp', '', 2 * SECOND + SILENT_NS)
    assert tellers.rival(first, 'udp', '', 2 * SECOND + SILENT_NS)
