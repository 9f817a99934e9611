"""A source waits for its consumers, but never for one that can no longer come to where it is."""

import time

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.limits import Limit  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.stamps import header  # noqa: E402
from trawl_ros.nodes.runtime import credit  # noqa: E402
from trawl_ros.nodes.runtime.credit import HEADER, SYNC, ConsumerProgress, Consumers  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402

pytestmark = pytest.mark.ros

WALL_CLOCK = 1_700_000_000 * SECOND
"""Stamps of a source that does not publish a clock."""


class Source(TrawlNode):
    """Has come to 60 s after its beginning, and needs `needed`."""

    def __init__(self, **kwargs):
        super().__init__('source', **kwargs)
        self.consumers = Consumers(self, ['needed'])


class Reporter(TrawlNode):
    """Reports for any consumer, so that one node plays all."""

    def __init__(self, **kwargs):
        super().__init__('reporter', **kwargs)
        self.advertise(SYNC, HEADER)

    def report(self, name, stamp):
        self.send(SYNC, header(stamp, name))


@pytest.fixture(scope='module')
def graph(open_graph):
    with open_graph() as graph:
        yield graph


@pytest.fixture(scope='module')
def nodes(graph):
    source, reporter = graph.add(Source), graph.add(Reporter)
    graph.until(lambda: reporter._senders[SYNC].get_subscription_count() == 1)
    return source, reporter


@pytest.fixture(params=[0, WALL_CLOCK], ids=['simulated time', 'time of the wall'])
def begin(request):
    return request.param


@pytest.fixture
def source(nodes, begin):
    source, _ = nodes
    source.consumers._heard.clear()
    source.consumers.begin(begin)
    source.consumers.sent(begin + 60 * SECOND)
    return source


@pytest.fixture
def report(graph, nodes, source):
    """Report for a consumer and wait until the source has heard it."""
    _, reporter = nodes

    def say(name, stamp):
        before = source.traffic.total('received')
        reporter.report(name, stamp)
        graph.until(lambda: source.traffic.total('received') > before)

    return say


def test_the_needed_count_from_the_beginning(source, report, begin):
    report('needed', 0)
    assert source.consumers.slowest() == begin
    report('needed', begin + 58 * SECOND)
    assert source.consumers.slowest() == begin + 58 * SECOND


def test_who_joins_late_is_waited_for_once_something_has_reached_it(source, report, begin):
    report('needed', begin + 59 * SECOND)
    report('late', 0)
    assert source.consumers.slowest() == begin + 59 * SECOND
    report('late', begin + 57 * SECOND)
    assert source.consumers.slowest() == begin + 57 * SECOND


def test_who_was_started_anew_is_not_waited_for_where_it_left_off(source, report, begin):
    report('needed', begin + 50 * SECOND)
    report('needed', 0)
    assert source.consumers.slowest() is None
    assert not source.consumers.missing()
    report('needed', begin + 60 * SECOND)
    assert source.consumers.slowest() == begin + 60 * SECOND


def test_who_is_silent_for_long_is_missing_and_not_waited_for(graph, source, report, begin,
                                                              monkeypatch):  # fmt: skip
    report('needed', begin + 50 * SECOND)
    assert source.consumers.slowest() == begin + 50 * SECOND
    monkeypatch.setattr(credit, 'SILENT_S', 0.2)
    graph.until(lambda: source.consumers.missing() == ['needed'])
    assert source.consumers.slowest() is None
    monkeypatch.undo()
    report('needed', begin + 51 * SECOND)
    assert source.consumers.slowest() == begin + 51 * SECOND


def test_progress_from_before_the_beginning_is_worth_nothing(source, report, begin):
    report('needed', begin + 61 * SECOND)
    assert source.consumers.slowest() == begin


def test_who_does_not_get_on_is_waited_for_for_a_while_and_again_once_it_does(
    source, report, begin, monkeypatch
):
    report('needed', begin + 50 * SECOND)
    assert source.consumers.followed(begin + 50 * SECOND)
    assert not source.consumers.followed(begin + 55 * SECOND)
    assert not source.consumers.stalled()
    monkeypatch.setattr(credit, 'STALLED_S', 0.0)
    assert source.consumers.stalled() == ['needed']
    assert source.consumers.followed(begin + 55 * SECOND)
    report('needed', begin + 50 * SECOND)
    assert source.consumers.stalled() == ['needed']
    report('needed', begin + 51 * SECOND)
    assert not source.consumers.stalled()
    assert not source.consumers.followed(begin + 55 * SECOND)


class Clock:
    """Clock of the wall that a test puts forward."""

    def __init__(self, monkeypatch):
        self.ahead = 0.0
        real = time.monotonic
        monkeypatch.setattr(credit.time, 'monotonic', lambda: real() + self.ahead)


def _span_of_a_creeping_consumer(source, report, begin, clock, step_ns):
    """Data time (s) that a source comes on in 20 min, each 5 s of which a consumer gains a step."""
    consumers = source.consumers
    stamp = latest = begin + 60 * SECOND
    report('needed', stamp)
    for _ in range(240):
        clock.ahead += 5.0
        stamp += step_ns
        report('needed', min(stamp, latest))
        # The source asks at each of its ticks, with a lead of 3 s.
        for _ in range(50):
            if not consumers.followed(latest - 3 * SECOND):
                break
            latest += SECOND // 10
            consumers.sent(latest)
    return (latest - begin) / SECOND - 60.0


@pytest.mark.parametrize('step_ns', [1, SECOND // 1000, SECOND // 100])
def test_a_stamp_that_creeps_on_does_not_stop_a_source(source, report, begin, monkeypatch, step_ns):
    clock = Clock(monkeypatch)
    assert _span_of_a_creeping_consumer(source, report, begin, clock, step_ns) > 60.0
    assert source.consumers.stalled() == ['needed']


def test_a_consumer_that_is_slow_is_waited_for_throughout(source, report, begin, monkeypatch):
    clock = Clock(monkeypatch)
    gone = _span_of_a_creeping_consumer(source, report, begin, clock, SECOND)
    assert gone == pytest.approx(240.0, abs=5.0)
    assert not source.consumers.stalled()


def test_who_is_waited_for_is_named(source, report, begin, monkeypatch):
    clock = Clock(monkeypatch)
    report('needed', begin + 50 * SECOND)
    assert not source.consumers.followed(begin + 55 * SECOND)
    assert not source.consumers.waited_for()
    clock.ahead += 40.0
    report('needed', begin + 50 * SECOND)
    assert source.consumers.waited_for() == ['needed']
    clock.ahead += 100.0
    report('needed', begin + 50 * SECOND)
    assert not source.consumers.waited_for()
    assert source.consumers.stalled() == ['needed']


def test_old_progress_takes_nothing_back(source, report, begin):
    report('needed', begin + 59 * SECOND)
    report('needed', begin + 2 * SECOND)
    assert source.consumers.slowest() == begin + 59 * SECOND


def test_names_that_never_end_are_not_kept(source, report, begin, monkeypatch):
    monkeypatch.setattr(credit, 'CONSUMERS', Limit(2, '', ''))
    for number in range(5):
        report(f'consumer {number}', begin + SECOND)
    assert len(source.consumers._heard) <= 2


def test_invented_names_lock_nobody_out(source, report, begin, monkeypatch):
    monkeypatch.setattr(credit, 'CONSUMERS', Limit(2, '', ''))
    for name in ('invented 1', 'invented 2', 'reporter', 'invented 3', 'needed'):
        report(name, begin + 57 * SECOND)
    assert {'reporter', 'needed'} <= source.consumers._heard.keys()
    assert not source.consumers.missing()


def test_who_fell_silent_makes_room(source, report, begin, monkeypatch):
    monkeypatch.setattr(credit, 'CONSUMERS', Limit(1, '', ''))
    clock = Clock(monkeypatch)
    report('source', begin + SECOND)
    report('reporter', begin + SECOND)
    clock.ahead += 2 * credit.SILENT_S
    report('late', begin + SECOND)
    assert list(source.consumers._heard) == ['late']


class Follower(TrawlNode):
    """Deals with what another consumer sends."""

    def __init__(self, **kwargs):
        super().__init__('follower', **kwargs)
        self.progress = ConsumerProgress(self, idle=lambda: self.idle)
        self.time = 5 * SECOND
        self.idle = False

    def now(self):
        return self.time


def test_who_follows_a_consumer_that_fell_silent_comes_as_far_as_the_clock(graph):
    follower = graph.add(Follower)
    graph.rest(1.5 * credit.IDLE_S)
    assert follower.progress.stamp == credit.NOTHING, 'it has not begun'
    follower.progress.done(3 * SECOND)
    graph.rest(1.5 * credit.IDLE_S)
    assert follower.progress.stamp == 3 * SECOND, 'it is still busy'
    follower.idle = True
    graph.until(lambda: follower.progress.stamp == 5 * SECOND)
    graph.remove(follower)
