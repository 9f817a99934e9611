"""Topics of one instant come together again by their stamps, whatever their order."""

import pytest

from trawl_ros.nodes.instrument_node import LONGEST_WAIT, Joiner


@pytest.fixture
def joiner():
    return Joiner(('left', 'right'))


def test_an_instant_is_complete_with_its_last_topic(joiner):
    assert joiner.add('left', 1, 'l1') is None
    assert joiner.add('left', 2, 'l2') is None
    assert joiner.add('right', 1, 'r1') == {'left': 'l1', 'right': 'r1'}
    assert joiner.add('right', 2, 'r2') == {'left': 'l2', 'right': 'r2'}
    assert joiner.incomplete == 0


def test_what_was_lost_is_counted_and_not_mixed_up(joiner):
    joiner.add('left', 1, 'l1')
    joiner.add('left', 2, 'l2')
    assert joiner.add('right', 2, 'r2') == {'left': 'l2', 'right': 'r2'}
    assert joiner.incomplete == 1


def test_time_set_back_mixes_no_runs(joiner):
    for stamp in (1, 2, 1):
        joiner.add('left', stamp, f'l{stamp}')
    # The right side still has to deliver the first run.
    assert joiner.add('right', 1, 'r1') is not None
    assert joiner.add('right', 2, 'r2') == {'left': 'l2', 'right': 'r2'}
    assert joiner.add('right', 1, 'again') == {'left': 'l1', 'right': 'again'}
    assert joiner.incomplete == 0


def test_a_topic_that_never_comes_does_not_fill_the_memory(joiner):
    for stamp in range(3 * LONGEST_WAIT):
        joiner.add('left', stamp, None)
    assert joiner.incomplete == 2 * LONGEST_WAIT


def test_who_begins_to_listen_while_time_is_set_back_joins_the_new_run(joiner):
    # The end of the run before was heard on one side only.
    joiner.add('left', 50, 'old')
    assert joiner.add('left', 1, 'l1') is None
    assert joiner.add('right', 1, 'r1') == {'left': 'l1', 'right': 'r1'}
    assert joiner.add('right', 2, 'r2') is None
    assert joiner.add('left', 2, 'l2') == {'left': 'l2', 'right': 'r2'}


@pytest.mark.parametrize('order', ['ab', 'ba'])
@pytest.mark.parametrize('false', [-7, 7])
def test_a_single_false_stamp_parts_no_topics_for_ever(order, false):
    joiner = Joiner(['a', 'b'])
    for stamp in range(10):
        for topic in order:
            joiner.add(topic, stamp, topic)
    joiner.add('a', 9 + false, 'false')
    found = [joiner.add(topic, stamp, topic) for stamp in range(10, 20) for topic in order]
    assert sum(one is not None for one in found) >= 9
