"""Several bags are one stream of samples, and what cannot be used is said."""

import itertools

import numpy as np
import pytest

from trawl_ros.bags.samples import SampleStream
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.estimation.windows.finder import SteadyWindowFinder
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.model.water import Water
from trawl_ros.records.samples import VelocitySample, WinchSample
from trawl_ros.records.topics import NAMESPACE, WINCH_NAMES, absolute

SECOND = 1_000_000_000


def windows(stream):
    finder = SteadyWindowFinder(Water().depth)
    found = [item for _, sample in stream for item in finder.feed(sample)] + finder.finish()
    assert finder.rejected['out of order'] == 0
    return [item for item in found if isinstance(item, SteadyWindow)]


def test_tows_whose_clocks_overlap_follow_each_other(steady_tow, tmp_path):
    bags = [steady_tow.bag(tmp_path / f'bag{seed}', seed=seed) for seed in range(2)]
    alone = windows(SampleStream(bags[:1], NAMESPACE))
    together = windows(SampleStream(bags, NAMESPACE))
    assert len(alone) >= 2
    assert len(together) == 2 * len(alone)
    starts = [window.start_ns for window in together]
    assert starts == sorted(starts)


def test_tows_that_follow_each_other_keep_their_stamps(steady_tow, tmp_path):
    first = steady_tow.bag(tmp_path / 'first', leg_s=5)
    second = steady_tow.bag(tmp_path / 'second', leg_s=5, start=100 * SECOND)
    stamps = [sample.stamp for _, sample in SampleStream([first, second], NAMESPACE)]
    assert stamps[0] == 0
    assert stamps[-1] == 109 * SECOND
    assert stamps == sorted(stamps)


def test_each_sample_comes_with_its_bag(steady_tow, tmp_path):
    bags = [steady_tow.bag(tmp_path / name, leg_s=3) for name in 'ab']
    found = [path for path, _ in SampleStream(bags, NAMESPACE)]
    assert [path for path, _ in itertools.groupby(found)] == bags


def test_messages_that_contradict_their_topic_are_left_out_and_said(tmp_path):
    good = WinchSample(SECOND, (1.0, 1.0), (0.0, 0.0), (2.0, 2.0))
    with BagWriter(tmp_path / 'bag') as bag:
        for number, names in enumerate((list(WINCH_NAMES), ['left', 'right'], ['left', 'right'])):
            topic, message = sample_message(good)
            message.name = names
            bag.write(absolute(topic), message.__msgtype__, serialize(message), number)
    stream = SampleStream([tmp_path / 'bag'], NAMESPACE)
    assert len(list(stream)) == 1
    (problem,) = stream.problems
    assert problem.startswith(f'{tmp_path / "bag"}: 2 messages')
    assert 'winch/joint_states: no port_warp' in problem


def test_topics_of_others_are_passed_over(steady_tow, tmp_path):
    velocity = VelocitySample(SECOND, 'water', np.array([2.0, 0.0, 0.0]), 0.0)
    bag = steady_tow.write(tmp_path / 'bag', [velocity])
    assert len(list(SampleStream([bag], NAMESPACE))) == 1
    with pytest.raises(BagError, match='expected --namespace trawl'):
        list(SampleStream([bag], 'elsewhere'))
