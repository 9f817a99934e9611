"""`identification_node` estimates as windows come, says why when it cannot, and starts anew."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.bags.logs.import_log import import_log  # noqa: E402
from trawl_ros.bags.writer import BagWriter  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.instruments.errors.instrument import SeedPlan  # noqa: E402
from trawl_ros.instruments.parameters import load_instruments  # noqa: E402
from trawl_ros.instruments.suite import InstrumentSuite  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.diagnostics import ERROR, WARN  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.records.coefficients import COEFFICIENTS  # noqa: E402
from trawl_ros.records.surroundings import Surroundings  # noqa: E402
from trawl_ros.records.topics import absolute  # noqa: E402
from trawl_ros.simulation.command import Command  # noqa: E402
from trawl_ros.simulation.simulation import Simulation  # noqa: E402

pytestmark = pytest.mark.ros

ROOT = Path(__file__).parents[2]
HAUL_LOG = ROOT.parent / 'shared/data/noaa_trawlmetrics/gear_testing_2026_haul_log.csv'
HAUL_MAPPING = ROOT / 'config/logs/door_test_haul_log.yaml'

SETTLE_S, WINDOW_S = 10.0, 30.0
LENGTH_S = 62
"""One window's worth of steady towing, and as much more as late readings may take."""


@pytest.fixture(scope='module')
def steady_bag(default_model, tmp_path_factory):
    """Instruments that look at one steady state of the gear for a while."""
    # The sonar does not read the mouth of the coarse net.
    model = default_model
    truth = Simulation(model, Command(400.0, 400.0, 2.1)).truth()
    suite = InstrumentSuite(
        load_instruments(), surroundings=Surroundings(model.water.pressure), draws=SeedPlan(seed=3)
    )
    path = tmp_path_factory.mktemp('steady') / 'bag'
    with BagWriter(path) as bag:
        for number in range(10 * LENGTH_S):
            stamp = 1000 * SECOND + number * SECOND // 10
            for sample in suite.observe(replace(truth, stamp=stamp)):
                topic, message = sample_message(sample)
                bag.write(absolute(topic), message.__msgtype__, serialize(message), stamp)
    return path


@pytest.fixture(scope='module')
def session(open_graph, steady_bag, gear_path, estimate_listener, tmp_path_factory):
    """One identification from the first sample to the report, looked at on the way."""

    class Session:
        output = tmp_path_factory.mktemp('identified') / 'results'

    with open_graph() as graph:
        node = graph.add(
            IdentificationNode,
            gear=str(gear_path),
            settle_s=SETTLE_S,
            settle_passages=0.0,
            window_s=WINDOW_S,
            advise_share=0.5,
            output=str(Session.output),
        )
        listener = graph.add(estimate_listener)
        graph.until(lambda: listener.report() is not None)
        Session.before = listener.report()
        follower = ['identification_node']
        player = graph.add(BagPlayer, bag=str(steady_bag), rate=0.0, wait_for=follower)
        graph.until(lambda: player.exit_code is not None)
        graph.until(lambda: listener.innovations)
        graph.until(lambda: node._worker.idle)
        graph.until(lambda: listener.status['next manoeuvre'].values)
        graph.settle()
        Session.first_status = listener.status
        Session.before_finish = listener.estimates[-1]
        late = graph.add(partial(estimate_listener, 'late'))
        graph.until(lambda: late.estimates and late.covariances and late.summaries)
        Session.listener, Session.late = listener, late
        Session.answer = graph.call('identification/finish')
        graph.until(lambda: len(listener.estimates) > 1)
        Session.resets_before = node._resets
        graph.remove(player)
        again = graph.add(BagPlayer, bag=str(steady_bag), rate=0.0, wait_for=follower)
        graph.until(lambda: again.exit_code is not None)
        graph.until(lambda: len(listener.innovations) > 1)
        graph.settle()
        Session.resets_after = node._resets
        Session.last_status = listener.status['coefficients']
    return Session


def test_before_any_sample_it_says_what_is_needed(session):
    assert session.before.level == WARN
    assert 'no readings on winch/joint_states, ' in session.before.message


def test_a_window_brings_estimate_covariance_status_and_innovation(session):
    values = session.listener.estimates[0]
    covariance = session.listener.covariances[0]
    assert values.shape == (12,)
    np.testing.assert_allclose(covariance, covariance.T)
    assert np.all(np.linalg.eigvalsh(covariance) > 0.0)
    status = session.first_status['coefficients']
    assert status.values['windows'] == '1'
    for name, value in zip(COEFFICIENTS, values, strict=True):
        assert float(status.values[name]) == pytest.approx(value, rel=1e-6)
        low, high = (float(status.values[f'{name} {end}']) for end in ('low', 'high'))
        assert low <= value <= high
    channels = {item.channel for item in session.listener.innovations[0]}
    assert {'door_spread', 'net_depth', 'port_tension'} <= channels


def test_the_status_says_how_well_each_coefficient_is_known_and_what_is_not(session):
    values = session.first_status['coefficients'].values
    # Data narrow what the prior says, by nothing at worst; a misfit widens all of it.
    misfit = float(session.first_status['instruments'].values['misfit'])
    for name in COEFFICIENTS:
        assert 1.0 - 1.001 * misfit <= float(values[f'{name} shrink']) <= 1.0
        assert values[f'{name} determined'] in ('true', 'false')
    assert float(values['condition number']) > 1.0
    # One window cannot tell twelve coefficients apart.
    assert values['undetermined']
    assert values['converged'] == 'false'
    assert values['reason']


def test_the_status_says_what_each_channel_and_instrument_is_worth(session):
    channels = session.first_status['channels'].values
    seen = session.listener.innovations[0]
    for one in seen:
        assert float(channels[f'{one.channel} test ratio']) == pytest.approx(one.ratio, rel=1e-3)
        assert channels[f'{one.channel} whiteness'] == 'too few windows'
    assert int(channels['port_tension accepted']) > 40
    instruments = session.first_status['instruments'].values
    assert float(instruments['noise scale tension']) > 0.0
    assert instruments['tow 1 port_tension bias'].endswith(' N')


def test_the_next_manoeuvre_comes_with_what_it_would_teach(session):
    values = session.first_status['next manoeuvre'].values
    assert float(values['gain']) > 0.0
    assert 0.0 < float(values['looked up']) <= 1.0
    assert float(values['port_warp']) >= 100.0
    assert float(values['minutes']) > 0.0


def test_who_comes_late_gets_the_latest_estimate(session):
    assert len(session.late.estimates) >= 1
    np.testing.assert_array_equal(session.late.estimates[0], session.before_finish)


def test_finishing_writes_the_report(session):
    assert session.answer.success, session.answer.message
    written = json.loads((session.output / 'identification.json').read_text())
    assert written['windows'] == 1
    assert set(written['coefficients']) == set(COEFFICIENTS)


def test_stamps_that_go_back_start_it_anew(session):
    assert session.resets_after > session.resets_before
    assert session.last_status.values['windows'] == '1'
    assert session.last_status.values['revision'] == '1'


def test_measurements_at_sea_without_speed_and_spread_are_not_enough(
    open_graph, estimate_listener, tmp_path
):
    if not HAUL_LOG.exists():
        pytest.skip(f'the measured log is not here: {HAUL_LOG.name}')
    bag = tmp_path / 'hauls'
    import_log(HAUL_LOG, HAUL_MAPPING, bag)
    with open_graph() as graph:
        graph.add(IdentificationNode)
        listener = graph.add(estimate_listener)
        player = graph.add(BagPlayer, bag=str(bag), rate=0.0, wait_for=['identification_node'])
        graph.until(lambda: player.exit_code is not None)
        assert player.exit_code == 0
        answer = graph.call('identification/finish')
        assert not answer.success
        graph.until(lambda: listener.report() is not None and listener.report().level == ERROR)
        assert not listener.estimates
    for words in (
        'no readings on ',
        'vessel/velocity_water',
        'door/spread',
        # Half hours apart, no stamp is borne out by others.
        'none usable of 104 of port_tension',
    ):
        assert words in answer.message
