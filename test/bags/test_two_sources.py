"""Two sources on one topic are told by `check`, and not mixed into an estimate."""

from dataclasses import replace

import numpy as np
import pytest
from mcap.writer import Writer

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.samples import SampleStream
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.messages.cdr import message_definition, serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import WinchSample
from trawl_ros.records.topics import absolute

SECOND = 1_000_000_000


def interleaved(*sources):
    """Give the samples of sources (rate Hz, begin s, end s, factor) by their stamps."""
    draw = np.random.default_rng(1).standard_normal
    samples = []
    for rate, begin, end, factor in sources:
        for time in np.arange(begin, end, 1.0 / rate):
            tensions = factor * (3e4 + 3e3 * np.sin(2 * np.pi * time / 7.3) + 300 * draw(2))
            stamp = SECOND + round(time * SECOND)
            samples.append(WinchSample(stamp, (500.0, 500.0), (0.0, 0.0), tuple(tensions)))
    return sorted(samples, key=lambda sample: sample.stamp)


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


RATES = [(10.0, 3.0), (3.0, 10.0), (10.0, 7.0), (10.0, 0.5), (1.0, 0.3), (0.2, 0.07)]


@pytest.mark.parametrize('factor', [1.15, 0.85])
@pytest.mark.parametrize('begin', [0.013, 0.0], ids=['between', 'at the same stamps'])
@pytest.mark.parametrize(('rate', 'other'), RATES)
def test_a_second_source_of_another_rate_is_found_and_refused(tmp_path, rate, other, begin, factor):
    end = 200.0 / min(rate, other)
    path = write(tmp_path / 'bag', interleaved((rate, 0.0, end, 1.0), (other, begin, end, factor)))
    assert 'source' in kinds(path)
    with pytest.raises(BagError, match='winch/joint_states has two sources'):
        list(SampleStream([path], '/trawl'))


@pytest.mark.parametrize('latency_s', [0.0, 0.35])
def test_a_second_source_that_begins_in_the_middle_is_found(tmp_path, latency_s):
    samples = interleaved((10.0, 0.0, 100.0, 1.0), (3.0, 50.013, 60.0, 1.15))
    late = {sample.stamp for sample in interleaved((3.0, 50.013, 60.0, 1.15))}
    arriving = sorted(samples, key=lambda one: one.stamp + (one.stamp in late) * latency_s * SECOND)
    assert 'source' in kinds(write(tmp_path / 'bag', arriving))


@pytest.mark.parametrize('wrong', [lambda i, draw: i % 4 == 0, lambda i, draw: draw < 0.1],
                         ids=['every fourth', 'one in ten'])  # fmt: skip
def test_readings_that_are_wrong_in_their_turn_are_a_fault_and_no_source(tmp_path, wrong):
    draws = np.random.default_rng(2).random(3000)
    samples = [
        replace(sample, tensions=tuple(1.15 * tension for tension in sample.tensions))
        if wrong(number, draws[number])
        else sample
        for number, sample in enumerate(interleaved((10.0, 0.0, 300.0, 1.0)))
    ]
    assert 'source' not in kinds(write(tmp_path / 'bag', samples))


@pytest.mark.parametrize('rate', [10.0, 3.0, 1.0, 0.2])
def test_one_source_that_misses_a_third_of_its_readings_is_one(tmp_path, rate):
    kept = np.random.default_rng(3).random(1000) > 0.3
    samples = interleaved((rate, 0.0, 1000.0 / rate, 1.0))
    left = [sample for sample, there in zip(samples, kept, strict=True) if there]
    assert 'source' not in kinds(write(tmp_path / 'bag', left))


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
                schema = mcap.register_schema(name, 'ros2msg', message_definition(name).encode())
                channels.append(mcap.register_channel(absolute(topic), 'cdr', schema))
            channel = channels[number % 5 == 0 if by_turns else number >= 100]
            mcap.add_message(channel, sample.stamp, serialize(message), sample.stamp)
        mcap.finish()
    assert ('source' in kinds(tmp_path / 'a.mcap')) == found
