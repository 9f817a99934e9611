"""Bags that are no files, small ones that hold without end, and places and times beyond all."""

import os
import struct
import zlib
from pathlib import Path

import pytest
import yaml
import zstandard
from mcap.writer import CompressionType, Writer

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.reader import Bag, summarise
from trawl_ros.bags.repair import repair_bag
from trawl_ros.core.errors import BagError

MAGIC = b'\x89MCAP0\r\n'
CHANNEL = struct.pack('<HH', 1, 0) + b'\2\0\0\0/a\3\0\0\0cdr\0\0\0\0'


def record(opcode, content):
    return struct.pack('<BQ', opcode, len(content)) + content


def message(time, data=b''):
    return record(5, struct.pack('<HIQQ', 1, 0, time, time) + data)


def chunk(plain, times=(0, 0)):
    packed = zstandard.ZstdCompressor().compress(plain)
    head = struct.pack('<QQQII', *times, len(plain), zlib.crc32(plain), 4) + b'zstd'
    return record(6, head + struct.pack('<Q', len(packed)) + packed)


def write(path, *records):
    path.write_bytes(MAGIC + record(1, bytes(8)) + b''.join(records))
    return path


@pytest.fixture(params=[summarise, check_bag, repair_bag], ids=lambda read: read.__name__)
def read(request):
    return request.param


def test_a_pipe_is_no_bag(tmp_path, read):
    os.mkfifo(tmp_path / 'a.mcap')
    for path in (tmp_path / 'a.mcap', tmp_path):
        with pytest.raises(BagError, match=r'a\.mcap: found .*pipe or device'):
            read(path)


def test_a_device_is_no_bag(read):
    with pytest.raises(BagError, match='pipe or device'):
        read(Path('/dev/zero'))


def test_a_pipe_for_metadata_or_a_database_does_not_wait(tmp_path):
    os.mkfifo(tmp_path / 'metadata.yaml')
    os.mkfifo(tmp_path / 'a.db3')
    with pytest.raises(BagError):
        Bag(tmp_path)


def test_millions_of_messages_in_a_small_file_are_not_taken_apart(tmp_path, read):
    plain = record(4, CHANNEL) + message(0) * 2_000_000
    path = write(tmp_path / 'a.mcap', chunk(plain))
    assert path.stat().st_size < 30_000
    with pytest.raises(BagError, match='500000 messages'):
        read(path)


def test_small_chunks_that_unpack_to_much_are_refused(tmp_path, read):
    bomb = chunk(record(4, CHANNEL) + message(0, bytes(150 << 20)))
    path = write(tmp_path / 'a.mcap', *[bomb] * 6)
    with pytest.raises(BagError, match='unpack'):
        read(path)


def indexed(path, *, time=5, offset=None):
    """Write a sound file of one chunk, or one whose index says that it lies elsewhere."""
    with path.open('wb') as stream:
        mcap = Writer(stream, compression=CompressionType.NONE)
        mcap.start('ros2', 'test')
        schema = mcap.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        channel = mcap.register_channel('/a', 'cdr', schema)
        mcap.add_message(channel, time, b'\0\1\0\0\0', time)
        mcap.finish()
    data = bytearray(path.read_bytes())
    start = struct.unpack('<Q', data[-28:-20])[0]
    place = data.index(b'\x08', start)
    while offset is not None and struct.unpack('<Q', data[place + 25 : place + 33])[0] > start:
        place = data.index(b'\x08', place + 1)
    if offset is not None:
        data[place + 25 : place + 33] = struct.pack('<Q', offset)
        data[-12:-8] = bytes(4)
    path.write_bytes(data)
    return path


@pytest.mark.parametrize('offset', [2**62, 2**63, 2**64 - 1])
def test_a_chunk_beyond_all_files_is_looked_for_in_this_one(tmp_path, offset):
    summary = summarise(indexed(tmp_path / 'a.mcap', offset=offset))
    assert summary.count == 1
    assert 'index' in summary.problems[0]


@pytest.mark.parametrize('time', [2**63, 2**64 - 1])
def test_times_beyond_all_clocks_are_left_out_and_said(tmp_path, time):
    path = indexed(tmp_path / 'a.mcap', time=time)
    assert any('no possible time' in finding.text for finding in check_bag(path).findings)
    assert any('no possible time' in problem for problem in summarise(path).problems)
    with pytest.raises(BagError, match='no possible time'):
        repair_bag(path)


def test_the_latest_time_is_read(tmp_path):
    assert summarise(indexed(tmp_path / 'a.mcap', time=2**63 - 1)).end == 2**63 - 1


@pytest.mark.parametrize('name', ['/' + 'a' * 5000, '/a\x1b[2J'])
def test_a_topic_whose_name_is_none_is_refused(tmp_path, name):
    with (tmp_path / 'a.mcap').open('wb') as stream:
        mcap = Writer(stream)
        mcap.start('ros2', 'test')
        mcap.add_message(mcap.register_channel(name, 'cdr', 0), 1, b'', 1)
        mcap.finish()
    with pytest.raises(BagError, match=r'a\.mcap: a topic') as refused:
        summarise(tmp_path / 'a.mcap')
    assert str(refused.value).isprintable()


INFORMATION = {
    'version': 8,
    'storage_identifier': 'mcap',
    'relative_file_paths': ['a.mcap'],
    'message_count': 1,
}


@pytest.mark.parametrize(
    'text',
    [
        '[' * 100_000,
        '{a: ' * 100_000,
        '- ' * 100_000,
        'rosbag2_bagfile_information: !!bool abc',
        'rosbag2_bagfile_information: !!int abc',
        'rosbag2_bagfile_information: !!timestamp abc',
        '? [a]\n: b',
        'a: &a [*a]',
        'a: &a [0,0,0,0,0,0,0,0,0]\n'
        + ''.join(
            f'{next_}: &{next_} [{", ".join([f"*{name}"] * 9)}]\n'
            for name, next_ in zip('abcdefg', 'bcdefgh', strict=True)
        ),
        'rosbag2_bagfile_information: {version: ' + '9' * 5000 + '}',
        yaml.safe_dump({'rosbag2_bagfile_information': INFORMATION | {'version': 'x' * 5000}}),
        yaml.safe_dump(
            {'rosbag2_bagfile_information': INFORMATION | {'storage_identifier': 'x' * 5000}}
        ),
        *(
            yaml.safe_dump(
                {'rosbag2_bagfile_information': INFORMATION | {'relative_file_paths': [name]}}
            )
            for name in ('x' * 5000, 'a\0b', '..', '', '/dev/zero')
        ),
    ],
)
def test_metadata_that_are_hostile_are_refused_in_lines_that_can_be_read(tmp_path, text, read):
    (tmp_path / 'metadata.yaml').write_text(text)
    with pytest.raises(BagError) as refused:
        read(tmp_path)
    assert all(len(line) < 1200 for line in str(refused.value).split('\n'))


def test_metadata_that_name_a_file_again_and_again_do_not_open_it_so_often(tmp_path):
    indexed(tmp_path / 'a.mcap')
    information = INFORMATION | {'relative_file_paths': ['a.mcap'] * 3000}
    (tmp_path / 'metadata.yaml').write_text(
        yaml.safe_dump({'rosbag2_bagfile_information': information})
    )
    with pytest.raises(BagError, match='names 3000 files'):
        Bag(tmp_path)
