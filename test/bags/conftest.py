"""A small bag of two topics that the tests of this folder read and damage."""

from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from trawl_ros.bags.reader import Bag, read_messages
from trawl_ros.bags.writer import BagWriter
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import PressureSample, WinchSample
from trawl_ros.records.topics import absolute

SECOND = 1_000_000_000
START = 1_785_000_000 * SECOND
SECONDS = 300
CHUNKS = 5


def small_messages():
    """Give (topic, type, bytes, log time) of winch and door samples, once per second."""
    random = np.random.default_rng(3)
    for second in range(SECONDS):
        stamp = START + second * SECOND
        lengths, speeds = tuple(random.normal(500, 5, 2)), tuple(random.normal(0, 0.1, 2))
        for sample in (
            WinchSample(stamp, lengths, speeds, tuple(random.normal(8e4, 1e3, 2))),
            PressureSample(stamp, 'port', float(random.normal(1.4e6, 1e3)), 1e3),
        ):
            topic, message = sample_message(sample)
            yield absolute(topic), message.__msgtype__, serialize(message), stamp


def write_small_bag(path: Path) -> Path:
    with BagWriter(path) as bag:
        for number, message in enumerate(small_messages(), start=1):
            bag.write(*message)
            if number % (2 * SECONDS // CHUNKS) == 0:
                bag.flush()
    return path


def write_again(path: Path, **options) -> None:
    """Write an MCAP file of `write_small_bag` anew, as the library of MCAP writes it by itself.

    Descriptions of topics stand in the first chunk and, unless ``options`` say otherwise, in the
    summary.
    """
    with path.open('rb') as stream:
        found = list(make_reader(stream).iter_messages())
    channels: dict[str, int] = {}
    with path.open('wb') as stream:
        writer = Writer(stream, **options)
        writer.start('ros2', 'test')
        for number, (schema, channel, message) in enumerate(found):
            if channel.topic not in channels:
                said = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(
                    channel.topic, channel.message_encoding, said, channel.metadata
                )
            if number and number % (2 * SECONDS // CHUNKS) == 0:
                writer.flush()
            times = message.log_time, message.data, message.publish_time
            writer.add_message(channels[channel.topic], *times)
        writer.finish()


@pytest.fixture
def rewrite():
    """Give what writes an MCAP file as others do, see `write_again`."""
    return write_again


@pytest.fixture(scope='session')
def messages():
    return list(small_messages())


@pytest.fixture(scope='session')
def sound_bag(tmp_path_factory):
    return write_small_bag(tmp_path_factory.mktemp('bags') / 'trial')


@pytest.fixture
def bag_path(tmp_path):
    """Give a fresh copy of the small bag, to be damaged."""
    return write_small_bag(tmp_path / 'trial')


@pytest.fixture
def mcap_path(bag_path):
    return bag_path / 'trial_0.mcap'


@pytest.fixture(scope='session')
def read():
    """Give all messages of a bag, decoded, and what is wrong with it."""

    def read_bag(path, topics=None):
        problems = []
        return list(read_messages(path, topics, problems=problems)), problems

    return read_bag


@pytest.fixture(scope='session')
def raw():
    """Give all messages of a bag as they stand there, and what is wrong with it."""

    def raw_bag(path):
        bag = Bag(path)
        return [(m.topic, m.type, m.data, m.log_time) for m in bag.raw()], bag.problems

    return raw_bag
