"""Messages of a channel whose description was lost are told by evidence, or left out."""

import random
import shutil

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import repair_bag
from trawl_ros.bags.storage.mcap_output import LIBRARY, McapOutput
from trawl_ros.bags.storage.metadata import FileEntry, TopicEntry, dump_metadata
from trawl_ros.bags.storage.stored import describe
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.resources import share_path
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.pieces import topic_header, vector
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import WinchSample

WINCH, PRESSURE = '/trawl/winch/joint_states', '/trawl/door/port/pressure'


def chunks(path):
    with path.open('rb') as stream:
        found = make_reader(stream).get_summary().chunk_indexes
    return [(index.chunk_start_offset, index.chunk_length) for index in found]


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
    assert 'as damaged parts of the file say and metadata.yaml confirms' in problems
    done = repair_bag(once)
    assert done.saved == {WINCH: 240, PRESSURE: 240}
    assert Bag(done.out).definitions() == {
        WINCH: describe('sensor_msgs/msg/JointState', Bag(done.out).definitions()[WINCH].qos),
        PRESSURE: describe('sensor_msgs/msg/FluidPressure', Bag(done.out).definitions()[WINCH].qos),
    }


@pytest.mark.parametrize(
    ('metadata', 'words'),
    [
        (True, 'fit no other topic of metadata.yaml'),
        (False, "fit no other topic of the project's"),
    ],
)
def test_without_any_description_messages_tell_what_they_are(
    once, mcap_path, messages, metadata, words
):
    wipe(mcap_path)
    if not metadata:
        (once / 'metadata.yaml').unlink()
    found, problems = found_in(once)
    assert found == messages[120:]
    assert words in problems


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
            found, problems = found_in(once)
            assert found == messages[120:], problems


def write_angles(path, library, order):
    """Write angles of both doors, of one type and frame, and a winch, as a library would."""
    stamp = 1_785_000_000_000_000_000
    angles = ros.geometry_msgs__msg__Vector3Stamped(
        topic_header(stamp, 'truth/door/port/angles'), vector((0.1, 0.2, 0.3))
    )
    winch = sample_message(WinchSample(stamp, (1.0, 2.0), (0.0, 0.0), (5.0, 6.0)))[1]
    topics = {
        '/trawl/truth/door/port/angles': angles,
        '/trawl/truth/door/starboard/angles': angles,
        WINCH: winch,
    }
    path.mkdir()
    with (path / 'angles_0.mcap').open('wb') as stream:
        writer = Writer(stream)
        writer.start('ros2', library)
        numbers = {}
        for topic, message in topics.items():
            said = describe(message.__msgtype__, '')
            schema = writer.register_schema(said.type, said.schema_encoding, said.text)
            numbers[topic] = writer.register_channel(topic, 'cdr', schema)
        for second in range(20):
            for topic, message in topics.items():
                writer.add_message(numbers[topic], stamp + second, serialize(message), stamp)
            if second % 10 == 9:
                writer.flush()
        writer.finish()
    said = {topic: describe(message.__msgtype__, '') for topic, message in topics.items()}
    (path / 'metadata.yaml').write_text(
        dump_metadata(
            [FileEntry('angles_0.mcap', 60, (stamp, stamp + 19))],
            [TopicEntry(topic, said[topic], 20) for topic in order(list(topics))],
            {},
        )
    )
    return path


def test_of_two_topics_that_would_do_none_is_taken(tmp_path):
    path = write_angles(tmp_path / 'angles', 'another', list)
    wipe(path / 'angles_0.mcap')
    found, problems = found_in(path)
    assert {topic for topic, *_ in found} == {WINCH}
    assert '10 messages of channel 1, whose description was lost, were left out' in problems
    assert '10 messages of channel 2' in problems


def test_our_own_order_tells_them_apart(tmp_path):
    path = write_angles(tmp_path / 'angles', LIBRARY, list)
    before, _ = found_in(path)
    wipe(path / 'angles_0.mcap')
    found, problems = found_in(path)
    assert sorted(found) == sorted(before[30:])
    assert 'at this place among the topics of metadata.yaml' in problems


def test_an_order_that_does_not_agree_tells_nothing(tmp_path):
    path = write_angles(tmp_path / 'angles', LIBRARY, lambda topics: topics[::-1])
    wipe(path / 'angles_0.mcap')
    found, _ = found_in(path)
    assert {topic for topic, *_ in found} == {WINCH}


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
    spoil(file, (5000, 1), (file.stat().st_size - 3000, 1), flip=1)
    done = repair_bag(bag)
    assert sum(done.saved.values()) == 121_693
    assert sum(done.lost.values()) == 129_113 - 121_693
    assumed = any('confirms' in problem for problem in done.problems)
    assert assumed == (described != 'again and again')
