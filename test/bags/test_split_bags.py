"""Bags in several files, split by size or time, and compressed as wished."""

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.core.time import SECOND


def metadata(path):
    return yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']


def files_of(path):
    return [(f['path'], f['message_count']) for f in metadata(path)['files']]


def by_rosbags(path):
    with Reader(path) as reader:
        found = [(c.topic, c.msgtype, bytes(data), time) for c, time, data in reader.messages()]
        assert len(found) == reader.message_count
    return found


def test_files_are_split_by_time_as_rosbag2_does_it(tmp_path, messages):
    path = tmp_path / 'long'
    with BagWriter(path, max_file_ns=60 * SECOND) as bag:
        for message in messages:
            bag.write(*message)
    # A file ends with what is 60 s after its first message, two topics each second.
    counts = [122, 122, 122, 122, 112]
    assert files_of(path) == [(f'long_{n}.mcap', count) for n, count in enumerate(counts)]
    found = metadata(path)
    assert found['relative_file_paths'] == [f'long_{n}.mcap' for n in range(5)]
    assert found['duration'] == {'nanoseconds': 299 * SECOND}
    assert found['files'][1]['duration'] == {'nanoseconds': 60 * SECOND}
    begin = messages[122][3]
    assert found['files'][1]['starting_time'] == {'nanoseconds_since_epoch': begin}
    assert by_rosbags(path) == messages
    assert [(m.topic, m.type, m.data, m.log_time) for m in Bag(path).raw()] == messages


def test_files_are_split_by_size(tmp_path):
    path, limit = tmp_path / 'large', 2 << 20
    random = np.random.default_rng(5)
    with BagWriter(path, max_file_bytes=limit) as bag:
        for stamp in range(70):
            bag.write('/x', 'sensor_msgs/msg/Image', random.bytes(100_000), stamp)
    sizes = [file.stat().st_size for file in sorted(path.glob('*.mcap'))]
    assert len(sizes) == 4
    # A file goes on to the end of the chunk that reaches the limit.
    assert all(limit <= size < limit + 1.2 * (1 << 20) for size in sizes[:-1])
    assert sum(count for _, count in files_of(path)) == 70
    assert [stamp for *_, stamp in by_rosbags(path)] == list(range(70))


def test_each_file_of_several_can_be_opened_alone(tmp_path, messages):
    path = tmp_path / 'long'
    with BagWriter(path, max_file_ns=100 * SECOND) as bag:
        for message in messages:
            bag.write(*message)
    parts = [by_rosbags(path / f'long_{number}.mcap') for number in range(3)]
    assert [message for part in parts for message in part] == messages


@pytest.mark.parametrize('compression', ['zstd', 'lz4', 'none'])
def test_chunks_are_compressed_as_wished(tmp_path, messages, compression):
    with BagWriter(tmp_path / 'bag', compression=compression) as bag:
        for message in messages:
            bag.write(*message)
    with (tmp_path / 'bag' / 'bag_0.mcap').open('rb') as stream:
        (index,) = make_reader(stream).get_summary().chunk_indexes
    assert index.compression == compression.replace('none', '')
    assert metadata(tmp_path / 'bag')['compression_format'] == ''
    assert by_rosbags(tmp_path / 'bag') == messages


def test_an_unknown_compression_is_refused_before_anything_is_made(tmp_path):
    with pytest.raises(BagError, match=r"'brotli'; .*zstd, lz4, none"):
        BagWriter(tmp_path / 'bag', compression='brotli')
    assert not (tmp_path / 'bag').exists()
