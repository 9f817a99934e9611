"""Of damaged bags `Bag` gives what is readable, and says what is not."""

import struct

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader

from trawl_ros.bags.reader import Bag, summarise
from trawl_ros.bags.storage.chunks import MAX_CHUNK_BYTES
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError

WINCH, PRESSURE = '/trawl/winch/joint_states', '/trawl/door/port/pressure'


def middle_of_chunk(path, number):
    with path.open('rb') as stream:
        index = make_reader(stream).get_summary().chunk_indexes[number]
    return index.chunk_start_offset + index.chunk_length // 2


def flip_byte(path, place):
    whole = bytearray(path.read_bytes())
    whole[place] ^= 0xFF
    path.write_bytes(whole)


def test_a_missing_bag_is_named(tmp_path):
    with pytest.raises(BagError, match='nowhere: '):
        Bag(tmp_path / 'nowhere')


def test_an_empty_folder_is_no_bag(tmp_path):
    with pytest.raises(BagError, match=rf'{tmp_path}.*metadata\.yaml.*\.mcap'):
        Bag(tmp_path)


def test_an_empty_file_is_no_bag(bag_path, mcap_path):
    mcap_path.write_bytes(b'')
    with pytest.raises(BagError, match=r'trial_0\.mcap: .*empty'):
        Bag(bag_path)


@pytest.mark.parametrize(
    ('name', 'content', 'words'),
    [
        ('log.csv', b'time,depth\n1,2\n', r'log\.csv: starts with .time,dep'),
        ('x.db3', b'garbage' * 100, r'x\.db3: cannot be read'),
    ],
)
def test_another_kind_of_file_is_no_bag(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BagError, match=words):
        Bag(tmp_path / name)


def test_a_bag_without_messages_gives_none_and_says_so(tmp_path, read):
    BagWriter(tmp_path / 'bag').close()
    assert summarise(tmp_path / 'bag').problems == (f'{tmp_path / "bag"}: holds no message',)
    with pytest.raises(BagError, match='holds no message'):
        read(tmp_path / 'bag')


def test_a_bag_without_its_file_names_it(bag_path, mcap_path):
    mcap_path.unlink()
    with pytest.raises(BagError, match=r'names trial_0\.mcap'):
        Bag(bag_path)


def test_a_bag_without_metadata_is_read_and_said(bag_path, messages, raw):
    (bag_path / 'metadata.yaml').unlink()
    found, problems = raw(bag_path)
    assert found == messages
    assert 'no metadata.yaml' in problems[0]


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        ('{', 'not YAML'),
        ('a: 1', 'no key rosbag2_bagfile_information'),
        ('rosbag2_bagfile_information: {version: 8}', 'storage_identifier: missing'),
    ],
)
def test_metadata_that_are_none_are_refused(bag_path, text, words):
    (bag_path / 'metadata.yaml').write_text(text)
    with pytest.raises(BagError, match=rf'metadata\.yaml: .*{words}'):
        Bag(bag_path)


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        (lambda topic: topic.update(message_count=299), '299 messages .* 300'),
        (lambda topic: topic['topic_metadata'].update(name='/other'), 'messages of .* on /other'),
        (lambda topic: topic['topic_metadata'].update(type='std_msgs/msg/Bool'), 'JointState'),
    ],
)
def test_metadata_and_content_that_disagree_are_refused(bag_path, change, words):
    path = bag_path / 'metadata.yaml'
    data = yaml.safe_load(path.read_text())
    change(data['rosbag2_bagfile_information']['topics_with_message_count'][0])
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(BagError, match=words):
        Bag(bag_path)
    assert summarise(bag_path / 'trial_0.mcap').count == 600


def test_of_a_file_cut_anywhere_whole_chunks_are_used(bag_path, mcap_path, messages):
    whole = mcap_path.read_bytes()
    seen = set()
    for size in range(9, len(whole), len(whole) // 60):
        mcap_path.write_bytes(whole[:size])
        bag = Bag(bag_path)
        try:
            found = [(m.topic, m.type, m.data, m.log_time) for m in bag.raw()]
        except BagError:
            found = []
        assert found == messages[: len(found)]
        assert 'cut short' in ' '.join(bag.problems)
        seen.add(len(found))
    assert seen == {0, 120, 240, 360, 480, 600}


def test_a_file_cut_short_says_how_much_is_missing(bag_path, mcap_path, read):
    whole = mcap_path.read_bytes()
    mcap_path.write_bytes(whole[: len(whole) // 2])
    received, problems = read(bag_path)
    assert 0 < len(received) < 600
    assert f'{len(received)} of 600 messages' in problems[-1]


def test_a_recording_that_was_killed_says_what_it_has_more_than_it_counted(
    bag_path, mcap_path, messages, raw
):
    whole = mcap_path.read_bytes()
    mcap_path.write_bytes(whole[: middle_of_chunk(mcap_path, 4)])
    path = bag_path / 'metadata.yaml'
    data = yaml.safe_load(path.read_text())
    data['rosbag2_bagfile_information']['message_count'] = 360
    path.write_text(yaml.safe_dump(data))
    found, problems = raw(bag_path)
    assert found == messages[:480]
    assert '480 messages' in problems[-1]
    assert '120 more' in problems[-1]


def test_no_flipped_byte_passes_or_crashes(bag_path, mcap_path, messages, raw):
    whole = mcap_path.read_bytes()
    random = np.random.default_rng(11)
    for place in random.integers(8, len(whole), 150):
        mcap_path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :])
        try:
            found, problems = raw(bag_path)
        except BagError:
            continue
        assert set(found) <= set(messages), f'byte {place} came through'
        assert len(found) == len(messages) or problems, f'byte {place} lost in silence'


def test_a_damaged_chunk_is_stepped_over_and_said(bag_path, mcap_path, messages, raw):
    flip_byte(mcap_path, middle_of_chunk(mcap_path, 2))
    found, problems = raw(bag_path)
    assert found == messages[:240] + messages[360:]
    assert 'damaged' in problems[0]
    assert 'skipped' in problems[0]
    assert '480 of 600 messages' in problems[1]


def test_without_the_chunk_that_describes_the_topics_the_index_does(
    bag_path, mcap_path, messages, raw
):
    flip_byte(mcap_path, middle_of_chunk(mcap_path, 0))
    assert raw(bag_path)[0] == messages[120:]


def test_a_chunk_that_claims_an_absurd_size_takes_no_memory(bag_path, mcap_path, raw):
    whole = bytearray(mcap_path.read_bytes())
    (header,) = struct.unpack_from('<Q', whole, 9)
    claimed = 8 + 9 + header + 9 + 16
    whole[claimed : claimed + 8] = struct.pack('<Q', 1 << 60)
    mcap_path.write_bytes(whole)
    found, problems = raw(bag_path)
    assert len(found) == 480
    assert f'more than the {MAX_CHUNK_BYTES} that are read' in problems[0]
