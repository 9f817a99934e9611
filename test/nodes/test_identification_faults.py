"""Bad input on the topics is said by its reason, in status and diagnostics, and survived."""

import math
from dataclasses import dataclass, replace

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.identification_node import SAMPLES, IdentificationNode  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.records.samples import PressureSample, RangeSample, WinchSample  # noqa: E402

pytestmark = pytest.mark.ros

LEG_S = 48
"""Twice this is what it takes to give up waiting for a channel that has died."""
LATEST = 100_000 * SECOND
AT_ONCE = 60
"""Messages sent before they must have arrived; publishers keep 100."""


class Source(TrawlNode):
    """All instruments in one."""

    def __init__(self, **kwargs):
        super().__init__('source', **kwargs)
        for topic in SAMPLES:
            self.advertise(topic)


class Sea:
    """A node, somebody who listens to it, and a source for it."""

    def __init__(self, graph, listener_kind, gear):
        self.graph = graph
        self.source = graph.add(Source)
        self.listener = graph.add(listener_kind)
        self.node = graph.add(
            IdentificationNode,
            gear=str(gear),
            settle_s=10.0,
            settle_passages=0.0,
            window_s=20.0,
            advise=False,
        )
        heard = [self.node.full_name(topic) for topic in SAMPLES]
        graph.until(lambda: all(self.source.count_subscribers(topic) for topic in heard))
        graph.until(lambda: all(self.source.subscribers()[topic][0] for topic in SAMPLES))
        self.begun = 0

    def received(self):
        counts = self.node.traffic.counts('received')
        return sum(counts[self.node.full_name(topic)] for topic in SAMPLES)

    def tell(self, samples):
        """Send samples; each round is stamped before the last, so that it begins anew."""
        expected = self.received()
        for number, sample in enumerate(samples, start=1):
            self.source.send(*sample_message(sample))
            if number % AT_ONCE == 0:
                self.graph.until(lambda: self.received() >= expected + number)  # noqa: B023
        self.graph.until(lambda: self.received() >= expected + len(samples))
        self.graph.until(lambda: self.node._worker.idle)

    def values(self):
        status = self.listener.status.get('coefficients')
        return status.values if status else {}


@pytest.fixture(scope='module')
def sea(open_graph, estimate_listener, coarse_gear):
    with open_graph() as graph:
        sea = Sea(graph, estimate_listener, coarse_gear)
        yield sea
        sea.node._worker.reset()


@dataclass(frozen=True)
class Fault:
    """A sample becomes those that ``make`` gives for it at a second of the tow."""

    reason: str
    words: str
    make: object


def changed(kind, when=lambda second: True, place=None, **changes):
    def make(sample, second):
        other = place is not None and getattr(sample, 'place', getattr(sample, 'what', '')) != place
        if not isinstance(sample, kind) or other or not when(second):
            return [sample]
        return [
            replace(sample, **{k: v(getattr(sample, k)) if callable(v) else v
                               for k, v in changes.items()})
        ]  # fmt: skip

    return make


def lost(place, when=lambda second: True):
    def make(sample, second):
        gone = getattr(sample, 'what', None) == place and when(second)
        return [] if gone else [sample]

    return make


FAULTS = {
    'NaN': Fault('not finite', 'port_door_depth',
                 changed(PressureSample, lambda t: t % 7 == 0, 'port', pressure=math.nan)),
    'frozen': Fault('frozen', 'door_spread',
                    changed(RangeSample, place='spread', distance=80.0)),
    'feet': Fault('wrong unit', 'feet',
                  changed(RangeSample, place='spread', distance=lambda metres: metres / 0.3048)),
    'out of range': Fault('out of range', 'door_spread',
                          changed(RangeSample, lambda t: t % 9 == 0, 'spread', distance=700.0)),
    'duplicate stamps': Fault('duplicate stamp', '', lambda sample, second: [sample, sample]),
    'a false stamp': Fault('clock jump', '',
                           changed(WinchSample, lambda t: t == 50,
                                   stamp=lambda stamp: stamp + 9000 * SECOND)),
    'dies': Fault('gap', 'door_spread', lost('spread', lambda t: t >= 20)),
    'never comes': Fault('missing channel', 'door_spread', lost('spread')),
}  # fmt: skip


@pytest.mark.parametrize('fault', list(FAULTS))
def test_a_fault_is_told_by_its_reason_and_survived(sea, steady_samples, fault):
    sea.begun += 1
    start = LATEST - sea.begun * 1000 * SECOND
    found = FAULTS[fault]
    sea.tell(
        [
            one
            for sample in steady_samples(start, LEG_S)
            for one in found.make(sample, (sample.stamp - start) // SECOND)
        ]
    )
    assert sea.node._resets == sea.begun - 1
    key = f'rejected {found.reason}'
    sea.graph.until(lambda: key in sea.values())
    assert found.words in sea.values()[f'found {found.reason}']
    sea.graph.until(lambda: (said := sea.listener.report()) and key in said.values)
    assert 'error of the program' not in sea.listener.report().message


def test_two_sources_that_one_publisher_passes_on_are_told_and_not_used(sea, steady_samples):
    sea.begun += 1
    start = LATEST - sea.begun * 1000 * SECOND
    told = []
    for sample in steady_samples(start, LEG_S):
        told.append(sample)
        if isinstance(sample, WinchSample) and (sample.stamp - start) // SECOND % 3 == 0:
            wrong = tuple(1.15 * tension for tension in sample.tensions)
            told.append(replace(sample, stamp=sample.stamp + SECOND // 3, tensions=wrong))
    sea.tell(told)
    topic = sea.node.full_name('winch/joint_states')
    assert sea.node.traffic.counts('refused')[topic] > LEG_S
    sea.graph.until(lambda: 'has two sources' in sea.node.all_statuses()[0].message)
    assert sea.node.all_statuses()[0].level != 0


def test_after_all_that_a_sound_tow_is_estimated(sea, steady_samples):
    sea.begun += 1
    sea.tell(steady_samples(LATEST - sea.begun * 1000 * SECOND, LEG_S))
    sea.graph.until(lambda: sea.values().get('windows') == '3')
    # Diagnostics come once a second, so the last of them may still be of the tow before.
    sea.graph.until(lambda: sea.listener.report().values.get('windows') == '3')
    assert sea.listener.report().level == 0
