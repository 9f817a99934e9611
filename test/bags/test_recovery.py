"""A lost description is taken from damaged parts if it is confirmed; else messages are left out."""

import random
import shutil

import pytest
from mcap.reader import make_reader
from mcap.records import Chunk, Message
from mcap.stream_reader import StreamReader, breakup_chunk

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import repair_bag
from trawl_ros.bags.storage.mcap_output import McapOutput
from trawl_ros.bags.storage.stored import describe
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.resources import share_path

WINCH, PRESSURE = '/trawl/winch/joint_states', '/trawl/door/port/pressure'


def chunks(path):
    with path.open('rb') as stream:
        found = make_reader(stream).get_summary().chunk_indexes
    return [(index.chunk_start_offset, index.chunk_length) for index in found]


def messages_of_first_chunk(path):
    with path.open('rb') as stream:
        records = StreamReader(stream, emit_chunks=True).records
        first = next(record for record in records if isinstance(record, Chunk))
        return sum(isinstance(record, Message) for record in breakup_chunk(first))


def summary_start(whole):
    """Where the footer says that the summary begins."""
    return int.from_bytes(whole[-28:-20], 'little')


@pytest.fixture
def once(bag_path, mcap_path, rewrite):
    """Give the small bag with its topics described in the first chunk and the summary only."""
    rewrite(mcap_path)
    return bag_path


def spoil(path, *places, flip=0):
    """Fill stretches of bytes with zeros, or turn bits of them over."""
    whole = bytearray(path.read_bytes())
    for start, length in places:
        for place in range(start, start + length):
            whole[place] = whole[place] ^ flip if flip else 0
    path.write_bytes(whole)


def wipe(path):
    """Leave nothing of the descriptions: neither first chunk nor summary."""
    start = summary_start(path.read_bytes())
    size = path.stat().st_size
    spoil(path, chunks(path)[0], (start, size - start))


def found_in(path):
    bag = Bag(path, lenient=True)
    found = [(m.topic, m.type, m.data, m.log_time) for m in bag.as_stored()]
    return found, ' '.join(bag.problems)


def test_two_flipped_bits_cost_one_chunk(once, mcap_path, messages):
    spoil(mcap_path, (chunks(mcap_path)[0][0] + 200, 1), (mcap_path.stat().st_size - 60, 1), flip=1)
    found, problems = found_in(once)
    assert found == messages[120:]
    assert 'metadata.yaml confirms' in problems
    done = repair_bag(once)
    assert done.saved == {WINCH: 240, PRESSURE: 240}
    assert Bag(done.out).definitions() == {
        WINCH: describe('sensor_msgs/msg/JointState', Bag(done.out).definitions()[WINCH].qos),
        PRESSURE: describe('sensor_msgs/msg/FluidPressure', Bag(done.out).definitions()[WINCH].qos),
    }


def test_without_any_description_messages_are_left_out_and_counted(once, mcap_path):
    wipe(mcap_path)
    found, problems = found_in(once)
    assert found == []
    assert 'messages of channel 1,' in problems


def test_no_damage_to_the_last_description_makes_a_message_another(once, mcap_path, messages):
    start, whole = summary_start(mcap_path.read_bytes()), mcap_path.read_bytes()
    first = chunks(mcap_path)[0]
    generator = random.Random(7)
    for metadata in (True, False):
        if not metadata:
            (once / 'metadata.yaml').unlink()
        for _ in range(15):
            mcap_path.write_bytes(whole)
            places = [(generator.randrange(start, len(whole) - 100), 1) for _ in range(3)]
            spoil(mcap_path, first, *places, flip=1 << generator.randrange(8))
            spoil(mcap_path, first)
            found, _ = found_in(once)
            assert set(found) <= set(messages[120:])


def test_eight_flipped_bits_never_cost_a_chunk_that_they_miss(once, mcap_path, messages):
    places, whole = chunks(mcap_path), mcap_path.read_bytes()
    generator = random.Random(20261122)
    for _ in range(50):
        spoilt, damaged = bytearray(whole), set()
        for _ in range(8):
            bit = generator.randrange(8 * len(whole))
            spoilt[bit // 8] ^= 1 << bit % 8
            damaged |= {
                number
                for number, (start, length) in enumerate(places)
                if start <= bit // 8 < start + length
            }
        mcap_path.write_bytes(spoilt)
        found, _ = found_in(once)
        whole_ones = [message for n, message in enumerate(messages) if n // 120 not in damaged]
        assert set(whole_ones) <= set(found) <= set(messages)
        assert len(found) == len(set(found))


def write_as_0_1_0(bag, path, monkeypatch):
    """Write a bag again with its topics described in the first chunk and the summary only."""
    monkeypatch.setattr(McapOutput, '_repeat_descriptions', lambda self: None)
    with BagWriter(path) as writer:
        for topic, definition in bag.definitions().items():
            writer.declare(topic, definition)
        for m in bag.as_stored():
            writer.write(m.topic, m.type, m.data, m.log_time, m.publish_time)


@pytest.mark.slow
@pytest.mark.parametrize('described', ['again and again', 'once, as by 0.1.0'])
def test_of_the_sample_all_but_the_damaged_chunk_is_saved(tmp_path, monkeypatch, described):
    bag, sample = tmp_path / 'sea_trial', share_path('bags', 'sea_trial')
    if described == 'again and again':
        shutil.copytree(sample, bag)
    else:
        write_as_0_1_0(Bag(sample), bag, monkeypatch)
    file = bag / 'sea_trial_0.mcap'
    lost = messages_of_first_chunk(file)
    spoil(file, (5000, 1), (file.stat().st_size - 3000, 1), flip=1)
    done = repair_bag(bag)
    assert sum(done.lost.values()) == lost > 0
    assert sum(done.saved.values()) == sum(1 for _ in Bag(sample).as_stored()) - lost
    assumed = any('confirms' in problem for problem in done.problems)
    assert assumed == (described != 'again and again')
