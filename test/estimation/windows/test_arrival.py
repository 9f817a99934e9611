"""Windows come in time, and are the same however topics arrive."""

import random
from dataclasses import replace

import pytest

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.resources import share_path
from trawl_ros.estimation.windows.finder import SteadyWindowFinder
from trawl_ros.estimation.windows.records import SteadyWindow, WindowOptions
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.model.water import Water
from trawl_ros.records.samples import AttitudeSample, RangeSample
from trawl_ros.records.topics import NAMESPACE

SHORT = WindowOptions(settle_s=120.0, settle_passages=0.0)
SECOND = 1_000_000_000


def found_in(samples, depth, options=SHORT):
    """What is decided, all counts, and by how much (s) each window is decided after its end."""
    finder = SteadyWindowFinder(depth, options)
    items, lateness, now = [], [], 0
    for sample in samples:
        now = max(now, sample.stamp)
        for item in finder.feed(sample):
            items.append(item)
            if isinstance(item, SteadyWindow):
                lateness.append((now - item.end_ns) / SECOND)
    return items + finder.finish(), finder.rejected, lateness


def windows(items):
    return [item for item in items if isinstance(item, SteadyWindow)]


@pytest.fixture(scope='module')
def faulty(clean_tow):
    """A tow with silences, doubled messages and a false stamp, in the order of its stamps."""
    rng = random.Random(0)
    first = clean_tow.samples[0].stamp
    samples = []
    for sample in clean_tow.samples:
        second = (sample.stamp - first) // SECOND
        if isinstance(sample, RangeSample) and sample.what == 'spread' and 250 < second < 300:
            continue
        if isinstance(sample, AttitudeSample) and second > 330 and sample.side == 'port':
            continue
        if 400 < second < 435:
            continue
        samples.append(sample)
        if rng.random() < 0.01:
            samples.append(sample)
    samples[4000] = replace(samples[4000], stamp=samples[4000].stamp + 9000 * SECOND)
    return samples


def by_topic(samples):
    topics = {}
    for sample in samples:
        topics.setdefault(sample_message(sample)[0], []).append(sample)
    return topics


@pytest.mark.parametrize('seed', range(4))
def test_topics_that_lag_each_other_change_nothing(clean_tow, faulty, seed):
    rng = random.Random(seed)
    lag = {topic: rng.uniform(0.0, 25.0) * SECOND for topic in by_topic(faulty)}
    arrival = [sample.stamp + lag[sample_message(sample)[0]] for sample in faulty]
    order = sorted(range(len(faulty)), key=lambda i: arrival[i])
    straight = found_in(faulty, clean_tow.depth)
    assert len(windows(straight[0])) >= 2
    assert found_in([faulty[i] for i in order], clean_tow.depth)[:2] == straight[:2]


@pytest.mark.parametrize('chunk_s', [3, 25])
def test_topic_by_topic_in_chunks_is_the_same(clean_tow, faulty, chunk_s):
    rng = random.Random(chunk_s)
    first, last = faulty[0].stamp, clean_tow.samples[-1].stamp
    topics = by_topic(faulty)
    queues = {topic: list(reversed(samples)) for topic, samples in topics.items()}
    chunks = []
    for end in range(first + chunk_s * SECOND, last + 2 * chunk_s * SECOND, chunk_s * SECOND):
        for topic in rng.sample(sorted(topics), len(topics)):
            queue = queues[topic]
            # A false stamp comes when it was sent.
            while queue and (queue[-1].stamp < end or queue[-1].stamp > last):
                chunks.append(queue.pop())
    assert len(chunks) == len(faulty)
    assert found_in(chunks, clean_tow.depth)[:2] == found_in(faulty, clean_tow.depth)[:2]


def test_default_instruments_decide_a_window_within_a_second_of_its_end():
    """In the sample trial, whose messages come in the order in which they were sent."""
    depth, lateness = Water().depth, []
    finder, now = SteadyWindowFinder(depth), 0
    for _, sample in SampleStream([share_path('bags', 'sea_trial')], NAMESPACE):
        now = max(now, sample.stamp)
        for item in finder.feed(sample):
            if isinstance(item, SteadyWindow):
                assert 'vertical_opening' in item.means
                lateness.append((now - item.end_ns) / SECOND)
        if len(lateness) == 3:
            break
    assert max(lateness) <= 1.0


def test_a_channel_that_has_died_is_waited_for_once(clean_tow):
    first = clean_tow.samples[0].stamp
    samples = [
        sample for sample in clean_tow.samples
        if not isinstance(sample, AttitudeSample) or sample.stamp < first + 150 * SECOND
    ]  # fmt: skip
    _, rejected, lateness = found_in(samples, clean_tow.depth)
    assert rejected['gap'] > 0
    assert len(lateness) == 3
    assert lateness[0] <= SHORT.patience_s + 10.0
    assert max(lateness[1:]) <= 1.0


def test_a_pause_of_all_topics_costs_nothing_but_the_pause(clean_tow):
    """Probation is for channels that others went on without."""
    late = [replace(s, stamp=s.stamp + 4000 * SECOND) for s in clean_tow.samples]
    items, rejected, _ = found_in([*clean_tow.samples, *late], clean_tow.depth)
    assert len(windows(items)) == 2 * len(windows(found_in(late, clean_tow.depth)[0]))
    assert rejected['silence'] == rejected['late'] == rejected['clock jump'] == 0


def test_tows_are_counted_by_long_gaps_and_by_call(clean_tow):
    finder = SteadyWindowFinder(clean_tow.depth, SHORT)
    later = [replace(s, stamp=s.stamp + 4000 * SECOND) for s in clean_tow.samples]
    assert finder.next_tow() == []
    items = [item for sample in clean_tow.samples for item in finder.feed(sample)]
    items += [item for sample in later for item in finder.feed(sample)]
    items += finder.next_tow()
    # The next bag may have any clock, an earlier one too.
    items += [item for sample in clean_tow.samples for item in finder.feed(sample)]
    items += finder.finish()
    steady = windows(items)
    assert [window.tow for window in steady] == [0] * 3 + [1] * 3 + [2] * 3
    assert [window.index for window in steady] == list(range(9))
    assert [window.state for window in steady] == list(range(9))
    assert finder.rejected['clock jump'] == 0
