"""The content of a bag is judged, and not only its container: decoding, values, metadata."""

import shutil
from dataclasses import replace

import pytest
import yaml
import zstandard
from mcap.writer import Writer

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import repair_bag
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.core.limits import BAG_TOPICS
from trawl_ros.messages.cdr import message_definition, serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import PressureSample, RangeSample, WinchSample
from trawl_ros.records.topics import absolute

SECOND = 1_000_000_000
START = 1_785_000_000 * SECOND
PRESSURE = '/trawl/door/port/pressure'


def pressures(values):
    return [
        PressureSample(START + number * SECOND, 'port', value, 1e3)
        for number, value in enumerate(values)
    ]


SOUND = pressures([1e6 + 100.0 * n for n in range(40)])


def write(path, samples, change=lambda data: data):
    """Write samples as an MCAP file of somebody else, each message changed."""
    with path.open('wb') as stream:
        mcap = Writer(stream)
        mcap.start('ros2', 'test')
        channel = None
        for sample in samples:
            topic, message = sample_message(sample)
            name = message.__msgtype__
            if channel is None:
                schema = mcap.register_schema(name, 'ros2msg', message_definition(name).encode())
                channel = mcap.register_channel(absolute(topic), 'cdr', schema)
            mcap.add_message(channel, sample.stamp, change(serialize(message)), sample.stamp)
        mcap.finish()
    return path


def kinds(path):
    return {finding.kind for finding in check_bag(path).findings}


def test_sound_is_said_where_each_message_decodes(tmp_path):
    assert check_bag(write(tmp_path / 'a.mcap', SOUND)).sound


@pytest.mark.parametrize(
    'change',
    [
        lambda data: data[:-4],
        lambda data: data + b'\0' * 8,
        lambda data: b'\x28\xb5\x2f\xfd' + b'\xff' * 40,
        lambda data: b'{"fluid_pressure": 1e6}',
    ],
    ids=['short', 'long', 'magic of zstd', 'text'],
)
def test_messages_that_do_not_decode_are_found_counted_and_not_saved(tmp_path, change):
    numbers = iter(range(len(SOUND)))
    path = write(
        tmp_path / 'a.mcap', SOUND, lambda data: data if next(numbers) % 2 else change(data)
    )
    assert kinds(path) & {'decode', 'content'}
    repair = repair_bag(path, tmp_path / 'saved')
    assert repair.saved == {PRESSURE: 20}
    assert repair.lost == {PRESSURE: 20}
    assert check_bag(tmp_path / 'saved').count == 20
    assert 'decode' not in kinds(tmp_path / 'saved')


def test_messages_compressed_one_by_one_are_read_without_metadata_and_repaired(tmp_path):
    path = write(tmp_path / 'a.mcap', SOUND, zstandard.ZstdCompressor().compress)
    check = check_bag(path)
    assert check.sound
    assert check.facts.compression == 'zstd per message'
    repair = repair_bag(path, tmp_path / 'plain')
    assert repair.whole
    assert [m.data for m in Bag(tmp_path / 'plain').raw()] == [m.data for m in Bag(path).raw()]


@pytest.mark.parametrize(
    'sample',
    [
        PressureSample(0, 'port', 101_325.0 - 9999 * 1e4, 1e3),
        PressureSample(0, 'port', 0.0, 1e3),
        RangeSample(0, 'spread', -99.0, 0.1, 0.3, 400.0),
        WinchSample(0, (-9999.0, 300.0), (0.0, 0.0), (8e4, 8e4)),
        WinchSample(0, (300.0, 300.0), (0.0, 0.0), (-99 * 9806.65, 8e4)),
    ],
)
def test_values_that_stand_for_missing_are_no_readings(tmp_path, sample):
    samples = [replace(sample, stamp=START + number * SECOND) for number in range(3)]
    found = [
        f for f in check_bag(write(tmp_path / 'a.mcap', samples)).findings if f.kind == 'value'
    ]
    assert [f.text.partition(' ')[0] for f in found] == ['3']


def edit(path, change):
    file = path / 'metadata.yaml'
    data = yaml.safe_load(file.read_text())
    change(data['rosbag2_bagfile_information'])
    file.write_text(yaml.safe_dump(data))


@pytest.mark.parametrize(
    'change',
    [
        lambda told: told.update(storage_identifier=''),
        lambda told: told.update(storage_identifier='sqlite3'),
        lambda told: told.update(message_count=10**30),
        lambda told: told.update(message_count=-5),
        lambda told: told.update(message_count=599),
        lambda told: told['starting_time'].update(nanoseconds_since_epoch=0),
        lambda told: told['duration'].update(nanoseconds=5),
        lambda told: told.pop('ros_distro'),
        lambda told: told['topics_with_message_count'][0].update(message_count=-1),
    ],
)
def test_check_and_repair_judge_metadata_alike(bag_path, tmp_path, change):
    assert check_bag(bag_path).sound
    edit(bag_path, change)
    assert not check_bag(bag_path).sound
    repair = repair_bag(bag_path, tmp_path / 'repaired')
    assert repair.whole == (not repair.lost)
    assert check_bag(tmp_path / 'repaired').sound


def test_a_bag_of_too_many_topics_is_refused_by_all_alike(tmp_path):
    path = tmp_path / 'a.mcap'
    with path.open('wb') as stream:
        mcap = Writer(stream)
        mcap.start('ros2', 'test')
        name = 'std_msgs/msg/Bool'
        schema = mcap.register_schema(name, 'ros2msg', message_definition(name).encode())
        for number in range(BAG_TOPICS.value + 1):
            channel = mcap.register_channel(f'/t{number}', 'cdr', schema)
            mcap.add_message(channel, START, b'\0\1\0\0\1', START)
        mcap.finish()
    for act in (check_bag, repair_bag, Bag):
        with pytest.raises(BagError, match='5001 topics; expected 5000'):
            act(path)
    assert not (tmp_path / 'a_repaired').exists()


def test_a_bag_with_a_sound_container_stays_sound(sound_bag, tmp_path):
    shutil.copytree(sound_bag, tmp_path / 'bag')
    with BagWriter(tmp_path / 'more') as bag:
        for message in Bag(tmp_path / 'bag').raw():
            bag.write(message.topic, message.type, message.data, message.log_time)
    assert check_bag(tmp_path / 'more').sound
