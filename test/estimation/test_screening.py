"""Wrong units are told by the gear's own model, and a sound tow is never accused."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.screening import Screening
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.estimation.windows.unit_errors import plausible_unit
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

LENGTH, SPEED = 500.0, 2.0


@pytest.fixture(scope='module')
def known(coarse_gear):
    """Model, prior, and a window of boards that are not what the gear file says."""
    gear = load_gear(coarse_gear)
    predictor, prior = Predictor(build_model(gear)), board_prior(gear)
    signs = np.where(np.arange(12) % 2, 0.5, -0.5)
    seen = predictor.predict(prior.start + signs * prior.std, LENGTH, LENGTH, SPEED)
    means = {name: seen.values[OBSERVABLES.index(name)] for name in MEASURED}
    means |= {'port_length': LENGTH, 'starboard_length': LENGTH, 'speed': SPEED}
    window = SteadyWindow(
        index=0,
        state=0,
        start_ns=0,
        end_ns=1,
        means=means,
        noise=dict.fromkeys(means, 0.0),
        bias={name: CHANNELS[name].bias_std(mean) for name, mean in means.items()},
        counts=dict.fromkeys(means, 60),
    )
    return predictor, prior, window


def judged(known, names=(), factor=1.0):
    predictor, prior, window = known
    means = {name: m * factor if name in names else m for name, m in window.means.items()}
    screening = Screening(predictor, prior, OBSERVABLES)
    return screening.judge(replace(window, means=means), prior.start)


def test_other_boards_are_no_fault(known):
    assert judged(known).found is None


@pytest.mark.parametrize(
    ('names', 'factor', 'unit'),
    [
        (('port_length', 'starboard_length'), 3.28084, 'feet'),
        (('port_length', 'starboard_length'), 0.546807, 'fathoms'),
        (('door_spread',), 3.28084, 'feet'),
        (('port_door_depth', 'starboard_door_depth'), 3.28084, 'feet'),
        (('net_depth',), 3.28084, 'feet'),
        (('speed',), 1.943844, 'knots'),
        (('port_tension', 'starboard_tension'), 1e-3, 'kilonewtons'),
        (('port_tension', 'starboard_tension'), 1.019716e-4, 'tonnes-force'),
    ],
)
def test_a_wrong_unit_is_named_and_the_window_refused(known, names, factor, unit):
    judgement = judged(known, names, factor)
    assert judgement.found.reason == 'wrong unit'
    assert f'look like {unit}' in judgement.found.detail
    assert names[0] in judgement.found.detail
    assert judgement.refused


def test_an_optional_channel_is_left_out_instead(known):
    judgement = judged(known, ('vertical_opening',), 3.28084)
    assert judgement.without == ('vertical_opening',)
    assert not judgement.refused


def test_what_no_unit_explains_is_implausible(known):
    judgement = judged(known, ('port_tension', 'starboard_tension'), 5.0)
    assert judgement.found.reason == 'implausible'
    assert judgement.refused


def test_a_window_that_is_looked_at_is_solved_for_once(known):
    predictor, prior, _ = known
    judged(known)
    asked = predictor.predict(prior.start, LENGTH, LENGTH, SPEED)
    assert predictor.predict(prior.start, LENGTH, LENGTH, SPEED) is not asked
    judged(known)
    assert predictor.predict(prior.start, LENGTH, LENGTH, SPEED) is not asked


def test_degrees_are_told_by_the_range_of_radians_alone():
    roll = CHANNELS['port_roll']
    assert plausible_unit(np.array([11.0, 12.0]), roll) == 'degrees'
    assert plausible_unit(np.array([11.0, 1000.0]), roll) is None
    assert plausible_unit(np.array([700.0]), CHANNELS['door_spread']) is None
