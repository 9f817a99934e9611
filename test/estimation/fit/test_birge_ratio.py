"""A fit that explains its readings badly tries again from the start, and is trusted less."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.estimator import AS_LIKELY, Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.linearised import linearise
from trawl_ros.estimation.fit.window_search import NO_STEADY_STATE

LONG = 700.0
LOW, HIGH = 0.8, 2.0


class Divided:
    """A closed form without steady states of long warps between two ranges of one coefficient."""

    def __init__(self, sea, long: float = LONG) -> None:
        self.sea, self.long, self.model = sea, long, sea.ClosedForm()

    def predict(self, coefficients, port_length, starboard_length, speed, start=None):
        away = (coefficients[0] - self.sea.TRUTH[0]) / self.sea.STD[0]
        if port_length > self.long and LOW < away < HIGH:
            raise NoSteadyState('there is none between the two ranges')
        return self.model.predict(coefficients, port_length, starboard_length, speed, start)


@pytest.fixture
def exact(sea, model):
    return sea.trial_windows(model, np.random.default_rng(0), noise=0.0)


@pytest.mark.parametrize('away', [2.5, 0.1])
def test_a_fit_that_was_led_astray_begins_again(sea, prior, exact, away):
    divided = Divided(sea)
    estimator = Estimator(divided, prior, sea.OBSERVABLES, EstimatorOptions(unsettled=0.0))
    astray = np.array(sea.TRUTH)
    astray[0] += away * sea.STD[0]
    parts = tuple(linearise(divided, sea.OBSERVABLES, window, astray) for window in exact)
    estimator._fit = replace(estimator._fit, windows=parts, coefficients=astray)
    estimate = estimator.finish()
    assert estimate.converged, estimate.reason
    assert estimate.windows == len(exact)
    assert estimate.values[0] == pytest.approx(sea.TRUTH[0], abs=3.0 * estimate.std[0])


@pytest.mark.parametrize(('set_aside', 'gets_there'), [(0.0, False), (0.3, True)])
def test_a_single_window_need_not_hold_up_the_rest(sea, prior, exact, set_aside, gets_there):
    lengths = sorted(window.means['port_length'] for window in exact)
    divided = Divided(sea, long=0.999 * lengths[-1])
    options = EstimatorOptions(
        unsettled=0.0, second_start=False, largest_step=0.5, set_aside=set_aside
    )
    estimator = Estimator(divided, prior, sea.OBSERVABLES, options)
    astray = np.array(sea.TRUTH)
    astray[0] += 2.5 * sea.STD[0]
    estimator.begin([linearise(divided, sea.OBSERVABLES, one, astray) for one in exact], astray)
    estimate = estimator.finish()
    assert estimate.windows == len(exact)
    away = abs(estimate.values[0] - sea.TRUTH[0]) / estimate.std[0]
    assert (away < 3.0) == gets_there
    assert (NO_STEADY_STATE in estimate.reason) != gets_there


def test_the_likelier_of_two_fits_stays(sea, prior, exact):
    """Where the start is on the wrong side, a fit on the right side is not given up for it."""
    start = np.array(prior.start)
    start[0] = sea.TRUTH[0] + 2.5 * sea.STD[0]
    estimator = Estimator(
        Divided(sea), replace(prior, start=start), sea.OBSERVABLES,
        EstimatorOptions(unsettled=0.0, prior_weight=0.0, iterations_final=1),
    )  # fmt: skip
    near = np.array(sea.TRUTH)
    near[0] += 0.3 * sea.STD[0]
    parts = tuple(linearise(Divided(sea), sea.OBSERVABLES, window, near) for window in exact)
    estimator._fit = replace(estimator._fit, windows=parts, coefficients=near)
    estimate = estimator.finish()
    assert not estimate.converged
    assert estimator.history[-1].cost == pytest.approx(estimate.cost)
    assert estimate.values[0] < sea.TRUTH[0] + LOW * sea.STD[0]


class Stuck(Estimator):
    """Estimator whose first fit is told to lack a step, and to be a little likelier than it is."""

    first = None

    def _rest_with_all(self):
        converged, reason = super()._rest_with_all()
        if self.first is None:
            self.first = self._fit
            return False, 'no step lowers the cost'
        return converged, reason


@pytest.mark.parametrize(('ahead', 'taken'), [(0.5, True), (2.0, False)])
def test_of_two_fits_as_likely_the_one_at_rest_is_taken(
    sea, model, prior, exact, monkeypatch, ahead, taken
):
    estimator = Stuck(model, prior, sea.OBSERVABLES, EstimatorOptions(unsettled=0.0))
    told = Fit.negative_log_likelihood.fget
    monkeypatch.setattr(
        Fit,
        'negative_log_likelihood',
        property(lambda fit: told(fit) - ahead * AS_LIKELY * (fit is estimator.first)),
    )
    estimator.take(exact)
    assert estimator.finish().converged == taken


def test_intervals_are_widened_by_what_no_error_explains(sea, model, prior, exact):
    # Noise is believed to be as stated.
    options = EstimatorOptions(stated_noise_readings=1e9, alike_readings=1e9)
    estimator = Estimator(model, prior, sea.OBSERVABLES, options)
    for window in exact:
        # The log reads too low and too high by turns.
        wrong = 1.0 + 0.03 * (-1) ** window.index
        estimator.add(
            replace(window, means={**window.means, 'speed': window.means['speed'] * wrong})
        )
    estimate = estimator.finish()
    assert estimate.birge_ratio > 1.3
    np.testing.assert_allclose(estimate.std, estimate.birge_ratio * estimator.fit.std)
    np.testing.assert_allclose(np.diag(estimate.covariance), estimate.std**2)
    half = 0.5 * (estimate.high - estimate.low)
    assert np.all(half <= 3.0 * estimate.std)
    readings = len(estimator.fit.windows[0].channels) * len(exact)
    assert estimate.birge_ratio == pytest.approx(np.sqrt(2.0 * estimate.cost / readings))


def test_readings_that_are_as_stated_leave_no_misfit(sea, model, prior):
    windows = sea.trial_windows(model, np.random.default_rng(1))
    estimator = Estimator(model, prior, sea.OBSERVABLES, EstimatorOptions(unsettled=0.0))
    for window in windows:
        estimator.add(window)
    assert estimator.finish().birge_ratio < 1.1
