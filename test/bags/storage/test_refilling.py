"""A message that is filled anew says what it would say if it had been decoded by itself."""

import numpy as np
import pytest

from trawl_ros.bags.storage.decoding import BagTypes
from trawl_ros.bags.storage.refilling import LARGEST
from trawl_ros.bags.storage.stored import describe
from trawl_ros.core.errors import MessageError
from trawl_ros.lab.benchmark.full_chain import TOPICS, example
from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import PressureSample

TYPES = sorted({topic.type for topic in TOPICS})


def decoders(name):
    types, definition = BagTypes(), describe(name, '')
    return types.decoder('/topic', definition), types.refilling('/topic', definition)


def content(decode, data, name):
    try:
        return serialize(decode(data), name)
    except MessageError as reason:
        return str(reason)


@pytest.mark.parametrize('name', TYPES)
def test_whatever_bytes_change_both_decoders_say_the_same(name):
    afresh, refilling = decoders(name)
    sound = serialize(example(name))
    if len(sound) > LARGEST:
        sound = sound[: LARGEST // 2]
    random = np.random.default_rng(len(sound))
    for _ in range(100):
        data = bytearray(sound)
        for place in random.integers(0, len(data), random.integers(0, 4)):
            data[place] = random.integers(0, 256)
        cut = bytes(data[: len(data) - random.integers(0, 2) * random.integers(0, 9)])
        for each in (cut, sound):
            assert content(refilling, each, name) == content(afresh, each, name)


def test_a_message_laid_out_as_the_one_before_is_the_same_object():
    name = 'sensor_msgs/msg/FluidPressure'
    _, refilling = decoders(name)
    first, second, third = (
        refilling(serialize(sample_message(PressureSample(stamp, 'port', 1e5 + stamp, 10.0))[1]))
        for stamp in (1, 2, 3)
    )
    assert second is third
    assert first is not third
    assert (first.fluid_pressure, third.fluid_pressure) == (100001.0, 100003.0)


def test_another_frame_of_the_same_length_is_read_as_it_is():
    name = 'sensor_msgs/msg/FluidPressure'
    _, refilling = decoders(name)
    data = serialize(sample_message(PressureSample(1, 'port', 1e5, 10.0))[1])
    frame = deserialize(data, name).header.frame_id.encode()
    other = data.replace(frame, frame[::-1])
    frames = [refilling(each).header.frame_id.encode() for each in (data, other, data, other)]
    assert frames == [frame, frame[::-1]] * 2
