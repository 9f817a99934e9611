"""Stamps are read off bytes as they are in the messages."""

import numpy as np
import pytest

from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.diagnostics import diagnostic_array
from trawl_ros.messages.estimates import estimate_message
from trawl_ros.messages.markers import gear_markers
from trawl_ros.messages.stamps import header_stamp
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.messages.truth_to_messages import clock_message
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import FixSample, HeadingSample, RangeSample, WinchSample
from trawl_ros.records.truth import GearPicture, Polyline

STAMP = 1_785_000_123_456_789_012


@pytest.mark.parametrize(
    'message',
    [
        sample_message(WinchSample(STAMP, (1.0, 2.0), (0.0, 0.0), (3.0, 4.0)))[1],
        sample_message(RangeSample(STAMP, 'spread', 80.0, 1.0, 5.0, 400.0))[1],
        sample_message(HeadingSample(STAMP, 1.0, 0.1))[1],
        sample_message(FixSample(STAMP, 60.0, 2.0, 1.0))[1],
        diagnostic_array(STAMP, []),
    ],
    ids=lambda message: message.__msgtype__,
)
def test_a_header_is_found(message):
    assert header_stamp(message.__msgtype__, serialize(message)) == STAMP


def test_markers_have_the_stamp_of_the_first():
    rope = Polyline('warp', np.zeros((2, 3)), 0.0)
    doors = partial_truth(STAMP).doors
    _, message = gear_markers(GearPicture(STAMP, (rope,), doors, (1.0, 2.0)))
    assert header_stamp(message.__msgtype__, serialize(message)) == STAMP
    array = deserialize(serialize(message), message.__msgtype__)
    array.markers = []
    assert header_stamp(array.__msgtype__, serialize(array)) is None


@pytest.mark.parametrize('message', [estimate_message(np.zeros(12))[1], clock_message(STAMP)[1]])
def test_what_has_no_header_has_no_stamp(message):
    assert header_stamp(message.__msgtype__, serialize(message)) is None


def test_bytes_cut_short_have_no_stamp():
    message = sample_message(HeadingSample(STAMP, 1.0, 0.1))[1]
    assert header_stamp(message.__msgtype__, serialize(message)[:9]) is None
