"""Clocks that stand still, were set back or are of another year are told as what they are."""

from dataclasses import replace

import pytest

from trawl_ros.bags.check import check_bag
from trawl_ros.bags.samples import SampleStream
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import WinchSample
from trawl_ros.records.topics import absolute

SECOND = 1_000_000_000
START = 1_785_000_000 * SECOND
DAY = 86_400 * SECOND


def winch(stamps):
    return [
        WinchSample(stamp, (300.0 + 0.1 * number, 300.2), (0.1, 0.1), (8e4 + number % 7, 8.1e4))
        for number, stamp in enumerate(stamps)
    ]


def write(path, samples, *, received):
    """Write samples in their order, logged when they came or at their stamps."""
    with BagWriter(path) as bag:
        for number, sample in enumerate(samples):
            topic, message = sample_message(sample)
            log_time = START + number * SECOND if received else sample.stamp
            bag.write(absolute(topic), message.__msgtype__, serialize(message), log_time)
    return path


def findings(path):
    return {finding.kind: finding.text for finding in check_bag(path).findings}


ticks = [START + number * SECOND for number in range(1500)]
SET_BACK = [*ticks[:900], *ticks[300:900]]


@pytest.mark.parametrize(
    ('stamps', 'received', 'said', 'refused'),
    [
        ([0] * 100, True, 'never stamps', ': 100 stamps are 0'),
        ([0] * 100, False, 'never stamps', ': 100 stamps are 0'),
        (SET_BACK, True, 'set back', 'winch/joint_states.* set back'),
        (SET_BACK, False, 'set back', 'winch/joint_states.* set back'),
        ([START] * 100, True, 'stands still', 'winch/joint_states.* stands still'),
    ],
)
def test_a_clock_that_tells_no_time_is_no_second_source(tmp_path, stamps, received, said, refused):
    path = write(tmp_path / 'bag', winch(stamps), received=received)
    found = findings(path)
    assert said in found['stamp']
    assert 'source' not in found
    with pytest.raises(BagError, match=f'{path}.*{refused}'):
        list(SampleStream([path], '/trawl'))


@pytest.mark.parametrize('received', [True, False])
@pytest.mark.parametrize(
    'false', [0, 315_964_800 * SECOND, 1_115_251_200 * SECOND, START - 7168 * DAY]
)
def test_stamps_that_cannot_be_are_left_out_and_counted(tmp_path, received, false):
    stamps = [false + number * SECOND * (false > 0) for number in range(40)] + ticks[:200]
    path = write(tmp_path / 'bag', winch(stamps), received=received)
    check = check_bag(path)
    assert '40 stamps are' in ' '.join(f.text for f in check.findings if f.kind == 'stamp')
    assert check.end - check.start < 300 * SECOND
    stream = SampleStream([path], '/trawl')
    assert [sample.stamp for _, sample in stream] == ticks[:200]
    assert len(stream.problems) == 1
    assert '40 stamps are' in stream.problems[0]


@pytest.mark.parametrize('number', [1, 2])
def test_stamps_far_ahead_for_a_moment_are_no_clock_set_back(tmp_path, number):
    samples = winch(ticks[:300])
    for place in range(150, 150 + number):
        samples[place] = replace(samples[place], stamp=ticks[place + 1000])
    path = write(tmp_path / 'bag', samples, received=True)
    assert 'set back' not in findings(path).get('stamp', '')
    assert len(list(SampleStream([path], '/trawl'))) == 300


def test_one_stamp_set_back_for_a_moment_is_no_clock_set_back(tmp_path):
    samples = winch(ticks[:300])
    samples[150] = replace(samples[150], stamp=ticks[100] + 1)
    path = write(tmp_path / 'bag', samples, received=True)
    assert 'set back' not in findings(path).get('stamp', '')
    assert len(list(SampleStream([path], '/trawl'))) == 300
