"""What `BagWriter` leaves is a rosbag2 bag that all readers understand."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.records import Channel, Chunk
from mcap.stream_reader import StreamReader, breakup_chunk
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from trawl_ros.bags.reader import Bag, summarise
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.messages.cdr import serialize, type_hash
from trawl_ros.messages.estimates import estimate_message

WINCH, PRESSURE = '/trawl/winch/joint_states', '/trawl/door/port/pressure'


def metadata(path):
    return yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']


def test_rosbags_reads_as_many_messages_as_the_metadata_states(sound_bag, messages):
    with Reader(sound_bag) as reader:
        found = [(c.topic, c.msgtype, data, stamp) for c, stamp, data in reader.messages()]
    assert [(t, n, bytes(d), s) for t, n, d, s in found] == messages
    assert metadata(sound_bag)['message_count'] == len(messages)


def test_any_reader_decodes_them_by_the_definitions_in_the_bag(sound_bag):
    with AnyReader([sound_bag]) as reader:
        decoded = [reader.deserialize(data, c.msgtype) for c, _, data in reader.messages()]
    assert decoded[0].name == ['port_warp', 'starboard_warp']
    assert decoded[1].variance == 1e6


def test_mcap_reads_as_many_messages_as_the_metadata_states(sound_bag, messages):
    with (sound_bag / 'trial_0.mcap').open('rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == 'ros2'
        found = [(channel.topic, message.data) for _, channel, message in reader.iter_messages()]
        counts = reader.get_summary().statistics.channel_message_counts
    assert found == [(topic, data) for topic, _, data, _ in messages]
    assert sum(counts.values()) == metadata(sound_bag)['message_count']


def test_channels_say_what_rosbag2_wants_to_know(sound_bag):
    with (sound_bag / 'trial_0.mcap').open('rb') as stream:
        summary = make_reader(stream).get_summary()
    (channel,) = (c for c in summary.channels.values() if c.topic == PRESSURE)
    schema = summary.schemas[channel.schema_id]
    (qos,) = yaml.safe_load(channel.metadata['offered_qos_profiles'])
    assert channel.message_encoding == 'cdr'
    assert channel.metadata['topic_type_hash'] == type_hash('sensor_msgs/msg/FluidPressure')
    assert (qos['reliability'], qos['durability'], qos['depth']) == (1, 2, 100)
    assert (schema.name, schema.encoding) == ('sensor_msgs/msg/FluidPressure', 'ros2msg')
    assert b'MSG: builtin_interfaces/Time' in schema.data
    assert all(index.message_index_offsets for index in summary.chunk_indexes)


def test_every_chunk_has_a_checksum(sound_bag):
    with (sound_bag / 'trial_0.mcap').open('rb') as stream:
        records = list(StreamReader(stream, emit_chunks=True).records)
    chunks = [record for record in records if type(record).__name__ == 'Chunk']
    assert len(chunks) == 5
    assert all(chunk.uncompressed_crc and chunk.compression == 'zstd' for chunk in chunks)


def descriptions(path):
    """Give, chunk for chunk, the topics described in it."""
    with path.open('rb') as stream:
        records = list(StreamReader(stream, emit_chunks=True).records)
    chunks = [breakup_chunk(record) for record in records if isinstance(record, Chunk)]
    return [[r.topic for r in chunk if isinstance(r, Channel)] for chunk in chunks]


def test_what_describes_a_topic_stands_in_the_next_chunk_again(tmp_path, messages):
    with BagWriter(tmp_path / 'bag') as bag:
        for number, message in enumerate(messages):
            if number < 8 or message[0] == WINCH:
                bag.write(*message)
            bag.flush()
            if number == 8:
                bag.write('/late', *messages[1][1:])
    found = descriptions(tmp_path / 'bag/bag_0.mcap')
    assert found[:2] == [[WINCH], [WINCH, PRESSURE]]
    assert found[2] == [WINCH, PRESSURE]
    assert not any(found[3:8])
    both = next(place for place, topics in enumerate(found) if '/late' in topics)
    assert found[both + 1] == [WINCH, PRESSURE, '/late']


def test_each_full_chunk_describes_all_topics_at_a_small_part_of_its_size(tmp_path):
    random = np.random.default_rng(5)
    with BagWriter(tmp_path / 'bag') as bag:
        for stamp in range(40):
            bag.write('/noise', 'std_msgs/msg/String', random.bytes(100_000), stamp)
    found = descriptions(tmp_path / 'bag/bag_0.mcap')
    assert len(found) >= 4
    assert all(topics == ['/noise'] for topics in found)


def test_two_damages_cost_the_messages_of_their_own_chunk_only(bag_path, mcap_path, messages, raw):
    whole = bytearray(mcap_path.read_bytes())
    for place in (200, len(whole) - 60):
        whole[place] ^= 1
    mcap_path.write_bytes(whole)
    assert raw(bag_path)[0] == messages[120:]


def test_the_metadata_is_complete(sound_bag, messages):
    found = metadata(sound_bag)
    start, end = messages[0][3], messages[-1][3]
    span = {
        'starting_time': {'nanoseconds_since_epoch': start},
        'duration': {'nanoseconds': end - start},
        'message_count': len(messages),
    }
    topics = found.pop('topics_with_message_count')
    assert found == {
        'version': 8,
        'storage_identifier': 'mcap',
        **span,
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': ['trial_0.mcap'],
        'files': [{'path': 'trial_0.mcap', **span}],
        'custom_data': None,
        'ros_distro': 'jazzy',
    }
    assert [(t['topic_metadata']['name'], t['message_count']) for t in topics] == [
        (WINCH, 300),
        (PRESSURE, 300),
    ]
    assert isinstance(topics[0]['topic_metadata']['offered_qos_profiles'], str)
    assert topics[1]['topic_metadata']['type_description_hash'] == type_hash(
        'sensor_msgs/msg/FluidPressure'
    )


def test_the_same_messages_give_the_same_bytes(sound_bag, bag_path, mcap_path):
    assert mcap_path.read_bytes() == (sound_bag / 'trial_0.mcap').read_bytes()
    assert (bag_path / 'metadata.yaml').read_bytes() == (sound_bag / 'metadata.yaml').read_bytes()


def test_the_bytes_of_the_data_do_not_depend_on_the_bags_name(tmp_path, messages):
    for name in ('one', 'another'):
        with BagWriter(tmp_path / name) as bag:
            bag.write(*messages[0])
    first, second = (tmp_path / name / f'{name}_0.mcap' for name in ('one', 'another'))
    assert first.read_bytes() == second.read_bytes()


def test_a_latched_topic_offers_itself_to_late_subscribers(tmp_path):
    _, message = estimate_message([0.0] * 12)
    with BagWriter(tmp_path / 'bag') as bag:
        topic = '/trawl/identification/estimate'
        bag.write(topic, message.__msgtype__, serialize(message), 5)
    with Reader(tmp_path / 'bag') as reader:
        (qos,) = reader.connections[0].ext.offered_qos_profiles
    assert (qos.durability.name, qos.depth) == ('TRANSIENT_LOCAL', 1)


def test_custom_data_are_kept(tmp_path, messages):
    with BagWriter(tmp_path / 'bag', custom_data={'scenario': 'demo', 'seed': '7'}) as bag:
        bag.write(*messages[0])
    assert Bag(tmp_path / 'bag').custom_data == {'scenario': 'demo', 'seed': '7'}


def test_log_and_publish_time_are_kept_apart(tmp_path, messages):
    with BagWriter(tmp_path / 'bag') as bag:
        bag.write(*messages[0], publish_time=17)
    (raw,) = Bag(tmp_path / 'bag').raw()
    assert (raw.log_time, raw.publish_time) == (messages[0][3], 17)


@pytest.mark.parametrize('kind', ['folder', 'file'])
def test_nothing_is_written_over(tmp_path, kind):
    path = tmp_path / 'precious'
    if kind == 'folder':
        path.mkdir()
        (path / 'notes.txt').write_text('kept')
    else:
        path.write_text('kept')
    with pytest.raises(BagError, match='precious: exists already'):
        BagWriter(path)
    assert (path / 'notes.txt' if kind == 'folder' else path).read_text() == 'kept'


def test_a_path_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / 'file').write_text('')
    with pytest.raises(BagError, match='file/bag: cannot be made'):
        BagWriter(tmp_path / 'file' / 'bag')


def test_a_topic_keeps_its_type(tmp_path, messages):
    with BagWriter(tmp_path / 'bag') as bag:
        bag.write(*messages[0])
        with pytest.raises(BagError, match=f'{WINCH}.* sensor_msgs/msg/JointState'):
            bag.write(WINCH, 'sensor_msgs/msg/Range', b'', 0)


def test_an_unknown_type_is_refused(tmp_path):
    with (
        BagWriter(tmp_path / 'bag') as bag,
        pytest.raises(BagError, match='/x has type acme/msg/Y'),
    ):
        bag.write('/x', 'acme/msg/Y', b'', 0)


def test_a_time_before_the_epoch_is_refused(tmp_path, messages):
    with BagWriter(tmp_path / 'bag') as bag, pytest.raises(BagError, match='at -1 ns'):
        bag.write(*messages[0][:3], -1)


def test_an_error_while_recording_leaves_what_was_recorded(tmp_path, messages):

    def record():
        with BagWriter(tmp_path / 'bag') as bag:
            bag.write(*messages[0])
            bag.write(*messages[0][:3], log_time=-1)

    with pytest.raises(BagError):
        record()
    assert summarise(tmp_path / 'bag').count == 1
    assert summarise(tmp_path / 'bag').problems == ()


def test_an_empty_bag_is_one_that_rosbags_opens(tmp_path):
    BagWriter(tmp_path / 'bag').close()
    with Reader(tmp_path / 'bag') as reader:
        assert reader.message_count == 0


KILLED = """
import sys, time
from trawl_ros.bags.writer import BagWriter
bag = BagWriter(sys.argv[1])
for number in range(1000):
    bag.write('/trawl/door/spread', 'sensor_msgs/msg/Range', bytes(60), number)
    if number == 699:
        bag.flush()
print('ready', flush=True)
time.sleep(60)
"""


def test_a_killed_writer_leaves_all_up_to_its_last_flush(tmp_path):
    path = tmp_path / 'killed'
    with subprocess.Popen(
        [sys.executable, '-c', KILLED, str(path)],
        stdout=subprocess.PIPE,
        env={**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))},
    ) as process:
        assert process.stdout.readline() == b'ready\n'
        process.send_signal(signal.SIGKILL)
    found = summarise(path)
    assert found.count == 700
    assert found.count == metadata(path)['message_count']
    assert 'cut short' in ' '.join(found.problems)
