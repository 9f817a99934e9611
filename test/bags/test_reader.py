"""`Bag` gives sound bags whole, whoever wrote them, and refuses what is none of its kind."""

import shutil
import struct
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import CompressionType, Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter

from trawl_ros.bags.reader import Bag, summarise
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.messages.cdr import STORE, message_definition, serialize
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import PressureSample

WINCH, PRESSURE = '/trawl/winch/joint_states', '/trawl/door/port/pressure'


def write_mcap(path, *channels, compression=CompressionType.ZSTD, chunked=True):
    """Write an MCAP file of (topic, type, encoding, definition, [(stamp, data), ...])."""
    with path.open('wb') as stream:
        writer = Writer(stream, compression=compression, use_chunking=chunked)
        writer.start('ros2', 'test')
        for topic, type_name, encoding, text, entries in channels:
            schema = writer.register_schema(type_name, encoding, text.encode())
            channel = writer.register_channel(topic, 'cdr', schema)
            for stamp, data in entries:
                writer.add_message(channel, stamp, data, stamp)
        writer.finish()
    return path


def pressure_bytes(stamp=0, pressure=1e6):
    return serialize(sample_message(PressureSample(stamp, 'port', pressure, 1e3))[1])


def pressure_channel(entries, topic=PRESSURE):
    name = 'sensor_msgs/msg/FluidPressure'
    return topic, name, 'ros2msg', message_definition(name), entries


@pytest.mark.parametrize('file', ['', 'trial_0.mcap'])
def test_a_sound_bag_comes_back_message_for_message(sound_bag, messages, raw, file):
    assert raw(sound_bag / file) == (messages, [])


def test_messages_are_decoded(sound_bag, read):
    received, problems = read(sound_bag)
    sample = to_sample('door/port/pressure', received[1].message)
    assert (received[1].topic, received[1].type) == (PRESSURE, 'sensor_msgs/msg/FluidPressure')
    assert sample.stamp == received[1].log_time
    assert sample.std == pytest.approx(1e3)
    assert problems == []


def test_topics_can_be_picked(sound_bag, read):
    received, _ = read(sound_bag, [PRESSURE])
    assert {message.topic for message in received} == {PRESSURE}
    assert len(received) == 300


def test_a_summary_counts(sound_bag, messages):
    found = summarise(sound_bag)
    assert [(t.topic, t.type, t.count) for t in found.topics] == [
        (PRESSURE, 'sensor_msgs/msg/FluidPressure', 300),
        (WINCH, 'sensor_msgs/msg/JointState', 300),
    ]
    assert (found.count, found.start, found.end) == (600, messages[0][3], messages[-1][3])
    assert found.problems == ()


@pytest.mark.parametrize('chunked', [True, False])
@pytest.mark.parametrize('compression', list(CompressionType))
def test_files_of_other_writers_are_read(tmp_path, compression, chunked, raw):
    entries = [(stamp, pressure_bytes(stamp)) for stamp in range(50)]
    path = write_mcap(
        tmp_path / 'x.mcap', pressure_channel(entries), compression=compression, chunked=chunked
    )
    found, problems = raw(path)
    assert [(stamp, data) for _, _, data, stamp in found] == entries
    assert problems == []


def test_messages_come_in_the_order_of_their_log_times_also_across_chunks(tmp_path):
    random = np.random.default_rng(2)
    stamps = [int(stamp) for stamp in random.integers(0, 1000, 400)]
    with BagWriter(tmp_path / 'bag') as bag:
        for number, stamp in enumerate(stamps):
            bag.write(PRESSURE, 'sensor_msgs/msg/FluidPressure', pressure_bytes(), stamp, number)
            if number % 37 == 0:
                bag.flush()
    found = [(m.log_time, m.publish_time) for m in Bag(tmp_path / 'bag').raw()]
    assert found == sorted((stamp, number) for number, stamp in enumerate(stamps))


@pytest.mark.parametrize('storage', list(StoragePlugin))
@pytest.mark.parametrize('version', [8, 9])
def test_bags_that_rosbags_wrote_are_read(tmp_path, storage, version, read):
    path = tmp_path / 'other'
    with RosbagsWriter(path, version=version, storage_plugin=storage) as writer:
        name = 'sensor_msgs/msg/FluidPressure'
        connection = writer.add_connection(PRESSURE, name, typestore=STORE)
        for stamp in range(20):
            writer.write(connection, stamp, pressure_bytes(stamp))
    received, problems = read(path)
    assert [message.log_time for message in received] == list(range(20))
    assert to_sample('door/port/pressure', received[5].message).stamp == 5
    assert problems == []


def test_a_range_of_an_older_distribution_is_read_by_the_definition_it_brings(tmp_path, read):
    newer = message_definition('sensor_msgs/msg/Range')
    older = newer.replace('float32 variance\n', '')
    assert older != newer
    stamped = b'\x00\x01\x00\x00' + struct.pack('<iI', 7, 0) + struct.pack('<I', 1) + b'\0\0\0\0'
    data = stamped + struct.pack('<4f', 0.3, 1.0, 400.0, 118.5)
    path = write_mcap(
        tmp_path / 'x.mcap',
        ('/trawl/door/spread', 'sensor_msgs/msg/Range', 'ros2msg', older, [(0, data)]),
    )
    (received,), _ = read(path)
    sample = to_sample('door/spread', received.message)
    assert (sample.distance, sample.max_range, sample.std) == (118.5, 400.0, 0.0)


# Content that is not what it should be.


def test_another_type_on_a_known_topic_is_refused(tmp_path, read):
    path = write_mcap(
        tmp_path / 'x.mcap', pressure_channel([(0, pressure_bytes())], topic='/trawl/door/spread')
    )
    words = (
        '/trawl/door/spread has type sensor_msgs/msg/FluidPressure; expected sensor_msgs/msg/Range'
    )
    with pytest.raises(BagError, match=words):
        read(path)


def test_topics_of_others_may_have_any_type(tmp_path, read):
    path = write_mcap(
        tmp_path / 'x.mcap', pressure_channel([(0, pressure_bytes())], topic='/lab/door/spread')
    )
    assert len(read(path)[0]) == 1


def test_a_strangers_definition_that_makes_no_sense_costs_only_his_messages(tmp_path, read):
    path = write_mcap(
        tmp_path / 'x.mcap',
        ('/lab/thing', 'lab_msgs/msg/Thing', 'ros2msg', 'what is this', [(1, bytes(8))]),
        pressure_channel([(0, pressure_bytes())]),
    )
    received, problems = read(path)
    assert [message.topic for message in received] == [PRESSURE]
    assert '/lab/thing: the definition of lab_msgs/msg/Thing' in problems[0]


def test_a_known_topic_whose_definition_makes_no_sense_is_refused(tmp_path, read):
    name = 'sensor_msgs/msg/FluidPressure'
    path = write_mcap(
        tmp_path / 'x.mcap', (PRESSURE, name, 'ros2msg', 'float64 ???', [(0, pressure_bytes())])
    )
    with pytest.raises(BagError, match=f'{PRESSURE}: the definition of {name}'):
        read(path)


def test_messages_that_are_not_of_their_type_are_left_out_and_counted(tmp_path, read):
    entries = [(0, pressure_bytes()), (1, b'\x00\x01\x00\x00 short'), (2, pressure_bytes())]
    received, problems = read(write_mcap(tmp_path / 'x.mcap', pressure_channel(entries)))
    assert [message.log_time for message in received] == [0, 2]
    assert f'1 messages on {PRESSURE} are not a sensor_msgs/msg/FluidPressure' in problems[0]


def test_single_messages_can_be_decoded_and_say_when_they_are_none(tmp_path):
    entries = [(0, pressure_bytes(pressure=2e5)), (1, b'\x00\x01\x00\x00 short')]
    bag = Bag(write_mcap(tmp_path / 'x.mcap', pressure_channel(entries)))
    good, bad = bag.raw()
    assert bag.decode(good).fluid_pressure == 2e5
    with pytest.raises(MessageError, match=f'{PRESSURE}: 10 bytes .*sensor_msgs/msg/FluidPressure'):
        bag.decode(bad)


def test_stamps_out_of_order_are_passed_on(tmp_path, read):
    entries = [(0, pressure_bytes(stamp=9)), (1, pressure_bytes(stamp=3))]
    received, _ = read(write_mcap(tmp_path / 'x.mcap', pressure_channel(entries)))
    assert [message.message.header.stamp.nanosec for message in received] == [9, 3]


def test_a_bag_in_several_files_is_read_as_one(tmp_path, read):
    folder = tmp_path / 'split'
    folder.mkdir()
    parts = [[0, 2, 4], [1, 3, 5]]
    for number, stamps in enumerate(parts):
        entries = [(stamp, pressure_bytes(stamp)) for stamp in stamps]
        write_mcap(folder / f'split_{number}.mcap', pressure_channel(entries))
    received, _ = read(folder)
    assert [message.log_time for message in received] == [0, 1, 2, 3, 4, 5]


def test_a_path_in_metadata_cannot_lead_out_of_the_bag(bag_path, mcap_path):
    elsewhere = bag_path.parent / 'elsewhere.mcap'
    shutil.move(mcap_path, elsewhere)
    path = bag_path / 'metadata.yaml'
    path.write_text(path.read_text().replace('- trial_0.mcap', '- ../elsewhere.mcap'))
    assert Path(elsewhere).exists()
    with pytest.raises(BagError, match=r'names elsewhere\.mcap'):
        Bag(bag_path)


def test_a_record_that_claims_an_absurd_length_takes_no_memory(tmp_path, read):
    path = tmp_path / 'x.mcap'
    whole = write_mcap(path, pressure_channel([(0, pressure_bytes())])).read_bytes()
    (header,) = struct.unpack_from('<Q', whole, 9)
    path.write_bytes(whole[: 8 + 9 + header] + b'\x06' + struct.pack('<Q', 1 << 60) + bytes(100))
    with pytest.raises(BagError, match=r'x\.mcap.*damaged at byte \d'):
        read(path)
