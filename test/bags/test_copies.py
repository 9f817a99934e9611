"""A chunk that stands in a bag twice is read once, and said."""

import pytest
from mcap.reader import make_reader

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import repair_bag

COPY = 'copy of the one'


@pytest.fixture
def doubled(bag_path, mcap_path):
    """Give the small bag with its third chunk and that one's index written a second time."""
    with mcap_path.open('rb') as stream:
        third, fourth = make_reader(stream).get_summary().chunk_indexes[2:4]
    whole = mcap_path.read_bytes()
    start, end = third.chunk_start_offset, fourth.chunk_start_offset
    mcap_path.write_bytes(whole[:end] + whole[start:end] + whole[end:])
    return bag_path


def test_it_is_read_once(doubled, messages, raw):
    found, problems = raw(doubled)
    assert found == messages
    assert COPY in ' '.join(problems)
    assert 'messages could' not in ' '.join(problems)


def test_a_check_finds_it(doubled):
    done = check_bag(doubled)
    assert done.count == 600
    assert any(COPY in finding.text for finding in done.findings)
    assert 'order' not in {finding.kind for finding in done.findings}


def test_a_repaired_bag_has_its_messages_once(doubled, messages):
    done = repair_bag(doubled)
    assert done.whole
    assert [(m.topic, m.type, m.data, m.log_time) for m in Bag(done.out).raw()] == messages
    assert repair_bag(done.out).out is None


def test_one_that_took_the_place_of_another_costs_that_one(bag_path, mcap_path, messages, raw):
    with mcap_path.open('rb') as stream:
        places = [
            (index.chunk_start_offset, index.chunk_length)
            for index in make_reader(stream).get_summary().chunk_indexes
        ]
    whole = bytearray(mcap_path.read_bytes())
    (first, length), (second, _) = places[2], places[3]
    whole[second : places[4][0]] = whole[first : first + length]
    mcap_path.write_bytes(whole)
    found, _ = raw(bag_path)
    assert found == messages[:360] + messages[480:]
