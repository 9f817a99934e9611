"""Bags: MCAP and SQLite files, metadata and definitions, damaged and written with intent."""

import sqlite3
import struct
import zlib
from contextlib import closing, suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import zstandard
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from hostile.mutations import mutated
from hostile.target import Files, Target, one_file
from hostile.targets.yaml_files import hostile_yaml
from trawl_ros.bags.check import check_bag
from trawl_ros.bags.export import export_bag
from trawl_ros.bags.reader import summarise
from trawl_ros.bags.repair import repair_bag
from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.errors import TrawlError
from trawl_ros.messages.cdr import message_definition
from trawl_ros.messages.from_messages import SAMPLE_TOPICS
from trawl_ros.records.topics import absolute, find_topic

MAGIC = b'\x89MCAP0\r\n'
NUMBERS = st.sampled_from((0, 1, 5, 10**9, 2**31, 2**62, 2**63 - 1, 2**63, 2**64 - 1))
TYPES = {
    absolute(name): known.type for name in SAMPLE_TOPICS if (known := find_topic(absolute(name)))
}
FIELDS = (
    *('float64 x', 'string[1000000] a', 'string<=5 s', 'uint8[0] z', 'B[] again', 'B once'),
    *('std_msgs/Header header', 'int8 X=1', 'float64 class', 'uint8[<=99999999999] u', 'T t'),
    *('float64[99999999999999] big', 'wstring w', 'string s "' + 'x' * 99 + '"', '@opt', '#'),
)
CONSTANTS = ('1', '((((1))))', '1 << 30000000000', '-1', '9' * 5000, '1/0', 'X', '"a"', '1.5e999')


@cache
def texts(name: str) -> SearchStrategy[tuple[str, bytes]]:
    """Encodings with definitions of a type: its own, damaged, made of hostile fields, or IDL."""
    own = message_definition(name).encode()
    lines = st.lists(st.sampled_from(FIELDS), max_size=6).map('\n'.join).map(str.encode)
    idl = st.tuples(st.sampled_from(CONSTANTS), st.sampled_from(('B', 'T', 'dataclass'))).map(
        lambda made: (
            f'module a {{ module msg {{ const long X = {made[0]}; '
            f'struct {made[1]} {{ sequence<long, {made[0]}> x; }}; }}; }};'
        ).encode()
    )
    return st.one_of(
        st.just(('ros2msg', own)),
        st.just(('ros2msg', own)),
        st.tuples(st.just('ros2msg'), st.one_of(mutated(st.just(own)), lines)),
        st.tuples(st.just('ros2idl'), idl),
    )


@st.composite
def messages(draw: DrawFn) -> bytes:
    """CDR bytes: header, stamp, then numbers, NaN and lengths of any kind."""
    part = st.one_of(
        st.floats(width=64).map(lambda number: struct.pack('<d', number)),
        st.sampled_from((0, 1, 2, 2**31, 2**32 - 1)).map(lambda number: struct.pack('<I', number)),
        st.binary(max_size=16),
    )
    stamp = struct.pack('<iI', draw(st.sampled_from((-1, 0, 9, 2**31 - 1))), 0)
    head = draw(st.sampled_from((b'\0\1\0\0', b'\0\0\0\0', b'\7\7', b'')))
    return head + stamp + b'\1\0\0\0\0\0\0\0' + b''.join(draw(st.lists(part, max_size=40)))


def record(opcode: int, content: bytes) -> bytes:
    """One record of MCAP."""
    return struct.pack('<BQ', opcode, len(content)) + content


def text(content: bytes) -> bytes:
    """Bytes with their length before them."""
    return struct.pack('<I', len(content)) + content


@st.composite
def mcap_files(draw: DrawFn) -> bytes:
    """MCAP: chunks that are packed or not, with or without summary, numbers of any size."""
    out = bytearray(MAGIC + record(1, bytes(8)))
    for _ in range(draw(st.integers(1, 3))):
        plain = bytearray()
        for number in range(1, draw(st.integers(1, 3)) + 1):
            topic, name = draw(st.sampled_from(sorted(TYPES.items())))
            encoding, said = draw(texts(name))
            shown = draw(st.sampled_from((name, name, name, 'T', 'a/msg/B', 'x' * 5000, '')))
            schema = text(shown.encode()) + text(encoding.encode()) + text(said)
            plain += record(3, struct.pack('<H', number) + schema)
            channel = struct.pack('<HH', number, draw(st.sampled_from((number, number, 0, 9))))
            plain += record(4, channel + text(topic.encode()) + text(b'cdr') + bytes(4))
        for _ in range(draw(st.integers(0, 20))):
            time = draw(NUMBERS)
            head = struct.pack('<HIQQ', draw(st.integers(1, 3)), 0, time, time)
            plain += record(5, head + draw(messages())) * draw(st.sampled_from((1, 1, 100)))
        packed = draw(st.booleans())
        data = zstandard.ZstdCompressor().compress(bytes(plain)) if packed else bytes(plain)
        head = struct.pack('<QQQI', draw(NUMBERS), 0, len(plain), zlib.crc32(plain))
        chunk = head + text(b'zstd' if packed else b'') + struct.pack('<Q', len(data)) + data
        place = len(out)
        out += record(6, chunk)
    if draw(st.booleans()):
        start = len(out) + 13
        out += record(15, bytes(4))
        where = draw(st.sampled_from((place, 2**62, 2**64 - 1)))
        sizes = struct.pack('<QQQQ', draw(NUMBERS), 0, where, len(chunk) + 9)
        out += record(8, sizes + bytes(12) + text(b'') + bytes(16))
        out += record(11, struct.pack('<QHIIIIQQ', 1, 1, 1, 0, 0, 1, 0, 0) + bytes(4))
        out += record(2, struct.pack('<QQI', start, 0, 0)) + MAGIC
    return bytes(out)


VALUES = (
    *("'/trawl/winch/joint_states'", "'sensor_msgs/msg/JointState'", "'cdr'", "''", 'NULL'),
    *("x'00ff'", '1', '-1', '9223372036854775807', '1.5', 'zeroblob(1000000)', "'a' || x'00'"),
)


@st.composite
def databases(draw: DrawFn) -> bytes:
    """SQLite: columns plain, computed or missing, tables, views or virtual ones, any values."""
    value = st.sampled_from(VALUES)
    lines = []
    for name, columns in (
        ('topics', ('id', 'name', 'type', 'serialization_format', 'offered_qos_profiles')),
        ('messages', ('id', 'topic_id', 'timestamp', 'data')),
        ('message_definitions', ('topic_type', 'encoding', 'encoded_message_definition')),
    ):
        computed = draw(st.sampled_from((None, None, None, *columns)))
        said = ', '.join(
            f'{column} AS (zeroblob(900000000))' if column == computed else column
            for column in columns
        )
        made = [f'CREATE TABLE {name}({said})'] * 8
        made += [
            f'CREATE VIEW {name} AS SELECT 1 id',
            f'CREATE VIRTUAL TABLE {name} USING fts5(id)',
        ]
        lines.append(draw(st.sampled_from(made)))
        for _ in range(draw(st.integers(0, 4))):
            row = ', '.join(draw(st.tuples(*[value] * len(columns))))
            lines.append(f'INSERT INTO {name} VALUES({row})')
    lines.append("INSERT INTO topics VALUES(1, '/a', 'std_msgs/msg/Empty', 'cdr', '')")
    lines.append("INSERT INTO messages VALUES(1, 1, 5, x'0001000000')")
    with TemporaryDirectory() as folder:
        path = Path(folder) / 'a.db3'
        with closing(sqlite3.connect(path)) as file:
            for line in lines:
                with suppress(sqlite3.Error):
                    file.execute(line)
            file.commit()
        return path.read_bytes()


METADATA = """rosbag2_bagfile_information:
  version: 8
  storage_identifier: mcap
  duration: {nanoseconds: 5}
  starting_time: {nanoseconds_since_epoch: 0}
  message_count: 1
  topics_with_message_count:
  - topic_metadata: {name: /a, type: std_msgs/msg/Empty, serialization_format: cdr}
    message_count: 1
  compression_format: ''
  compression_mode: ''
  relative_file_paths: [a.mcap]
  custom_data: null
  ros_distro: jazzy
"""


def read_bag(path: Path, results: Path) -> None:
    """Read a bag in each way in which it can be read; each may end in a sentence."""
    results.mkdir()
    sentence = None
    for read in (
        lambda: summarise(path, lenient=True),
        lambda: check_bag(path),
        lambda: repair_bag(path, results / 'repaired'),
        lambda: export_bag(path, results / 'tables'),
        lambda: list(SampleStream([path], '/trawl')),
    ):
        try:
            read()
        except TrawlError as error:
            sentence = error
    if sentence:
        raise sentence


def _target(name: str, file: str, content: SearchStrategy[bytes], examples: int) -> Target:
    return Target(
        name=name,
        inputs=one_file(file, content),
        read=lambda given, results: read_bag(given / Path(file).name, results),
        examples=examples,
    )


def _with_metadata(content: bytes) -> Files:
    return {'metadata.yaml': content, 'a.mcap': MAGIC + record(1, bytes(8))}


TARGETS = (
    _target('bag-mcap', 'a.mcap', st.one_of(mcap_files(), mutated(mcap_files())), 60),
    _target('bag-sqlite', 'a.db3', st.one_of(databases(), databases(), mutated(databases())), 40),
    Target(
        name='bag-metadata',
        inputs=hostile_yaml([METADATA]).map(_with_metadata),
        read=read_bag,
        examples=60,
        known={'brackets': lambda: _with_metadata(b'[' * 100_000)},
    ),
)
