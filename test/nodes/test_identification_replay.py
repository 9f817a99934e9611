"""Replayed at any rate and in any order, looped, cut or restarted, the answer is the same."""

import signal
from dataclasses import replace

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.bags.samples import SampleStream  # noqa: E402
from trawl_ros.bags.writer import BagWriter  # noqa: E402
from trawl_ros.core.errors import TrawlError  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.estimation.from_gear import identification_for  # noqa: E402
from trawl_ros.estimation.pipeline import WindowUsed  # noqa: E402
from trawl_ros.estimation.windows.records import WindowOptions  # noqa: E402
from trawl_ros.gear.load import load_gear  # noqa: E402
from trawl_ros.lab.running.processes import Processes  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.records.samples import PressureSample, WinchSample  # noqa: E402
from trawl_ros.records.topics import absolute  # noqa: E402

pytestmark = pytest.mark.ros

START = 1000 * SECOND
LEG_S = 60
RULES = {'settle_s': 10.0, 'settle_passages': 0.0, 'window_s': 20.0}
NODE = ['identification_node']


@pytest.fixture(scope='module')
def samples(steady_samples):
    return steady_samples(START, LEG_S)


@pytest.fixture(scope='module')
def bag(samples, steady_tow, tmp_path_factory):
    return steady_tow.write(tmp_path_factory.mktemp('steady') / 'bag', samples)


@pytest.fixture(scope='module')
def offline(bag, coarse_gear):
    """The estimates after each window, by the class that `trawl identify` is made of."""
    identification = identification_for(
        load_gear(coarse_gear), window_options=WindowOptions(**RULES)
    )
    events = [event for _, sample in SampleStream([bag], 'trawl')
              for event in identification.feed(sample)]  # fmt: skip
    found = [event.estimate for event in events if isinstance(event, WindowUsed)]
    assert [estimate.windows for estimate in found] == [1, 2, 3, 4]
    return found


class Replay:
    """A graph of the node, somebody who listens, and bags that are played one after another."""

    def __init__(self, graph, listener_kind, gear, **parameters):
        self.graph = graph
        self.listener = graph.add(listener_kind)
        self.parameters = {'gear': str(gear), 'advise': False, **RULES, **parameters}

    def node(self):
        return self.graph.add(IdentificationNode, **self.parameters)

    @property
    def nodes(self):
        found = self.graph.executor.get_nodes()
        return [node for node in found if isinstance(node, IdentificationNode)]

    def close(self):
        """Forget the data, for ending brings the estimate to rest, which takes a while."""
        for node in self.nodes:
            node._worker.reset()

    def play(self, bag, **parameters):
        parameters = {'rate': 0.0, 'wait_for': NODE, **parameters}
        player = self.graph.add(BagPlayer, bag=str(bag), **parameters)
        self.graph.until(lambda: player.exit_code is not None)
        self.graph.until(lambda: all(node._worker.idle for node in self.nodes))
        self.graph.settle(0.2)
        heard = self.listener
        self.graph.until(lambda: len(heard.estimates) == len(heard.covariances))
        self.graph.remove(player)
        return player.exit_code


@pytest.fixture
def replay(open_graph, estimate_listener, coarse_gear):
    with open_graph() as graph:
        made = []

        def make(**parameters):
            made.append(Replay(graph, estimate_listener, coarse_gear, **parameters))
            return made[-1]

        yield make
        for replay in made:
            replay.close()


def write(path, samples, times):
    """Write a bag of samples with the times (ns) at which they were recorded."""
    with BagWriter(path) as bag:
        for number, (sample, time) in enumerate(zip(samples, times, strict=True)):
            if number % 100 == 99:
                bag.flush()
            topic, message = sample_message(sample)
            bag.write(absolute(topic), message.__msgtype__, serialize(message), time)


def same(listener, expected):
    """Compare what was published after every window."""
    assert len(listener.estimates) == len(listener.covariances) == len(expected)
    for values, covariance, one in zip(
        listener.estimates, listener.covariances, expected, strict=True
    ):
        np.testing.assert_allclose(values, one.values, rtol=0, atol=1e-9)
        np.testing.assert_allclose(covariance, one.covariance, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    'rate', [0.0, *(pytest.param(rate, marks=pytest.mark.slow) for rate in (40.0, 100.0))]
)
def test_at_every_rate_each_window_brings_what_it_brings_offline(replay, bag, offline, rate):
    played = replay()
    played.node()
    assert played.play(bag, rate=rate) == 0
    same(played.listener, offline)


def test_the_order_in_which_topics_arrive_changes_nothing(replay, samples, offline, tmp_path):
    """Doors a second and a half late, the winch after all others, the sonar before them."""

    def arrival(sample):
        if isinstance(sample, WinchSample):
            return sample.stamp + SECOND // 2
        sonar = isinstance(sample, PressureSample) and sample.place == 'sonar'
        return sample.stamp + (0 if sonar else 3 * SECOND // 2)

    arrived = sorted(samples, key=arrival)
    write(tmp_path / 'bag', arrived, map(arrival, arrived))
    played = replay()
    played.node()
    assert played.play(tmp_path / 'bag') == 0
    same(played.listener, offline)


@pytest.mark.slow
def test_a_bag_that_loops_begins_anew_with_the_same_estimates(replay, bag, offline):
    played = replay()
    node = played.node()
    player = played.graph.add(BagPlayer, bag=str(bag), rate=0.0, wait_for=NODE, loop=True)
    played.graph.until(lambda: len(played.listener.estimates) >= 2 * len(offline))
    played.graph.remove(player)
    played.graph.settle(0.2)
    assert node._resets == 1
    del played.listener.estimates[2 * len(offline) :], played.listener.covariances[8:]
    same(played.listener, [*offline, *offline])


def test_a_bag_cut_in_the_middle_gives_what_is_left_of_it(replay, samples, offline, tmp_path):
    write(tmp_path / 'bag', samples, [sample.stamp for sample in samples])
    (whole,) = (tmp_path / 'bag').glob('*.mcap')
    cut = tmp_path / 'cut.mcap'
    cut.write_bytes(whole.read_bytes()[: int(0.6 * whole.stat().st_size)])
    played = replay()
    played.node()
    assert played.play(cut) == 0
    assert 0 < len(played.listener.estimates) < len(offline)
    same(played.listener, offline[: len(played.listener.estimates)])


def test_a_node_ended_in_mid_tow_goes_on_where_it_was(replay, bag, offline, tmp_path):
    played = replay(state=str(tmp_path / 'state'))
    node = played.node()
    played.play(bag, end=LEG_S + 17.5)
    before = len(played.listener.estimates)
    assert before == 2
    # Ending brings the estimate to rest, which must not go into the state.
    played.graph.remove(node)
    played.graph.settle(0.2)
    del played.listener.estimates[before:], played.listener.covariances[before:]
    node = played.node()
    played.graph.until(lambda: len(played.listener.covariances) > before)
    # What it goes on from is told at once.
    same(played.listener, [*offline[:2], offline[1]])
    played.play(bag, start=LEG_S + 17.5)
    same(played.listener, [*offline[:2], offline[1], *offline[2:]])
    assert node._resets == 0


@pytest.mark.slow
def test_a_node_that_is_killed_goes_on_after_its_last_window(replay, bag, offline, tmp_path):
    played = replay(state=str(tmp_path / 'state'))
    graph, listener = played.graph, played.listener
    with Processes(tmp_path / 'log', graph.environment) as processes:
        processes.start('identification_node', **played.parameters)
        player = graph.add(BagPlayer, bag=str(bag), rate=0.0, wait_for=NODE, lead_s=1.0)
        second = START + 50 * SECOND
        graph.until(lambda: player._latest > second)
        player._pause()
        # What was dealt with is saved.
        graph.until(lambda: player._consumers.slowest() > second)
        # Another topic brings what was said of it, and may be slower.
        graph.until(lambda: len(listener.covariances) >= 2)
        process = processes._running.pop('identification_node')
        process.send_signal(signal.SIGKILL)
        process.wait()
    graph.settle(0.2)
    same(listener, offline[:2])
    node = played.node()
    graph.until(lambda: len(listener.covariances) > 2)
    heard = [
        node._listeners[topic].subscription
        for topic in player.subscribers()
        if topic in node._listeners
    ]
    graph.until(lambda: all(one.get_publisher_count() for one in heard))
    graph.settle(1.0)
    player._resume()
    # Not until the player ends: that waits for what the killed one will never acknowledge.
    graph.until(lambda: len(listener.covariances) > 4)
    same(listener, [*offline[:2], offline[1], *offline[2:]])


def test_a_state_of_another_gear_is_refused_at_the_start(replay, bag, offline, tmp_path):
    state = tmp_path / 'state'
    played = replay(state=str(state))
    state.write_text('something else')
    with pytest.raises(TrawlError, match='no undamaged state'):
        played.node()
    assert state.read_text() == 'something else'


def test_a_state_that_cannot_be_written_is_told_and_stops_nothing(replay, bag, offline, tmp_path):
    played = replay(state=str(tmp_path / 'nowhere' / 'state'))
    played.node()
    played.play(bag, end=35.0)
    same(played.listener, offline[:1])
    played.graph.until(lambda: played.listener.report('state').level > 0)
    assert 'nowhere' in played.listener.report('state').message


def test_one_false_stamp_of_the_winch_forgets_nothing(replay, samples, offline, tmp_path):
    wrong, times = [], []
    for sample in samples:
        second = (sample.stamp - START) // SECOND
        if isinstance(sample, WinchSample) and second in (40, 100):
            # Far ahead once, far back once.
            wrong.append(replace(sample, stamp=sample.stamp + (70 - second) * 100 * SECOND))
            times.append(sample.stamp)
        wrong.append(sample)
        times.append(sample.stamp)
    write(tmp_path / 'bag', wrong, times)
    played = replay()
    node = played.node()
    played.play(tmp_path / 'bag')
    assert node._resets == 0
    same(played.listener, offline)
