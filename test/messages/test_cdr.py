"""The project's CDR is the one that rclpy speaks: same layout, same bytes, same type hashes."""

import array
import importlib
import json
import os
import sys
from pathlib import Path

import numpy as np
import pytest

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.cdr import STORE, deserialize, message_definition, serialize, type_hash
from trawl_ros.messages.stamps import from_time, to_time
from trawl_ros.records.topics import TOPICS

TYPES = sorted({topic.type for topic in TOPICS.values()})

PREFIXES = [
    Path(prefix)
    for prefix in (*os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep), sys.prefix)
    if prefix
]


def filled(type_name, seed):
    """Build a message of the type with another value in every field."""
    counter = iter(range(seed, seed + 10_000))
    return _filled(type_name, counter)


def _filled(type_name, counter):
    fields = STORE.fielddefs[type_name][1]
    values = {name: _value(description, counter) for name, description in fields}
    return STORE.types[type_name](**values)


def _value(description, counter):
    kind, detail = description
    match kind.name:
        case 'BASE':
            return _scalar(detail[0], next(counter))
        case 'NAME':
            return _filled(detail, counter)
    inner, length = detail
    entries = [_value(inner, counter) for _ in range(length or 3)]
    if inner[0].name == 'BASE' and inner[1][0] != 'string':
        return np.array(entries, dtype={'octet': 'uint8'}.get(inner[1][0], inner[1][0]))
    return entries


def _scalar(name, number):
    if name == 'string':
        return f'text {number} é'
    if name == 'bool':
        return number % 2 == 1
    return number + 0.5 if name.startswith('float') else number % 100


def plain(value):
    """Turn a message of either library into nested tuples of plain values."""
    if isinstance(value, np.ndarray | array.array | list | tuple):
        return tuple(plain(entry) for entry in value)
    if hasattr(value, '__dataclass_fields__'):
        names = [name for name in value.__dataclass_fields__ if not name.startswith('__')]
        return tuple((n, plain(getattr(value, n))) for n in names if n.islower())
    if hasattr(value, 'get_fields_and_field_types'):
        names = value.get_fields_and_field_types()
        return tuple((name, plain(getattr(value, name))) for name in names)
    return value[0] if isinstance(value, bytes) else value


def rclpy_class(type_name):
    package, _, name = type_name.split('/')
    if package == 'tf2_msgs':
        pytest.importorskip('tf2_msgs', reason='tf2_msgs comes with a full ROS 2 only')
    return getattr(importlib.import_module(f'{package}.msg'), name)


@pytest.mark.parametrize('type_name', TYPES)
def test_rclpy_reads_what_the_project_writes_field_by_field(type_name):
    serialization = pytest.importorskip('rclpy.serialization')
    message = filled(type_name, seed=1)
    received = serialization.deserialize_message(serialize(message), rclpy_class(type_name))
    assert plain(received) == plain(message)


@pytest.mark.parametrize('type_name', TYPES)
def test_the_project_reads_what_rclpy_writes(type_name):
    serialization = pytest.importorskip('rclpy.serialization')
    message = filled(type_name, seed=2)
    sent = serialization.deserialize_message(serialize(message), rclpy_class(type_name))
    data = serialization.serialize_message(sent)
    assert plain(deserialize(data, type_name)) == plain(message)


@pytest.mark.parametrize('type_name', TYPES)
def test_type_hashes_are_those_of_the_installed_distribution(type_name):
    package, kind, name = type_name.split('/')
    described = (prefix / 'share' / package / kind / f'{name}.json' for prefix in PREFIXES)
    path = next((path for path in described if path.is_file()), None)
    if path is None:
        pytest.skip(f'no type description of {type_name} under AMENT_PREFIX_PATH or sys.prefix')
    hashes = json.loads(path.read_text())['type_hashes']
    assert {entry['type_name']: entry['hash_string'] for entry in hashes}[type_name] == type_hash(
        type_name
    )


def test_definitions_carry_the_nested_types():
    text = message_definition('sensor_msgs/msg/Range')
    assert 'float32 variance' in text
    assert 'MSG: std_msgs/Header' in text
    assert 'MSG: builtin_interfaces/Time' in text


@pytest.mark.parametrize('cut', [0, 3, 4, 11, 40])
def test_bytes_cut_short_are_refused(cut):
    data = serialize(filled('sensor_msgs/msg/JointState', seed=3))
    with pytest.raises(MessageError, match=f'{cut} bytes .*sensor_msgs/msg/JointState'):
        deserialize(data[:cut], 'sensor_msgs/msg/JointState')


def test_an_absurd_length_inside_is_refused():
    data = bytearray(serialize(filled('sensor_msgs/msg/JointState', seed=3)))
    data[12:16] = b'\xff\xff\xff\x7f'
    with pytest.raises(MessageError):
        deserialize(bytes(data), 'sensor_msgs/msg/JointState')


def test_random_bytes_are_refused_or_read_but_never_crash():
    random = np.random.default_rng(5)
    for _ in range(300):
        data = b'\x00\x01\x00\x00' + random.bytes(int(random.integers(0, 200)))
        for type_name in ('nav_msgs/msg/Odometry', 'visualization_msgs/msg/MarkerArray'):
            try:
                deserialize(data, type_name)
            except MessageError:
                continue


def test_an_unknown_type_is_named():
    with pytest.raises(MessageError, match='acme_msgs/msg/Thing'):
        deserialize(b'', 'acme_msgs/msg/Thing')


@pytest.mark.parametrize('stamp', [0, 1, 999_999_999, 1_785_000_000_123_456_789, -1])
def test_stamps_keep_every_nanosecond(stamp):
    time = to_time(stamp)
    assert 0 <= time.nanosec < 1_000_000_000
    assert from_time(time) == stamp
