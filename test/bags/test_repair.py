"""`trawl bag repair` saves what passes its checksum, counts what does not, and touches nothing."""

import shutil
from collections import Counter

import pytest
import yaml
from click.testing import CliRunner
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.rosbag2 import Reader

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import repair_bag
from trawl_ros.bags.storage.mcap_file import McapFile
from trawl_ros.bags.writer import BagWriter
from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import BagError

WINCH, PRESSURE = '/trawl/winch/joint_states', '/trawl/door/port/pressure'


def raw(path):
    return [(m.topic, m.type, m.data, m.log_time) for m in Bag(path).raw()]


def by_rosbags(path):
    with Reader(path) as reader:
        found = [(c.topic, c.msgtype, bytes(data), time) for c, time, data in reader.messages()]
        assert len(found) == reader.message_count
    return found


def chunks(path):
    with path.open('rb') as stream:
        found = make_reader(stream).get_summary().chunk_indexes
    return [(index.chunk_start_offset, index.chunk_length) for index in found]


def flip(path, place):
    whole = bytearray(path.read_bytes())
    whole[place] ^= 0xFF
    path.write_bytes(whole)


def cut(path, size):
    path.write_bytes(path.read_bytes()[:size])


def state(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def edit(bag_path, change):
    path = bag_path / 'metadata.yaml'
    data = yaml.safe_load(path.read_text())
    change(data['rosbag2_bagfile_information'])
    path.write_text(yaml.safe_dump(data))


def test_of_a_sound_bag_nothing_is_written(bag_path):
    before = state(bag_path)
    done = repair_bag(bag_path)
    assert (done.out, done.problems, done.whole) == (None, (), True)
    assert done.saved == {WINCH: 300, PRESSURE: 300}
    assert [path.name for path in bag_path.parent.iterdir()] == ['trial']
    assert state(bag_path) == before


def test_of_a_bag_cut_short_all_whole_chunks_come_back_with_index_and_metadata(
    bag_path, mcap_path, messages
):
    third = chunks(mcap_path)[3][0]
    cut(mcap_path, third + 100)
    before = state(bag_path)
    done = repair_bag(bag_path)
    assert done.out == bag_path.parent / 'trial_repaired'
    assert (done.saved, done.lost) == ({WINCH: 180, PRESSURE: 180}, {WINCH: 120, PRESSURE: 120})
    assert state(bag_path) == before
    assert raw(done.out) == by_rosbags(done.out) == messages[:360]
    file = McapFile(done.out / 'trial_repaired_0.mcap', pytest.fail)
    assert file.complete
    assert file.indexed
    assert repair_bag(done.out).out is None


def test_cut_between_two_chunks_nothing_that_was_counted_need_be_lost(bag_path, mcap_path):
    offset, _ = chunks(mcap_path)[2]
    cut(mcap_path, offset)
    edit(bag_path, lambda data: data.update(message_count=240, topics_with_message_count=[]))
    done = repair_bag(bag_path)
    assert done.whole
    assert sum(done.saved.values()) == 240


def test_a_damaged_chunk_costs_its_own_messages_only(bag_path, mcap_path, messages):
    offset, length = chunks(mcap_path)[2]
    flip(mcap_path, offset + length // 2)
    done = repair_bag(bag_path)
    assert raw(done.out) == by_rosbags(done.out) == messages[:240] + messages[360:]
    assert done.lost == {WINCH: 60, PRESSURE: 60}
    assert 'skipped' in ' '.join(done.problems)


@pytest.mark.parametrize('compression', ['zstd', 'lz4', 'none'])
@pytest.mark.parametrize('place', [0, 3, 30, 34], ids=['opcode', 'length', 'size', 'crc'])
def test_without_an_index_the_next_chunk_is_found_behind_a_damaged_header(
    tmp_path, messages, compression, place
):
    path = tmp_path / 'trial'
    with BagWriter(path, compression=compression) as bag:
        for number, message in enumerate(messages, start=1):
            bag.write(*message)
            if number % 120 == 0:
                bag.flush()
    file = path / 'trial_0.mcap'
    starts = [offset for offset, _ in chunks(file)]
    flip(file, starts[2] + place)
    cut(file, starts[4] + 50)
    done = repair_bag(path)
    assert raw(done.out) == messages[:240] + messages[360:480]
    assert sum(done.lost.values()) == 240


def test_a_length_gone_wrong_between_chunks_hides_no_chunk(bag_path, mcap_path, messages):
    offset, length = chunks(mcap_path)[1]
    index_of_messages = offset + length
    flip(mcap_path, index_of_messages + 2)
    cut(mcap_path, chunks_end(mcap_path))
    done = repair_bag(bag_path)
    assert raw(done.out) == messages[:480]


def chunks_end(path):
    """Just before the end of the last chunk."""
    found = [*chunks(path)][-1]
    return found[0] + found[1] - 1


@pytest.mark.parametrize(
    'change',
    [
        lambda data: data.pop('files'),
        lambda data: data.pop('ros_distro'),
        lambda data: data.update(message_count=1),
        lambda data: data['starting_time'].update(nanoseconds_since_epoch=5),
        lambda data: data['topics_with_message_count'][0].update(message_count=9),
        lambda data: data['topics_with_message_count'][1]['topic_metadata'].pop('type'),
    ],
    ids=['files', 'ros_distro', 'message_count', 'starting_time', 'count of a topic', 'type'],
)
def test_metadata_that_lack_or_misstate_something_are_made_anew(bag_path, messages, change):
    edit(bag_path, change)
    done = repair_bag(bag_path)
    assert done.problems
    assert done.whole
    assert raw(done.out) == by_rosbags(done.out) == messages
    assert repair_bag(done.out).out is None


@pytest.mark.parametrize('text', [None, '{', ''], ids=['none', 'not YAML', 'empty'])
def test_metadata_that_are_not_there_are_made_anew(bag_path, messages, text):
    (bag_path / 'metadata.yaml').unlink()
    if text is not None:
        (bag_path / 'metadata.yaml').write_text(text)
    done = repair_bag(bag_path)
    assert raw(done.out) == by_rosbags(done.out) == messages


def test_what_the_bag_says_of_a_topic_is_kept(bag_path, mcap_path):
    cut(mcap_path, chunks(mcap_path)[4][0])
    done = repair_bag(bag_path)
    assert Bag(done.out).definitions() == Bag(bag_path).definitions()


def test_custom_data_are_kept(tmp_path, messages):
    with BagWriter(tmp_path / 'bag', custom_data={'seed': '7'}) as bag:
        bag.write(*messages[0])
    cut(tmp_path / 'bag' / 'bag_0.mcap', -40)
    assert Bag(repair_bag(tmp_path / 'bag').out).custom_data == {'seed': '7'}


def test_types_that_are_not_known_here_are_saved_with_their_definition(tmp_path):
    path = tmp_path / 'lab.mcap'
    with path.open('wb') as stream:
        writer = Writer(stream)
        writer.start('ros2', 'test')
        schema = writer.register_schema('lab_msgs/msg/Thing', 'ros2msg', b'float64 weight')
        channel = writer.register_channel('/lab/thing', 'cdr', schema)
        for stamp in range(5):
            writer.add_message(channel, stamp, b'\x00\x01\x00\x00' + bytes(8), stamp)
        writer.finish()
    cut(path, -20)
    done = repair_bag(path)
    (definition,) = Bag(done.out).definitions().values()
    assert (definition.type, definition.text) == ('lab_msgs/msg/Thing', b'float64 weight')
    assert [message.message.weight for message in Bag(done.out).messages()] == [0.0] * 5


@pytest.fixture
def split_bag(tmp_path, messages):
    path = tmp_path / 'split'
    with BagWriter(path) as bag:
        for number, message in enumerate(messages):
            if number and number % 50 == 0:
                bag.split()
            bag.write(*message)
    return path


def test_a_bag_in_many_files_is_repaired_file_for_file(split_bag, messages):
    cut(split_bag / 'split_11.mcap', 3000)
    done = repair_bag(split_bag)
    saved = raw(done.out)
    assert messages[:550] == saved[:550]
    assert len(list(done.out.glob('*.mcap'))) in (11, 12)
    assert by_rosbags(done.out) == saved
    assert yaml.safe_load((done.out / 'metadata.yaml').read_text())['rosbag2_bagfile_information'][
        'relative_file_paths'
    ][:3] == [f'split_repaired_{number}.mcap' for number in range(3)]


def test_a_file_that_is_gone_is_named_and_its_messages_are_lost(split_bag):
    (split_bag / 'split_3.mcap').unlink()
    done = repair_bag(split_bag)
    assert 'names split_3.mcap' in ' '.join(done.problems)
    assert sum(done.lost.values()) == 50


def test_a_file_that_metadata_do_not_name_belongs_to_the_bag_by_its_name_only(split_bag, messages):
    shutil.copy(split_bag / 'split_0.mcap', split_bag / 'copy_0.mcap')
    edit(split_bag, lambda data: data['relative_file_paths'].pop())
    done = repair_bag(split_bag)
    assert raw(done.out) == messages
    problems = ' '.join(done.problems)
    assert 'does not name split_11.mcap' in problems
    assert 'copy_0.mcap is not' in problems


def test_messages_whose_type_changes_on_a_topic_are_left_out_and_said(tmp_path, messages):
    folder = tmp_path / 'bag'
    folder.mkdir()
    for number, (_, kind, data, stamp) in enumerate((messages[0], messages[1])):
        with BagWriter(tmp_path / f'part{number}') as bag:
            bag.write('/x', kind, data, stamp)
        (file,) = bag.path.glob('*.mcap')
        shutil.copy(file, folder / f'x_{number}.mcap')
    done = repair_bag(folder)
    assert done.saved == {'/x': 1}
    assert '1 messages on /x' in ' '.join(done.problems)
    assert done.lost == {'/x': 1}


def test_nothing_is_written_over(bag_path, mcap_path):
    cut(mcap_path, -40)
    out = bag_path.parent / 'trial_repaired'
    out.mkdir()
    (out / 'mine.txt').write_text('kept')
    with pytest.raises(BagError, match='trial_repaired: exists already'):
        repair_bag(bag_path)
    assert state(out) == {'mine.txt': b'kept'}


@pytest.mark.parametrize(
    ('spoil', 'words'),
    [
        (lambda bag: cut(bag / 'trial_0.mcap', 40), 'nothing can be saved'),
        (lambda bag: (bag / 'trial_0.mcap').write_bytes(b''), r'trial_0\.mcap'),
        (lambda bag: edit(bag, lambda data: data.update(compression_mode='FILE')), 'unpack them'),
        (shutil.rmtree, 'no such bag'),
    ],
    ids=['header only', 'empty file', 'compressed files', 'no bag'],
)
def test_what_cannot_be_repaired_is_an_error_and_leaves_nothing(bag_path, spoil, words):
    spoil(bag_path)
    with pytest.raises(BagError, match=words):
        repair_bag(bag_path)
    assert not (bag_path.parent / 'trial_repaired').exists()


def run(*words):
    return CliRunner().invoke(trawl, ['bag', 'repair', *map(str, words)])


def test_the_command_says_what_was_saved_and_lost_also_by_its_exit_code(
    bag_path, mcap_path, tmp_path
):
    assert run(bag_path).exit_code == 0
    cut(mcap_path, chunks(mcap_path)[4][0] + 10)
    done = run(bag_path, '--out', tmp_path / 'new')
    assert done.exit_code == 3
    assert f'{tmp_path / "new"}: 480 messages saved' in done.output
    assert f'Lost: 60 of 300 on {WINCH}' in done.output
    assert 'Damaged: ' in done.output
    assert run(bag_path, '--out', tmp_path / 'new').exit_code == 1
    assert run(tmp_path / 'nowhere').exit_code == 1


def test_what_may_have_been_lost_uncounted_counts_as_lost(bag_path, mcap_path, tmp_path):
    cut(mcap_path, chunks(mcap_path)[4][0] + 10)
    (bag_path / 'metadata.yaml').unlink()
    done = run(bag_path)
    assert done.exit_code == 3
    assert 'Lost: unknown' in done.output.replace('\n', ' ')


def test_bytes_flipped_anywhere_come_through_nowhere(bag_path, mcap_path, messages, tmp_path):
    whole, allowed = mcap_path.read_bytes(), set(messages)
    for number, place in enumerate(range(20, len(whole), len(whole) // 40)):
        mcap_path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :])
        out = tmp_path / f'out{number}'
        done = repair_bag(bag_path, out)
        if done.out is None:
            continue
        saved = raw(out)
        assert set(saved) <= allowed, f'byte {place} came through'
        assert sum(Counter(done.lost).values()) == len(messages) - len(saved)
