"""The estimator finds a known answer, and says truly how well it knows it."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import GearError, NoSteadyState, TrawlError
from trawl_ros.estimation.fit.estimate import posterior_of, undetermined
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.linearised import linearise
from trawl_ros.estimation.fit.window_search import NO_STEADY_STATE
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.records.coefficients import COEFFICIENTS


def estimated(sea, model, prior, windows, **options):
    # These windows are at rest.
    options = {'unsettled': 0.0, **options}
    estimator = Estimator(model, prior, sea.OBSERVABLES, EstimatorOptions(**options))
    for window in windows:
        estimator.add(window)
    return estimator, estimator.finish()


def estimated_at_once(sea, model, prior, windows):
    """The same, but for rounding, in a fifth of the time: no estimate after each window."""
    estimator = Estimator(model, prior, sea.OBSERVABLES, EstimatorOptions(unsettled=0.0))
    parts = tuple(linearise(model, sea.OBSERVABLES, w, prior.start) for w in windows)
    estimator._fit = replace(estimator._fit, windows=parts)
    return estimator.finish()


def test_the_closed_form_has_the_derivatives_it_claims(sea, model):
    at = (sea.TRUTH + 0.3 * sea.STD, 510.0, 490.0, 1.9)
    jacobian = model.predict(*at).jacobian
    flat = np.array([*at[0], *at[1:]])
    for i in range(15):
        step = np.zeros(15)
        step[i] = 1e-5 * max(1.0, abs(flat[i]))
        up, down = flat + step, flat - step
        slope = (
            model.predict(up[:12], *up[12:]).values - model.predict(down[:12], *down[12:]).values
        )
        np.testing.assert_allclose(slope / (2 * step[i]), jacobian[:, i], rtol=1e-5, atol=1e-5)


def test_without_noise_the_truth_is_found(sea, model, prior):
    windows = sea.trial_windows(model, np.random.default_rng(0), noise=0.0)
    _, estimate = estimated(sea, model, prior, windows, prior_weight=0.0, tolerance=1e-4)
    assert estimate.converged, estimate.reason
    np.testing.assert_allclose(estimate.values, sea.TRUTH, atol=1e-6)
    assert estimate.objective < 1e-6
    assert all(estimate.determined)
    assert estimate.undetermined == ()
    assert estimate.active_bounds == ()


@pytest.mark.parametrize('noise', [1.0, pytest.param(3.0, marks=pytest.mark.slow)])
def test_intervals_cover_the_truth_as_often_as_they_say(sea, model, prior, noise):
    inside, departures = [], []
    for seed in range(40):
        windows = sea.trial_windows(model, np.random.default_rng(seed), noise=noise)
        estimate = estimated_at_once(sea, model, prior, windows)
        inside.append((estimate.low <= sea.TRUTH) & (estimate.high >= sea.TRUTH))
        departures.append((estimate.values - sea.TRUTH) / estimate.std)
    assert 0.92 <= np.mean(inside) <= 0.99
    assert 0.75 < np.std(departures) < 1.2


def test_noise_that_is_three_times_the_stated_is_noticed(sea, model, prior):
    windows = sea.trial_windows(model, np.random.default_rng(1), noise=3.0)
    _, estimate = estimated(sea, model, prior, windows)
    assert estimate.noise_scale == pytest.approx(3.0, rel=0.25)
    assert min(estimate.noise_scales.values()) > 1.5


def test_one_wild_reading_moves_the_estimate_little_and_would_move_it_far(sea, model, prior):
    windows = sea.trial_windows(model, np.random.default_rng(2))
    _, clean = estimated(sea, model, prior, windows)
    windows[4].means['door_spread'] *= 3.0
    _, spoilt = estimated(sea, model, prior, windows)
    _, trusting = estimated(sea, model, prior, windows, huber=1e6)
    moved, far = (
        float(np.sqrt(np.mean(((e.values - clean.values) / clean.std) ** 2)))
        for e in (spoilt, trusting)
    )
    assert moved < 1.5
    assert far > 10.0 * moved


def test_every_window_sharpens_the_estimate(sea, model, prior):
    estimator = Estimator(model, prior, sea.OBSERVABLES)
    windows = sea.trial_windows(model, np.random.default_rng(3))
    volumes = [np.linalg.slogdet(estimator.add(w).covariance)[1] for w in windows]
    assert volumes[-1] < volumes[0] - 10.0
    assert estimator.estimate.revision == estimator.estimate.windows == len(windows)


def test_an_innovation_is_told_before_the_window_is_used(sea, model, prior):
    windows = sea.trial_windows(model, np.random.default_rng(3), noise=0.0)
    estimator = Estimator(model, prior, sea.OBSERVABLES, EstimatorOptions(model_error=0.0))
    window = windows[0]
    inputs = [window.means[n] for n in ('port_length', 'starboard_length', 'speed')]
    expected = model.predict(prior.start, *inputs)
    innovation = estimator.add(window).innovation
    at = innovation.channels.index('door_spread')
    row = sea.OBSERVABLES.index('door_spread')
    assert innovation.values[at] == pytest.approx(
        window.means['door_spread'] - expected.values[row]
    )
    known = np.sum((expected.jacobian[row, :12] * prior.std) ** 2)
    options = EstimatorOptions()

    def std(name):
        bias = window.bias[name]
        changing = CHANNELS[name].state_std(bias, options.state_share)
        return math.hypot(options.tow_share * bias, changing)

    inputs = np.sum((expected.jacobian[row, 12:] * [std(name) for name in INPUTS]) ** 2)
    variance = known + inputs + std('door_spread') ** 2
    assert innovation.stds[at] == pytest.approx(math.sqrt(variance))
    assert innovation.test_ratios[at] == pytest.approx(
        innovation.values[at] ** 2 / (9.0 * variance)
    )


def test_errors_of_the_log_are_not_taken_for_the_boards(sea, model, prior):
    """A speed that is wrong by one std pulls less when its std is admitted."""
    windows = sea.trial_windows(model, np.random.default_rng(0), noise=0.0)
    for window in windows:
        window.means['speed'] += 0.02 if window.index % 2 else -0.02
        window.bias['speed'] = 0.02
    _, admitting = estimated(sea, model, prior, windows)
    for window in windows:
        window.bias['speed'] = 1e-6
    _, denying = estimated(sea, model, prior, windows)
    away = [np.sum(((e.values - sea.TRUTH) / sea.STD) ** 2) for e in (admitting, denying)]
    assert away[0] < 0.5 * away[1]


def test_a_bound_that_is_in_the_way_is_respected_and_named(sea, model, prior):
    low = np.array(prior.low)
    low[2] = sea.TRUTH[2] + 0.2 * sea.STD[2]
    tight = replace(prior, low=low)
    windows = sea.trial_windows(model, np.random.default_rng(0), noise=0.3)
    _, estimate = estimated(sea, model, tight, windows)
    assert estimate.values[2] == low[2]
    assert estimate.low[2] >= low[2]
    (bound,) = estimate.active_bounds
    assert re.fullmatch(f'a2 .*lower.* {low[2]:g}', bound)
    assert estimate.converged, estimate.reason


def test_a_pair_that_only_acts_together_is_named(sea, prior):
    twin = sea.ClosedForm()
    twin.sensitivity[:, 7] = twin.sensitivity[:, 6]
    windows = sea.trial_windows(twin, np.random.default_rng(0))
    _, estimate = estimated(sea, twin, prior, windows)
    (pair,) = estimate.undetermined
    assert set(pair.names) == {'a4', 'c4'}
    assert str(pair) in ('a4 with c4', 'c4 with a4')
    assert not estimate.determined[6]
    assert not estimate.determined[7]
    assert estimate.determined[0]
    assert estimate.condition_number > 1e6
    assert estimate.std[6] == pytest.approx(sea.STD[6] / math.sqrt(2.0), rel=0.1)


def test_two_open_directions_are_named_apart(sea, prior):
    rows = np.random.default_rng(1).normal(size=(40, 12)) * 30.0
    rows[:, 5] = 0.0
    rows[:, 11] = -rows[:, 10]
    names = {
        frozenset(c.names)
        for c in undetermined(posterior_of(rows.T @ rows, prior.std, 1.0), prior.names)
    }
    assert names == {frozenset({'c3'}), frozenset({'a6', 'c6'})}


def test_a_coefficient_the_data_do_not_see_keeps_its_prior(sea, prior):
    blind = sea.ClosedForm()
    blind.sensitivity[:, 5] = 0.0
    windows = sea.trial_windows(blind, np.random.default_rng(0))
    _, estimate = estimated(sea, blind, prior, windows)
    assert estimate.values[5] == pytest.approx(prior.start[5])
    assert estimate.std[5] == pytest.approx(prior.std[5])
    assert estimate.shrink[5] == pytest.approx(0.0, abs=1e-9)
    assert estimate.shrink[0] > 0.9
    assert estimate.condition_number == math.inf


class Skittish:
    """Finds no steady state from a start whose coefficients are too far away."""

    def __init__(self, sea):
        self.inner, self.sea, self.lost = sea.ClosedForm(), sea, 0

    def predict(self, coefficients, port_length, starboard_length, speed, start=None):
        if start is not None and np.max(np.abs(coefficients - start) / self.sea.STD) > 0.3:
            self.lost += 1
            raise NoSteadyState('too far from the start')
        found = self.inner.predict(coefficients, port_length, starboard_length, speed)
        return replace(found, state=np.array(coefficients))


def test_a_step_that_loses_the_steady_state_is_halved(sea, prior):
    model = Skittish(sea)
    windows = sea.trial_windows(sea.ClosedForm(), np.random.default_rng(0), noise=0.0)
    _, estimate = estimated(sea, model, prior, windows)
    assert model.lost > 0
    assert estimate.converged, estimate.reason
    np.testing.assert_allclose(estimate.values, sea.TRUTH, atol=0.02)


def test_more_windows_of_the_same_states_do_not_wear_down_the_bias(sea, model, prior):
    windows = sea.trial_windows(model, np.random.default_rng(0), noise=0.1)
    single = estimated(sea, model, prior, windows)[1]
    twice = [
        replace(window, index=2 * window.index + copy, state=window.index)
        for window in windows
        for copy in range(2)
    ]
    same_states = estimated(sea, model, prior, twice)[1]
    np.testing.assert_allclose(same_states.std, single.std, rtol=0.02)
    apart = [replace(window, state=window.index) for window in twice]
    other_states = estimated(sea, model, prior, apart)[1]
    # Calibration, the same in all states, is not worn down either.
    assert np.all(other_states.std < single.std)
    assert np.mean(other_states.std / single.std) < 0.85


def test_where_the_answer_lies_beyond_the_steady_states_it_says_so(sea, prior):
    free = sea.ClosedForm()
    windows = sea.trial_windows(free, np.random.default_rng(0), noise=0.0)
    model = sea.ClosedForm(stops_at=sea.TRUTH[0] - 0.5 * sea.STD[0])
    start = np.array(prior.start)
    start[0] = sea.TRUTH[0] - sea.STD[0]
    _, estimate = estimated(sea, model, replace(prior, start=start), windows)
    assert not estimate.converged
    assert NO_STEADY_STATE in estimate.reason


class Picky:
    """Has no steady state at one warp length until the first coefficient is near the truth."""

    def __init__(self, sea):
        self.inner, self.sea = sea.ClosedForm(), sea

    def predict(self, coefficients, port_length, starboard_length, speed, start=None):
        far = abs(coefficients[0] - self.sea.TRUTH[0]) > 0.3 * self.sea.STD[0]
        if port_length < 250.0 and far:
            raise NoSteadyState('too far from the truth')
        return self.inner.predict(coefficients, port_length, starboard_length, speed, start)


def test_a_window_without_steady_state_is_set_aside_and_tried_again_at_the_end(sea, prior):
    windows = sea.trial_windows(sea.ClosedForm(), np.random.default_rng(0), noise=0.1)
    estimator = Estimator(Picky(sea), prior, sea.OBSERVABLES)
    assert estimator.add(windows[0]) is None
    assert estimator.without_steady_state == 1
    for window in windows[1:]:
        estimator.add(window)
    estimate = estimator.finish()
    assert estimator.without_steady_state == 0
    assert estimate.windows == len(windows)


def test_finish_without_any_window_gives_none(sea, model, prior):
    assert Estimator(model, prior, sea.OBSERVABLES).finish() is None


def test_after_a_reset_the_same_windows_give_the_same_estimate(sea, model, prior):
    windows = sea.trial_windows(model, np.random.default_rng(5))
    estimator, first = estimated(sea, model, prior, windows)
    estimator.reset()
    assert estimator.estimate is None
    for window in windows:
        estimator.add(window)
    np.testing.assert_array_equal(estimator.finish().values, first.values)


def test_an_update_takes_few_solutions(sea, model, prior):
    windows = sea.trial_windows(model, np.random.default_rng(6))
    estimator = Estimator(model, prior, sea.OBSERVABLES)
    for window in windows[:-1]:
        estimator.add(window)
    model.calls = 0
    estimator.add(windows[-1])
    assert model.calls <= 1 + 3 * len(windows)


def test_a_prior_that_contradicts_itself_is_refused_by_name(prior):
    start = np.array(prior.start)
    start[3] = prior.high[3] + 1.0
    with pytest.raises(GearError, match=COEFFICIENTS[3]):
        replace(prior, start=start)
    with pytest.raises(GearError, match=r'identification\.std'):
        replace(prior, std=prior.std[:5])


def test_a_confidence_of_one_is_refused():
    with pytest.raises(TrawlError, match='confidence'):
        EstimatorOptions(confidence=1.0)
