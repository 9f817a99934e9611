"""Drag and weight of the net, estimated along with the boards or held."""

import numpy as np
import pytest

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.linearised import linearise
from trawl_ros.estimation.from_gear import board_prior, estimator_options
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.predict import Predictor
from trawl_ros.solver.sensitivity import net_sensitivities

DRAG, WEIGHT = 1.15, 0.9
STATES = ((300.0, 2.3), (300.0, 2.0), (450.0, 2.2), (600.0, 2.0), (600.0, 2.3), (800.0, 2.1))


@pytest.fixture(scope='module')
def coarse():
    gear = load_gear('kaifuha')
    return gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 12})})


@pytest.fixture(scope='module')
def model(coarse):
    return build_model(coarse)


@pytest.fixture(scope='module')
def windows(coarse, model):
    """Of a net with more drag and less weight than the gear file says, without errors."""
    plant = model.with_net(DRAG, WEIGHT).with_coefficients(board_prior(coarse).start)
    found, near = [], None
    for index, (length, speed) in enumerate(STATES):
        near = find_equilibrium(plant, OperatingPoint(length, length, speed), near)
        means = {name: getattr(near.observables, name) for name in MEASURED}
        means |= dict(zip(INPUTS, (length, length, speed), strict=True))
        noise = {name: 0.1 * CHANNELS[name].bias_std(mean) for name, mean in means.items()}
        bias = {name: CHANNELS[name].bias_std(mean) for name, mean in means.items()}
        counts = dict.fromkeys(means, 60)
        start = index * 10**12
        found.append(
            SteadyWindow(index, index, start, start + 6 * 10**10, means, noise, bias, counts)
        )
    return found


def fitted(coarse, model, windows, options):
    estimator = Estimator(Predictor(model), board_prior(coarse), OBSERVABLES, options)
    for window in windows:
        estimator.add(window)
    return estimator, estimator.finish()


def test_estimated_along_they_are_found_and_the_board_is_not_bent_to_fit(coarse, model, windows):
    _, without = fitted(coarse, model, windows, estimator_options())
    along, with_net = fitted(coarse, model, windows, estimator_options(net=True))
    assert without.net == ()
    drag, weight = with_net.net
    assert (drag.what, weight.what) == ('drag', 'weight')
    assert drag.value == pytest.approx(DRAG, abs=3.0 * drag.std)
    assert drag.value > 1.0 + 2.0 * drag.std
    assert weight.value == pytest.approx(WEIGHT, abs=3.0 * weight.std)
    assert drag.std < 0.3 * drag.known
    assert with_net.converged, with_net.reason
    prior = board_prior(coarse)
    away = [
        np.sqrt(np.mean(((found.values - prior.start) / found.std) ** 2))
        for found in (without, with_net)
    ]
    assert away[1] < 0.5
    assert away[0] > 3.0 * away[1]
    assert with_net.cost < without.cost
    # What it predicts is with the net as found.
    spread = along.predictions(along.coefficients)[:, 0]
    np.testing.assert_allclose(spread, [w.means['door_spread'] for w in windows], rtol=0.005)


@pytest.mark.parametrize(('column', 'factors'), [(0, (1.0, 0.0)), (1, (0.0, 1.0))])
def test_what_the_net_does_agrees_with_states_solved_anew(model, column, factors):
    base = model.with_net(1.1, 0.95)
    point = OperatingPoint(500.0, 500.0, 2.1)
    start = find_equilibrium(base, point)
    # Per factor of this net, that of the gear file being 1.1 and 0.95 times smaller.
    exact = net_sensitivities(base, start)[:, column] / (1.1, 0.95)[column]
    ends = [
        find_equilibrium(
            model.with_net(1.1 + step * factors[0], 0.95 + step * factors[1]), point, start
        ).observables.array()
        for step in (1e-3, -1e-3)
    ]
    np.testing.assert_allclose(
        (ends[0] - ends[1]) / 2e-3, exact, rtol=1e-4, atol=1e-5 * np.abs(ends[0]).max()
    )


def test_values_are_those_of_the_net_in_the_gear_file_to_first_order(model, windows, coarse):
    prior = board_prior(coarse)
    found = linearise(
        Predictor(model), OBSERVABLES, windows[2], prior.start, net=np.array([1.02, 0.99])
    )
    there = linearise(
        Predictor(model), OBSERVABLES, windows[2], prior.start, net=np.array([DRAG, WEIGHT])
    )
    np.testing.assert_allclose(there.solved, there.measured, rtol=1e-6, atol=1e-6)
    held = linearise(Predictor(model), OBSERVABLES, windows[2], prior.start)
    assert not held.by_net.any()
    first_order = np.abs(found.by_net) @ np.abs(found.net - 1.0)
    assert np.all(np.abs(held.values - found.values) < 0.2 * first_order)


def test_a_model_that_does_not_know_its_net_is_refused(sea, prior):
    estimator = Estimator(sea.ClosedForm(), prior, sea.OBSERVABLES, EstimatorOptions(net_drag=0.1))
    with pytest.raises(TypeError, match='ClosedForm'):
        estimator.add(sea.trial_windows(sea.ClosedForm(), np.random.default_rng(0))[0])
