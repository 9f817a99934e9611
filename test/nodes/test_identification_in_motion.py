"""All of the tow at any rate, looped, cut or restarted: each half minute as by the class."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.api.trials import identify  # noqa: E402
from trawl_ros.bags.samples import SampleStream  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.estimation import bag_motion, live_motion  # noqa: E402
from trawl_ros.estimation.from_gear import identification_for  # noqa: E402
from trawl_ros.estimation.motion import tracking  # noqa: E402
from trawl_ros.estimation.motion.fit_records import MotionOptions  # noqa: E402
from trawl_ros.gear.load import load_gear  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.identification_node import FINISH, IdentificationNode  # noqa: E402
from trawl_ros.nodes.workers.motion_learner import AT_END, BEFORE, ENDED, MotionLearner  # noqa: E402
from trawl_ros.records.topics import NAMESPACE  # noqa: E402

pytestmark = pytest.mark.ros

START = 1000 * SECOND
MINUTES = 12
NODE = ['identification_node']


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Errors of the size that is stated, towed along again at once; any step is rest at the end."""
    monkeypatch.setattr(tracking, 'AHEAD', 60)
    options = partial(MotionOptions, estimate_sizes=False)
    monkeypatch.setattr(live_motion, 'MotionOptions', options)
    at_end = partial(options, iterations=1, tolerance=np.inf)
    monkeypatch.setattr(bag_motion, 'MotionOptions', at_end)


@pytest.fixture(scope='module')
def samples(steady_tow):
    """Minutes in one steady state, of which the model is the plant."""
    still = replace(steady_tow, states=steady_tow.states[:1])
    return list(still.samples(start=START, leg_s=60 * MINUTES))


@pytest.fixture(scope='module')
def bag(steady_tow, samples, tmp_path_factory):
    return steady_tow.write(tmp_path_factory.mktemp('still') / 'bag', samples)


@pytest.fixture
def expected(bag, coarse_gear):
    """What is told while the bag is read, by the classes that the node is made of."""
    gear = load_gear(coarse_gear)
    identification, motion, told = identification_for(gear), MotionLearner(gear), []
    for _, sample in SampleStream([bag], NAMESPACE):
        identification.feed(sample)
        windows = identification.estimate
        motion.feed(sample, windows)
        newest = motion.knowledge.estimate or windows
        if newest is not None and (not told or told[-1] is not newest):
            told.append(newest)
    assert sum('where the model was towed' in estimate.reason for estimate in told) >= 2
    return told


@pytest.fixture
def replay(open_graph, estimate_listener, coarse_gear):
    """Give a function that starts the node, and plays bags to it one after another."""
    with open_graph() as graph:

        def start(*plays, **parameters):
            node = graph.add(IdentificationNode, gear=str(coarse_gear), advise=False, **parameters)
            listener = graph.add(estimate_listener)
            for play in plays:
                player = graph.add(BagPlayer, **{'rate': 0.0, 'wait_for': NODE, **play})
                graph.until(lambda player=player: player.exit_code is not None, timeout_s=120.0)
                graph.until(lambda: node._worker.idle, timeout_s=60.0)
                graph.settle(0.2)
                graph.remove(player)
            return graph, node, listener

        yield start
        for node in graph.executor.get_nodes():
            if isinstance(node, IdentificationNode):
                # Ended with data it would bring these to rest.
                node._worker.reset()


def same(listener, expected):
    assert len(listener.estimates) == len(listener.covariances) == len(expected)
    for values, covariance, one in zip(
        listener.estimates, listener.covariances, expected, strict=True
    ):
        np.testing.assert_allclose(values, one.values, rtol=0, atol=1e-9)
        np.testing.assert_allclose(covariance, one.covariance, rtol=0, atol=1e-9)


@pytest.mark.parametrize('rate', [0.0, pytest.param(60.0, marks=pytest.mark.slow)])
def test_each_half_minute_is_told_and_the_end_is_what_identify_gives(
    replay, bag, expected, coarse_gear, tmp_path, rate
):
    graph, _, listener = replay({'bag': str(bag), 'rate': rate}, output=str(tmp_path / 'out'))
    same(listener, expected)
    told, whole = (listener.status[name].values for name in ('coefficients', 'all of the tow'))
    assert told['learned from'] == 'all of the tow'
    assert float(told['minutes']) == float(whole['minutes']) >= MINUTES - 6.0
    assert int(told['windows']) >= 1
    for name in ('a1', 'c4'):
        assert float(told[name]) == pytest.approx(float(whole[name]))
        assert float(whole[f'{name} std by windows']) > 0.0
    number = len(listener.estimates)
    answer = graph.call(FINISH)
    assert answer.success, answer.message
    assert 'min of tow' in answer.message
    graph.until(lambda: len(listener.covariances) > number)
    offline = identify([bag], gear=str(coarse_gear), motion=True)
    assert offline.chain is not None, offline.chain_refused
    np.testing.assert_allclose(listener.estimates[-1], offline.estimate.values, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        listener.covariances[-1], offline.estimate.covariance, rtol=0, atol=1e-9
    )
    assert listener.status['all of the tow'].values['whole'] == 'true'
    assert '"chain"' in (tmp_path / 'out' / 'identification.json').read_text()


@pytest.mark.slow
def test_a_bag_that_loops_begins_anew_with_the_same_estimates(replay, bag, expected):
    _, node, listener = replay({'bag': str(bag)}, {'bag': str(bag)})
    assert node._resets == 1
    same(listener, [*expected, *expected])


@pytest.mark.slow
def test_of_a_bag_that_is_cut_what_is_left_is_told(replay, steady_tow, samples, expected, tmp_path):
    early = [sample for sample in samples if sample.stamp < START + 60 * (MINUTES - 2) * SECOND]
    (whole,) = steady_tow.write(tmp_path / 'early', early).glob('*.mcap')
    cut = tmp_path / 'cut.mcap'
    # Without its end the file has no summary of what is in it.
    cut.write_bytes(whole.read_bytes()[:-1000])
    _, _, listener = replay({'bag': str(cut)})
    assert 0 < len(listener.estimates) < len(expected)
    same(listener, expected[: len(listener.estimates)])


@pytest.mark.slow
def test_a_node_that_is_restarted_says_what_it_does_not_know_and_keeps_its_windows(
    replay, bag, tmp_path
):
    state = str(tmp_path / 'state')
    graph, node, listener = replay({'bag': str(bag), 'end': 500.0}, state=state)
    assert 'lost' not in listener.status['all of the tow'].values
    windows = int(listener.status['coefficients'].values['windows'])
    assert windows > 0
    graph.remove(node)
    graph.remove(listener)
    _, node, listener = replay({'bag': str(bag), 'start': 500.0}, state=state)
    assert listener.status['all of the tow'].values['lost'] == BEFORE
    assert listener.status['coefficients'].values['learned from'] == 'steady windows'
    assert int(listener.status['coefficients'].values['windows']) == windows


@pytest.mark.slow
def test_the_signal_to_end_waits_for_no_fit_of_all_of_the_tow(replay, bag, tmp_path):
    graph, node, listener = replay({'bag': str(bag), 'end': 400.0}, output=str(tmp_path / 'out'))
    assert listener.status['all of the tow'].values['used'] == 'false'
    graph.remove(node)
    assert ENDED in (tmp_path / 'out' / 'identification.json').read_text()


def test_without_its_prior_all_of_the_tow_is_not_learned_from_and_that_is_told(replay, bag):
    graph, _, listener = replay({'bag': str(bag), 'end': 5.0}, prior=False)
    graph.until(lambda: 'the prior of the gear file' in listener.report('motion').message)


def test_without_motion_the_steady_parts_are_fitted_at_the_end_as_identify_does(
    replay, bag, coarse_gear
):
    graph, _, listener = replay({'bag': str(bag), 'rate': 0.0}, motion=False)
    assert AT_END in listener.report('motion').message
    assert listener.status['coefficients'].values['learned from'] == 'steady windows'
    number = len(listener.covariances)
    answer = graph.call(FINISH)
    assert answer.success, answer.message
    graph.until(lambda: len(listener.covariances) > number)
    assert listener.status['coefficients'].values['learned from'] == 'steady parts'
    offline = identify([bag], gear=str(coarse_gear), motion=False)
    assert offline.chain is not None, offline.chain_refused
    values, covariance = offline.estimate.values, offline.estimate.covariance
    np.testing.assert_allclose(listener.estimates[-1], values, rtol=0, atol=1e-9)
    np.testing.assert_allclose(listener.covariances[-1], covariance, rtol=0, atol=1e-9)
