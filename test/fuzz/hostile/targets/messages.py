"""Messages: CDR bytes of every type of the topic table, and definitions that bags carry."""

from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy
from rosbags.interfaces import Nodetype

from hostile.mutations import mutated
from hostile.target import Target, one_file
from hostile.targets.bag_files import texts
from trawl_ros.bags.storage.decoding import BagTypes
from trawl_ros.bags.storage.stored import Definition
from trawl_ros.core.errors import MessageError
from trawl_ros.messages import commands, diagnostics, estimates, from_messages, truth_from_messages
from trawl_ros.messages.cdr import STORE, deserialize, serialize
from trawl_ros.messages.fields import beyond
from trawl_ros.records.topics import TOPICS, WINCH_NAMES

FILE = 'message'
WORDS = ('', 'port', *WINCH_NAMES, 'mono8', 'x', 'intensity', 'none', '\x00', '\x1b[2J', 'é' * 300)
WHOLE = (0, 1, 2, 4, 7, 12, 16, 127)
REAL = (0.0, 1.0, -1.0, 1e-30, 3e38, float('nan'), float('inf'), -float('inf'), 0.5)


@st.composite
def values(draw: DrawFn, type_name: str) -> Any:
    """A message of a type with numbers, words and lengths of any kind."""
    made = {
        name.rstrip('_') if name not in _names(type_name) else name: draw(_value(*kind))
        for name, kind in STORE.fielddefs[type_name][1]
    }
    return STORE.types[type_name](**made)


@cache
def _names(type_name: str) -> frozenset[str]:
    return frozenset(field.name for field in fields(STORE.types[type_name]))


@cache
def _value(kind: Nodetype, detail: Any) -> SearchStrategy[Any]:
    if kind is Nodetype.NAME:
        return values(detail)
    if kind is Nodetype.BASE:
        return _number(detail[0])
    (inner, what), count = detail
    counts = st.just(count) if kind is Nodetype.ARRAY else st.sampled_from((0, 1, 2, 3, 12, 144))
    if inner is Nodetype.BASE and what[0] != 'string':
        return st.tuples(counts, st.lists(_number(what[0]), min_size=1, max_size=4)).map(
            lambda made: np.resize(np.array(made[1], dtype=what[0]), made[0])
        )
    most = count if kind is Nodetype.ARRAY else 3
    least = most if kind is Nodetype.ARRAY else 0
    return st.lists(_value(inner, what), min_size=least, max_size=most)


def _number(name: str) -> SearchStrategy[Any]:
    match name:
        case 'string':
            return st.sampled_from(WORDS)
        case 'bool':
            return st.booleans()
        case 'float32' | 'float64':
            return st.sampled_from([float(number) for number in np.array(REAL, dtype=name)])
    # CDR of a byte is signed here.
    bounds = np.iinfo('int8' if name == 'byte' else name)
    low, high = bounds.min, bounds.max
    return st.sampled_from((int(low), int(high), *WHOLE))


@st.composite
def messages(draw: DrawFn) -> bytes:
    """A topic in the first line, then the bytes of a message of its type, damaged or not."""
    topic = draw(st.sampled_from(sorted(TOPICS)))
    sound = values(TOPICS[topic].type).map(serialize)
    return topic.encode() + b'\n' + draw(st.one_of(sound, sound, mutated(sound)))


def read_message(given: Path, results: Path) -> None:
    """Decode a message, look through it, and take from it what the project takes."""
    topic, data = (given / FILE).read_bytes().split(b'\n', 1)
    name = topic.decode()
    message = deserialize(data, TOPICS[name].type)
    beyond(message)
    refused = None
    for read in _readers(name):
        try:
            read(message)
        except MessageError as reason:
            refused = reason
    if refused:
        raise refused


def _readers(topic: str) -> list[Any]:
    """All that take a message of this type apart."""
    kind = TOPICS[topic].type
    found: list[Any] = [lambda message: from_messages.to_sample(topic, message)]
    match kind:
        case 'nav_msgs/msg/Odometry':
            found.append(lambda message: truth_from_messages.door_truth(topic, message))
        case 'sensor_msgs/msg/JointState':
            found.append(lambda message: truth_from_messages.winch_truth(topic, message))
            found += [commands.read_winch_command, estimates.read_innovations]
        case 'geometry_msgs/msg/TwistStamped':
            found.append(commands.read_vessel_command)
        case 'diagnostic_msgs/msg/KeyValue':
            found.append(commands.read_fault_command)
        case 'diagnostic_msgs/msg/DiagnosticArray':
            found.append(diagnostics.read_statuses)
        case 'std_msgs/msg/Float64MultiArray':
            found += [estimates.read_estimate, estimates.read_covariance]
        case 'sensor_msgs/msg/PointCloud2':
            found.append(truth_from_messages.schools_truth)
        case 'geometry_msgs/msg/Vector3Stamped':
            found.append(truth_from_messages.seabed_truth)
    return found


@st.composite
def definitions(draw: DrawFn) -> bytes:
    """Type and encoding in the first line, then the text, then a message after a NUL."""
    name = draw(st.sampled_from(sorted({topic.type for topic in TOPICS.values()})))
    encoding, text = draw(texts(name))
    shown = draw(st.sampled_from((name, name, name, 'a/msg/B', 'T', '')))
    return f'{shown} {encoding}\n'.encode() + text + b'\0' + draw(values(name).map(serialize))


def read_definition(given: Path, results: Path) -> None:
    """Make a decoder of a definition, and decode with it."""
    head, rest = (given / FILE).read_bytes().split(b'\n', 1)
    text, _, data = rest.partition(b'\0')
    name, encoding = head.decode().rsplit(' ', 1)
    BagTypes().decoder('/topic', Definition(name, 'cdr', encoding, text))(data)


TARGETS = (
    Target(name='message', inputs=one_file(FILE, messages()), read=read_message, examples=200),
    Target(
        name='definition',
        inputs=one_file(FILE, definitions()),
        read=read_definition,
        examples=100,
    ),
)
