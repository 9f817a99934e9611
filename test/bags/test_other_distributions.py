"""Bags of Foxy to Rolling, in either storage, with or without definitions, compressed or not."""

import sqlite3
from contextlib import closing

import pytest
import yaml
import zstandard
from click.testing import CliRunner
from mcap.writer import Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.reader import Bag, summarise
from trawl_ros.bags.samples import SampleStream
from trawl_ros.bags.storage.qos import dump_profiles, project_profile
from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import BagError
from trawl_ros.messages.cdr import STORE
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import PressureSample, RangeSample, WinchSample
from trawl_ros.records.topics import NAMESPACE, absolute

SECOND = 1_000_000_000
SAMPLES = [
    sample
    for second in range(5)
    for sample in (
        WinchSample(second * SECOND, (500.0 + second, 501.0), (0.1, 0.2), (8e4, 8.1e4)),
        PressureSample(second * SECOND, 'port', 1.4e6 + second, 1e3),
        RangeSample(second * SECOND, 'spread', 118.5 + second, 0.5, 1.0, 400.0),
    )
]
QOS = dump_profiles([project_profile(latched=False)])

TOPICS_TABLE = {
    # By version of the schema: Foxy to Humble, Iron and later.
    2: 'topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, '
    'serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)',
    4: 'topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, '
    'serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL, '
    'type_description_hash TEXT NOT NULL)',
}


def encoded(distribution):
    """Give (topic, type, stamp, bytes) as a distribution would have written them."""
    store = get_typestore(distribution)
    for sample in SAMPLES:
        topic, message = sample_message(sample)
        name = message.__msgtype__
        cls = store.types[name]
        given = {
            field: getattr(message, field)
            for field, _ in store.fielddefs[name][1]
        }  # fmt: skip
        yield absolute(topic), name, sample.stamp, bytes(store.serialize_cdr(cls(**given), name))


def names(entries):
    return list(dict.fromkeys((topic, name) for topic, name, _, _ in entries))


def write_database(path, entries, *, definitions=None, distro=''):
    with closing(sqlite3.connect(path)) as database:
        schema = 4 if definitions else 2
        database.execute(f'CREATE TABLE {TOPICS_TABLE[schema]}')
        database.execute(
            'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, '
            'timestamp INTEGER NOT NULL, data BLOB NOT NULL)'
        )
        database.execute('CREATE INDEX timestamp_idx ON messages (timestamp ASC)')
        if definitions:
            database.execute(
                'CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT)'
            )
            database.execute('INSERT INTO schema VALUES (4, ?)', (distro,))
            database.execute(
                'CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, '
                'topic_type TEXT NOT NULL, encoding TEXT NOT NULL, '
                'encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL)'
            )
        numbers = {}
        for number, (topic, name) in enumerate(names(entries), start=1):
            numbers[topic] = number
            row = (number, topic, name, 'cdr', QOS)
            if definitions:
                row += (definitions.hash_rihs01(name),)
                text, _ = definitions.generate_msgdef(name, ros_version=2)
                database.execute(
                    'INSERT INTO message_definitions VALUES (NULL, ?, ?, ?, ?)',
                    (name, 'ros2msg', text, definitions.hash_rihs01(name)),
                )
            database.execute(f'INSERT INTO topics VALUES ({", ".join("?" * len(row))})', row)
        for topic, _, stamp, data in entries:
            database.execute(
                'INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)',
                (numbers[topic], stamp, data),
            )
        database.commit()


def write_mcap(path, entries, store):
    with path.open('wb') as stream:
        writer = Writer(stream)
        writer.start('ros2', 'rosbag2')
        channels = {}
        for topic, name in names(entries):
            text, _ = store.generate_msgdef(name, ros_version=2)
            schema = writer.register_schema(name, 'ros2msg', text.encode())
            channels[topic] = writer.register_channel(topic, 'cdr', schema)
        for topic, _, stamp, data in entries:
            writer.add_message(channels[topic], stamp, data, stamp)
        writer.finish()


def write_metadata(folder, version, entries, file, storage='sqlite3', **more):
    """Write metadata as a version of rosbag2 did, with no key that came later."""
    counts = dict.fromkeys(names(entries), 0)
    for topic, name, _, _ in entries:
        counts[topic, name] += 1
    topics = []
    for (topic, name), count in counts.items():
        about = {'name': topic, 'type': name, 'serialization_format': 'cdr'}
        if version >= 4:
            about['offered_qos_profiles'] = QOS if version < 9 else yaml.safe_load(QOS)
        if version >= 7:
            about['type_description_hash'] = STORE.hash_rihs01(name)
        topics.append({'topic_metadata': about, 'message_count': count})
    start, span = {'nanoseconds_since_epoch': 0}, {'nanoseconds': 4 * SECOND}
    told = {
        'version': version,
        'storage_identifier': storage,
        'relative_file_paths': [file if version >= 4 else f'{folder.name}/{file}'],
        'duration': span,
        'starting_time': start,
        'message_count': len(entries),
        'topics_with_message_count': topics,
    }
    if version >= 3:
        told |= {'compression_format': '', 'compression_mode': ''}
    if version >= 5:
        told['files'] = [
            {'path': file, 'starting_time': start, 'duration': span, 'message_count': len(entries)}
        ]
    if version >= 6:
        told['custom_data'] = None
    if version >= 8:
        told['ros_distro'] = 'rolling'
    text = yaml.safe_dump({'rosbag2_bagfile_information': told | more})
    (folder / 'metadata.yaml').write_text(text)


def bag_of(folder, distribution, version, *, storage='sqlite3', embedded=False):
    folder.mkdir()
    entries = list(encoded(distribution))
    store = get_typestore(distribution)
    if storage == 'sqlite3':
        file = f'{folder.name}_0.db3'
        write_database(folder / file, entries, definitions=store if embedded else None)
    else:
        file = f'{folder.name}_0.mcap'
        write_mcap(folder / file, entries, store)
    write_metadata(folder, version, entries, file, storage)
    return folder


def check(path, *, stated_noise):
    """All samples come back; Range states its noise only where its type can."""
    stream = SampleStream([path], NAMESPACE)
    found = [sample for _, sample in stream]
    assert stream.problems == []
    assert len(found) == len(SAMPLES)
    spreads = [sample for sample in found if isinstance(sample, RangeSample)]
    assert [sample.distance for sample in spreads] == [118.5, 119.5, 120.5, 121.5, 122.5]
    assert {sample.std for sample in spreads} == {0.5 if stated_noise else 0.0}
    winches = [sample for sample in found if isinstance(sample, WinchSample)]
    assert [sample.lengths[0] for sample in winches] == [500.0, 501.0, 502.0, 503.0, 504.0]
    summary = summarise(path)
    assert summary.count == len(SAMPLES)
    assert summary.problems == ()
    told = CliRunner().invoke(trawl, ['bag', 'info', str(path)])
    assert told.exit_code == 0
    assert f'{path}: {len(SAMPLES)} messages in 0.1 min' in told.stdout
    assert told.stderr == ''
    return summary


@pytest.mark.parametrize(
    ('distribution', 'version', 'stated_noise'),
    [
        (Stores.ROS2_DASHING, 2, False),
        (Stores.ROS2_ELOQUENT, 3, False),
        (Stores.ROS2_FOXY, 4, False),
        (Stores.ROS2_GALACTIC, 4, False),
        (Stores.ROS2_HUMBLE, 5, False),
        (Stores.ROS2_IRON, 6, True),
    ],
)
def test_databases_without_definitions_are_read_as_their_distribution_wrote_them(
    tmp_path, distribution, version, stated_noise
):
    path = bag_of(tmp_path / 'old', distribution, version)
    summary = check(path, stated_noise=stated_noise)
    assert summary.facts.storage == 'sqlite3'
    assert summary.facts.version == version


@pytest.mark.parametrize('storage', ['sqlite3', 'mcap'])
@pytest.mark.parametrize(
    ('distribution', 'version', 'stated_noise'),
    [
        (Stores.ROS2_HUMBLE, 5, False),
        (Stores.ROS2_HUMBLE, 6, False),
        (Stores.ROS2_IRON, 7, True),
        (Stores.ROS2_JAZZY, 8, True),
        (Stores.ROS2_KILTED, 9, True),
    ],
)
def test_definitions_in_the_bag_say_how_its_bytes_lie(
    tmp_path, distribution, version, stated_noise, storage
):
    path = bag_of(tmp_path / 'bag', distribution, version, storage=storage, embedded=True)
    check(path, stated_noise=stated_noise)


def test_a_database_alone_needs_no_metadata(tmp_path):
    path = bag_of(tmp_path / 'old', Stores.ROS2_FOXY, 4)
    check(path / 'old_0.db3', stated_noise=False)
    (path / 'metadata.yaml').unlink()
    bag = Bag(path)
    assert len(list(bag.messages())) == len(SAMPLES)
    assert 'no metadata.yaml' in bag.problems[0]


def test_a_database_says_which_distribution_made_it(tmp_path):
    entries = list(encoded(Stores.ROS2_JAZZY))
    write_database(tmp_path / 'x.db3', entries, definitions=STORE, distro='kilted')
    assert summarise(tmp_path / 'x.db3').facts.distro == 'kilted'


@pytest.mark.parametrize(
    ('storage', 'mode'),
    [
        (storage, mode)
        for storage in StoragePlugin
        for mode in CompressionMode
        # Databases have no compression of their own.
        if (storage, mode) != (StoragePlugin.SQLITE3, CompressionMode.STORAGE)
    ],
)
@pytest.mark.parametrize('version', [8, 9])
def test_bags_that_rosbags_wrote_are_read_in_every_compression(tmp_path, storage, version, mode):
    path = tmp_path / 'bag'
    writer = RosbagsWriter(path, version=version, storage_plugin=storage)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    entries = list(encoded(Stores.ROS2_JAZZY))
    with writer:
        connections = {
            topic: writer.add_connection(
                topic, name, typestore=STORE, offered_qos_profiles=[project_profile(False)]
            )
            for topic, name in names(entries)
        }
        for topic, _, stamp, data in entries:
            writer.write(connections[topic], stamp, data)
    summary = check(path, stated_noise=True)
    said = {CompressionMode.FILE: 'zstd per file', CompressionMode.MESSAGE: 'zstd per message'}
    if mode in said:
        assert summary.facts.compression == said[mode]
    assert sum(summary.facts.sizes.values()) == sum(
        file.stat().st_size for file in path.iterdir() if file.name != 'metadata.yaml'
    )
    assert Bag(path).offered()['/trawl/door/spread'] == (project_profile(False),)
    assert check_bag(path).findings == ()


def test_metadata_with_another_qos_than_the_database_lose_nothing(tmp_path):
    path = bag_of(tmp_path / 'bag', Stores.ROS2_HUMBLE, 5)
    file = path / 'metadata.yaml'
    file.write_text(file.read_text().replace('depth: 100', 'depth: 7'))
    check(path, stated_noise=False)


def test_metadata_that_disagree_with_a_database_are_refused(tmp_path):
    path = bag_of(tmp_path / 'bag', Stores.ROS2_HUMBLE, 5)
    with closing(sqlite3.connect(path / 'bag_0.db3')) as database:
        database.execute('DELETE FROM messages WHERE id = 3')
        database.commit()
    with pytest.raises(BagError, match=r'5 messages .* 4'):
        Bag(path)
    (finding,) = check_bag(path).findings
    assert '5 messages of sensor_msgs/msg/Range' in finding.text


def test_what_a_killed_recorder_left_in_the_log_beside_the_database_is_read(tmp_path):
    path = bag_of(tmp_path / 'bag', Stores.ROS2_HUMBLE, 5)
    with closing(sqlite3.connect(path / 'bag_0.db3')) as database:
        database.execute('PRAGMA journal_mode = WAL')
        database.execute('DELETE FROM messages WHERE id > 10')
        database.commit()
        saved = {file.name: file.read_bytes() for file in path.iterdir()}
    killed = tmp_path / 'killed'
    killed.mkdir()
    for name, data in saved.items():
        if not name.endswith(('.yaml', '-shm')):
            (killed / name).write_bytes(data)
    assert (killed / 'bag_0.db3-wal').stat().st_size > 0
    assert summarise(killed).count == 10, 'without the log there are 15'


def test_a_database_cut_short_gives_what_is_readable_or_is_named(tmp_path):
    path = tmp_path / 'long.db3'
    entries = list(encoded(Stores.ROS2_HUMBLE)) * 200
    write_database(path, entries)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) * 99 // 100])
    bag = Bag(path)
    assert 0 < len(list(bag.as_stored())) < len(entries)
    assert 'damaged behind' in bag.problems[0]
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(BagError, match=r'long\.db3: cannot be read .*malformed'):
        Bag(path)


def test_a_damaged_page_of_a_database_is_said(tmp_path):
    path = tmp_path / 'long.db3'
    entries = list(encoded(Stores.ROS2_HUMBLE)) * 300
    write_database(path, entries)
    whole = bytearray(path.read_bytes())
    for start in range(len(whole) // 2, len(whole) // 2 + 40 * 4096, 4096):
        whole[start : start + 64] = b'\xff' * 64
    path.write_bytes(whole)
    bag = Bag(path)
    read = len(list(bag.as_stored()))
    assert read < len(entries)
    assert 'damaged behind' in bag.problems[0]


def test_another_database_is_no_bag(tmp_path):
    with closing(sqlite3.connect(tmp_path / 'x.db3')) as database:
        database.execute('CREATE TABLE fish(name TEXT)')
    with pytest.raises(BagError, match=r'x\.db3.*messages and topics'):
        Bag(tmp_path / 'x.db3')


def packed(tmp_path, mode, change):
    path = bag_of(tmp_path / 'bag', Stores.ROS2_JAZZY, 8)
    entries = list(encoded(Stores.ROS2_JAZZY))
    file = path / 'bag_0.db3'
    if mode == 'FILE':
        data = change(zstandard.ZstdCompressor().compress(file.read_bytes()))
        file.with_suffix('.db3.zstd').write_bytes(data)
        file.unlink()
        write_metadata(
            path, 8, entries, 'bag_0.db3.zstd', compression_format='zstd', compression_mode=mode
        )
        return path
    with closing(sqlite3.connect(file)) as database:
        for number, data in database.execute('SELECT id, data FROM messages').fetchall():
            data = zstandard.ZstdCompressor().compress(data)
            database.execute(
                'UPDATE messages SET data = ? WHERE id = ?',
                (change(data) if number == 3 else data, number),
            )
        database.commit()
    write_metadata(path, 8, entries, file.name, compression_format='zstd', compression_mode=mode)
    return path


def test_a_compressed_message_that_is_damaged_is_left_out_and_said(tmp_path):
    bag = Bag(packed(tmp_path, 'MESSAGE', lambda data: data[:-5]))
    assert len(list(bag.messages())) == len(SAMPLES) - 1
    assert '1 compressed messages on ' in bag.problems[0]


@pytest.mark.parametrize('change', [lambda data: b'nothing like it', lambda data: data[:-9]])
def test_a_compressed_file_that_is_none_or_cut_short_is_named(tmp_path, change):
    with pytest.raises(BagError, match=r'bag_0\.db3\.zstd: cannot be unpacked'):
        Bag(packed(tmp_path, 'FILE', change))


def test_a_compressed_file_takes_no_more_than_there_is_room_for(tmp_path, monkeypatch):
    monkeypatch.setattr('trawl_ros.bags.storage.packed.SPARE_BYTES', 1 << 62)
    with pytest.raises(BagError, match='no room'):
        Bag(packed(tmp_path, 'FILE', lambda data: data))


def test_a_message_that_unpacks_to_too_much_takes_no_memory(tmp_path, monkeypatch):
    monkeypatch.setattr('trawl_ros.bags.storage.packed.MAX_CHUNK_BYTES', 1 << 16)
    bomb = zstandard.ZstdCompressor().compress(bytes(1 << 24))
    bag = Bag(packed(tmp_path, 'MESSAGE', lambda data: bomb))
    assert len(list(bag.messages())) == len(SAMPLES) - 1
