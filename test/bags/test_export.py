"""`export_bag` writes what is in a bag as tables, exactly, and says what it leaves out."""

import csv
import math

import numpy as np
import pytest
from mcap.writer import Writer
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.bags.export import DICTIONARY, export_bag
from trawl_ros.bags.flattening import MAX_COLUMNS
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.core.progress import WorkProgress
from trawl_ros.messages.cdr import message_definition, serialize
from trawl_ros.messages.stamps import header
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import RangeSample, WinchSample
from trawl_ros.records.topics import absolute

STAMP = 1_785_000_000_123_456_789


def rows(path):
    with path.open(encoding='utf-8', newline='') as stream:
        return list(csv.DictReader(stream))


def write(path, *messages):
    """Write (topic, message) each a second after the one before."""
    with BagWriter(path) as bag:
        for number, (topic, message) in enumerate(messages):
            log_time = STAMP + number * 10**9
            bag.write(absolute(topic), message.__msgtype__, serialize(message), log_time)
    return path


def exported(tmp_path, *messages, **options):
    done = export_bag(write(tmp_path / 'bag', *messages), tmp_path / 'out', **options)
    return {topic.topic.removeprefix('/trawl/'): topic for topic in done.topics}, done


def polygon(count):
    points = [ros.geometry_msgs__msg__Point32(float(n), 0.1, -2.5) for n in range(count)]
    return ros.geometry_msgs__msg__PolygonStamped(
        header(STAMP, 'map'), ros.geometry_msgs__msg__Polygon(points)
    )


def test_every_message_of_a_bag_is_a_row(sound_bag, tmp_path):
    done = export_bag(sound_bag, tmp_path / 'out')
    assert [(topic.file.name, topic.rows) for topic in done.topics] == [
        ('trawl.door.port.pressure.csv', 300),
        ('trawl.winch.joint_states.csv', 300),
    ]
    assert [len(rows(topic.file)) for topic in done.topics] == [300, 300]
    assert done.problems == ()


def test_columns_are_named_by_path_and_numbers_come_back_exactly(tmp_path):
    lengths, tensions = (500.1, 499.9 + 1e-13), (81_234.5, math.nan)
    sample = WinchSample(STAMP, lengths, (0.1, -0.2), tensions)
    topics, _ = exported(tmp_path, sample_message(sample))
    (row,) = rows(topics['winch/joint_states'].file)
    assert list(row) == [
        'log_time_s',
        'log_time_ns',
        'header.stamp_s',
        'header.stamp_ns',
        'header.frame_id',
        *(f'{name}[{n}]' for name in ('name', 'position', 'velocity', 'effort') for n in (0, 1)),
    ]
    assert (float(row['position[0]']), float(row['position[1]'])) == lengths
    assert row['name[1]'] == 'starboard_warp'
    assert row['effort[1]'] == '', 'what is missing is an empty cell'


def test_times_keep_their_nanoseconds(tmp_path):
    topics, _ = exported(tmp_path, sample_message(RangeSample(STAMP, 'spread', 1.0, 0, 0.1, 9)))
    (row,) = rows(topics['door/spread'].file)
    assert (row['header.stamp_ns'], row['log_time_ns']) == (str(STAMP), str(STAMP))
    assert row['header.stamp_s'] == row['log_time_s'] == '1785000000.123456789'


def test_numbers_of_32_bits_have_no_more_digits_than_they_hold(tmp_path):
    topics, _ = exported(
        tmp_path, sample_message(RangeSample(STAMP, 'spread', 80.1, 0.1, 0.1, math.inf))
    )
    (row,) = rows(topics['door/spread'].file)
    assert (row['range'], row['max_range'], row['radiation_type']) == ('80.1', 'inf', '0')
    assert 'ULTRASOUND' not in row, 'constants are no readings'


def test_units_stand_in_a_file_of_their_own(sound_bag, tmp_path):
    export_bag(sound_bag, tmp_path / 'out')
    told = {(row['file'], row['column']): row for row in rows(tmp_path / 'out' / DICTIONARY)}
    pressure, winch = 'trawl.door.port.pressure.csv', 'trawl.winch.joint_states.csv'
    assert told[pressure, 'fluid_pressure']['unit'] == 'Pa'
    assert told[pressure, 'variance']['unit'] == 'Pa^2'
    assert told[pressure, 'header.stamp_ns']['unit'] == 'ns'
    assert told[winch, 'position[1]']['unit'] == 'm'
    assert told[winch, 'effort[0]']['unit'] == 'N'
    assert told[winch, 'name[0]']['unit'] == ''
    assert told[winch, 'effort[0]']['topic'] == '/trawl/winch/joint_states'
    for name in (pressure, winch):
        (first, *_) = rows(tmp_path / 'out' / name)
        assert list(first) == [column for file, column in told if file == name]


def test_arrays_of_changing_length_leave_cells_empty(tmp_path):
    topics, _ = exported(tmp_path, ('truth/net/mouth', polygon(2)), ('truth/net/mouth', polygon(3)))
    short, long = rows(topics['truth/net/mouth'].file)
    assert list(short)[5:8] == [f'polygon.points[0].{axis}' for axis in 'xyz']
    assert short['polygon.points[2].x'] == ''
    assert (long['polygon.points[2].x'], long['polygon.points[2].z']) == ('2.0', '-2.5')
    assert long['polygon.points[2].y'] == '0.1'


def test_arrays_beyond_the_limit_are_left_out_as_a_whole_and_said(tmp_path):
    messages = [('truth/net/mouth', polygon(count)) for count in (3, 5, 2)]
    topics, _ = exported(tmp_path, *messages, array_limit=4)
    done = topics['truth/net/mouth']
    assert done.left_out == {'polygon.points': 'has 5 elements, more than 4'}
    assert list(rows(done.file)[0]) == [
        'log_time_s',
        'log_time_ns',
        'header.stamp_s',
        'header.stamp_ns',
        'header.frame_id',
    ]
    assert done.rows == 3


def test_a_field_that_would_need_too_many_columns_is_left_out(tmp_path):
    topics, _ = exported(tmp_path, ('truth/net/mouth', polygon(400)), array_limit=1000)
    assert topics['truth/net/mouth'].left_out == {'polygon': 'would need 1200 columns'}
    assert MAX_COLUMNS < 1200


def test_images_are_left_out_and_said(tmp_path):
    image = ros.sensor_msgs__msg__Image(
        header(STAMP, 'sonar'), 2, 3, 'mono8', 0, 3, np.arange(6, dtype=np.uint8)
    )
    topics, _ = exported(tmp_path, ('sonar/image', image))
    done = topics['sonar/image']
    assert done.left_out == {'data': 'is an image or another blob of bytes'}
    assert rows(done.file)[0]['width'] == '3'


def test_an_empty_blob_is_nothing_to_leave_out(tmp_path):
    image = ros.sensor_msgs__msg__Image(
        header(STAMP, 'sonar'), 0, 0, 'mono8', 0, 0, np.zeros(0, dtype=np.uint8)
    )
    topics, _ = exported(tmp_path, ('sonar/image', image))
    assert topics['sonar/image'].left_out == {}


def test_a_topic_of_which_nothing_is_left_gets_no_file(tmp_path):
    outline, other = (
        ('/lab/outline', polygon(9).polygon),
        ('/lab/count', ros.std_msgs__msg__Int8(3)),
    )
    topics, _ = exported(tmp_path, outline, other, array_limit=8)
    assert topics['/lab/outline'].file is None
    assert topics['/lab/outline'].left_out == {'points': 'has 9 elements, more than 8'}
    files = sorted(file.name for file in (tmp_path / 'out').iterdir())
    assert files == [DICTIONARY, 'lab.count.csv']


def test_an_export_that_would_write_nothing_is_an_error_that_says_why(tmp_path):
    with pytest.raises(BagError, match='points of /lab/outline has 9 elements, more than 8'):
        exported(tmp_path, ('/lab/outline', polygon(9).polygon), array_limit=8)
    assert not (tmp_path / 'out').exists()


def test_a_topic_whose_definition_is_not_understood_is_said(tmp_path, messages):
    path = tmp_path / 'lab.mcap'
    with path.open('wb') as stream:
        writer = Writer(stream)
        writer.start('ros2', 'test')
        schema = writer.register_schema('lab_msgs/msg/Thing', 'ros2msg', b'no such field')
        writer.add_message(writer.register_channel('/lab/thing', 'cdr', schema), 1, b'1234', 1)
        writer.finish()
    with pytest.raises(BagError, match=r'no table rows .*Thing in the bag cannot be understood'):
        export_bag(path, tmp_path / 'out')


def test_topics_can_be_picked_by_either_name(sound_bag, tmp_path):
    for number, name in enumerate(('winch/joint_states', '/trawl/winch/joint_states')):
        done = export_bag(sound_bag, tmp_path / str(number), topics=[name])
        assert [topic.topic for topic in done.topics] == ['/trawl/winch/joint_states']
    with pytest.raises(BagError, match='no topic /trawl/winch; expected some of /trawl/door'):
        export_bag(sound_bag, tmp_path / 'x', topics=['winch'])
    assert not (tmp_path / 'x').exists()


def test_nothing_is_written_over(sound_bag, tmp_path):
    (tmp_path / 'out').mkdir()
    with pytest.raises(BagError, match='exists already and is not written over'):
        export_bag(sound_bag, tmp_path / 'out')


def test_names_of_topics_cannot_lead_out_of_the_folder_nor_meet(tmp_path):
    name = 'sensor_msgs/msg/Range'
    data = serialize(sample_message(RangeSample(STAMP, 'spread', 1.0, 0.0, 0.1, 9.0))[1])
    path = tmp_path / 'x.mcap'
    with path.open('wb') as stream:
        writer = Writer(stream)
        writer.start('ros2', 'test')
        schema = writer.register_schema(name, 'ros2msg', message_definition(name).encode())
        for topic in ('/../../etc/x', '/etc/x', '/etc.x', '/columns'):
            writer.add_message(writer.register_channel(topic, 'cdr', schema), 0, data, 0)
        writer.finish()
    done = export_bag(path, tmp_path / 'out')
    names = {topic.file.name for topic in done.topics}
    assert len(names) == 4
    assert all(topic.file.parent == tmp_path / 'out' for topic in done.topics)
    assert DICTIONARY not in names


def test_a_damaged_bag_is_exported_as_far_as_it_can_be_read(bag_path, mcap_path, tmp_path):
    whole = mcap_path.read_bytes()
    mcap_path.write_bytes(whole[: len(whole) // 2])
    done = export_bag(bag_path, tmp_path / 'out')
    assert 0 < sum(topic.rows for topic in done.topics) < 600
    assert 'cut short' in done.problems[0]


def test_progress_is_told_in_recorded_time(sound_bag, tmp_path):
    told = []
    export_bag(sound_bag, tmp_path / 'out', on_progress=told.append)
    assert told[0] == WorkProgress('exporting', 0.0, None, 's')
    assert told[-1].done == 299.0
