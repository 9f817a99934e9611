"""Two sources on one topic are told by `check`, and not mixed into an estimate."""

from dataclasses import replace

import numpy as np
import pytest
from mcap.writer import Writer

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.samples import SampleStream
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.messages.cdr import definition, serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import WinchSample
from trawl_ros.records.topics import absolute

SECOND = 1_000_000_000


def winch(seconds=200):
    draw = np.random.default_rng(1).standard_normal
    for second in range(seconds):
        tensions = tuple(3e4 + 3e3 * np.sin(2 * np.pi * second / 7.3) + 300 * draw(2))
        yield WinchSample((second + 1) * SECOND, (500.0, 500.0), (0.0, 0.0), tensions)


def two(offset, factor=1.15):
    """Give samples with those of another source behind each, ``offset`` (s) later."""
    for sample in winch():
        yield sample
        stamp = sample.stamp + int(offset * SECOND)
        yield replace(sample, stamp=stamp, tensions=tuple(factor * t for t in sample.tensions))


def write(path, samples):
    with BagWriter(path) as bag:
        for number, sample in enumerate(samples):
            topic, message = sample_message(sample)
            time = number * SECOND // 2
            bag.write(absolute(topic), message.__msgtype__, serialize(message), time)
    return path


def kinds(path):
    return {finding.kind for finding in check_bag(path).findings}


@pytest.mark.parametrize('offset', [0.5, 0.3, 0.0, -5.0])
def test_a_second_source_is_found_and_refused(tmp_path, offset):
    path = write(tmp_path / 'bag', two(offset))
    assert 'source' in kinds(path)
    with pytest.raises(BagError, match='winch/joint_states has two sources'):
        list(SampleStream([path], '/trawl'))


def test_one_source_in_the_waves_is_one(tmp_path):
    path = write(tmp_path / 'bag', winch())
    assert 'source' not in kinds(path)
    assert len(list(SampleStream([path], '/trawl'))) == 200


def test_a_few_stamps_that_come_twice_are_a_fault_and_no_source(tmp_path):
    samples = list(winch())
    samples[50] = replace(samples[50], stamp=samples[49].stamp)
    assert 'source' not in kinds(write(tmp_path / 'bag', samples))


@pytest.mark.parametrize(('by_turns', 'found'), [(True, True), (False, False)])
def test_channels_that_take_turns_are_sources_and_one_behind_the_other_is_not(
    tmp_path, by_turns, found
):
    with (tmp_path / 'a.mcap').open('wb') as stream:
        mcap = Writer(stream)
        mcap.start('ros2', 'test')
        channels = []
        for number, sample in enumerate(winch()):
            topic, message = sample_message(sample)
            name = message.__msgtype__
            while len(channels) < 2:
                schema = mcap.register_schema(name, 'ros2msg', definition(name).encode())
                channels.append(mcap.register_channel(absolute(topic), 'cdr', schema))
            channel = channels[number % 5 == 0 if by_turns else number >= 100]
            mcap.add_message(channel, sample.stamp, serialize(message), sample.stamp)
        mcap.finish()
    assert ('source' in kinds(tmp_path / 'a.mcap')) == found
