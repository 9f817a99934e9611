"""From samples to the report: one way for live, replayed and recorded data."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.fit.objective import mnae, objective, weights
from trawl_ros.estimation.pipeline import Identification, WindowUsed
from trawl_ros.estimation.report.holdout import hold_out
from trawl_ros.estimation.report.report import report
from trawl_ros.estimation.report.result import result
from trawl_ros.estimation.windows.records import REASONS, RejectedWindow, WindowOptions
from trawl_ros.records.samples import RangeSample, WinchSample


def make(sea, model, prior):
    options = WindowOptions(settle_s=120.0, settle_passages=0.0, speed_tolerance=0.15)
    return Identification(model, prior, sea.OBSERVABLES, sea.pressure_to_depth, options)


@pytest.fixture(scope='module')
def trial():
    """Filled once with the samples of a trial of nine states, for the tests of this file."""
    return []


@pytest.fixture
def samples(sea, model, trial):
    if not trial:
        legs = [sea.Leg(x, u, 220.0) for u in (1.8, 2.0, 2.2) for x in (300.0, 500.0, 700.0)]
        trial.extend(sea.tow(model, legs))
    return trial


@pytest.fixture
def done(sea, model, prior, samples):
    identification = make(sea, model, prior)
    for sample in samples:
        identification.feed(sample)
    identification.finish()
    return identification


def test_a_trial_gives_the_coefficients_back(sea, done):
    estimate = done.estimate
    assert estimate.windows == 9
    assert estimate.converged, estimate.reason
    assert np.all(np.abs(estimate.values - sea.TRUTH) < 0.2 * sea.STD)
    assert set(done.rejected) <= set(REASONS)
    assert done.why_not() is None


def test_every_accepted_window_brings_an_estimate_at_once(sea, model, prior, samples):
    identification = make(sea, model, prior)
    events = [event for sample in samples for event in identification.feed(sample)]
    used = [event for event in events if isinstance(event, WindowUsed)]
    assert [event.estimate.windows for event in used] == list(range(1, len(used) + 1))
    assert all(event.estimate.stamp == event.window.end_ns for event in used)


def test_live_with_jitter_and_offline_in_order_agree(sea, model, prior, samples, done):
    rng = np.random.default_rng(1)
    arrival = np.argsort([sample.stamp + rng.uniform(0.0, 1.5e9) for sample in samples])
    live = make(sea, model, prior)
    for i in arrival:
        live.feed(samples[i])
    live.finish()
    np.testing.assert_allclose(live.estimate.values, done.estimate.values, rtol=0, atol=1e-9)
    np.testing.assert_allclose(live.estimate.covariance, done.estimate.covariance, atol=1e-9)
    assert live.rejected == done.rejected


def test_after_a_reset_only_what_follows_counts(sea, model, prior, samples, done):
    looping = make(sea, model, prior)
    for sample in samples[:9000]:
        looping.feed(sample)
    looping.reset()
    assert looping.estimate is None
    for sample in samples:
        looping.feed(sample)
    looping.finish()
    np.testing.assert_array_equal(looping.estimate.values, done.estimate.values)


def test_it_says_which_channels_it_lacks_and_that_it_does_not_estimate(sea, model, prior, samples):
    identification = make(sea, model, prior)
    for sample in samples[:3000]:
        if isinstance(sample, WinchSample):
            sample = replace(sample, lengths=(math.nan, math.nan))
        if not isinstance(sample, RangeSample):
            identification.feed(sample)
    assert identification.missing_channels() == ('port_length', 'starboard_length', 'door_spread')
    sentence = identification.why_not()
    assert sentence.split(';')[0].endswith(' door/spread')
    assert sentence.endswith(' of starboard_length')
    with pytest.raises(TrawlError, match='door/spread'):
        report(identification)


def test_without_any_reading_each_topic_is_named_once(sea, model, prior):
    sentence = make(sea, model, prior).why_not()
    assert sentence.count('winch/joint_states') == 1
    assert len(sentence) < 160


def test_two_clocks_are_told(sea, model, prior, samples):
    identification = make(sea, model, prior)
    for sample in samples[:3000]:
        if isinstance(sample, RangeSample):
            sample = replace(sample, stamp=sample.stamp - sea.EPOCH)
        identification.feed(sample)
    identification.finish()
    assert 'door/spread' in identification.why_not()
    assert 'two clocks' in identification.why_not()


def test_never_steady_is_told_with_what_a_window_needs(sea, model, prior):
    identification = make(sea, model, prior)
    for sample in sea.tow(model, [sea.Leg(400.0, 2.0, 60.0), sea.Leg(700.0, 2.0, 60.0)]):
        identification.feed(sample)
    identification.finish()
    assert 'no steady window' in identification.why_not()
    assert 'unsteady 1' in identification.why_not()


def test_windows_without_steady_state_are_counted(sea, prior, samples):
    identification = make(sea, sea.ClosedForm(stops_at=-1e9), prior)
    events = [event for sample in samples for event in identification.feed(sample)]
    lost = [e for e in events if isinstance(e, RejectedWindow) and e.reason == 'no steady state']
    identification.finish()
    assert len(lost) == identification.rejected['no steady state'] == 9
    assert 'no steady state 9' in identification.why_not()


def test_eq_35_weighs_channels_alike():
    measured = np.array([[100.0, 200.0, 2e5, 220.0], [140.0, 300.0, 3e5, 330.0]])
    predicted = measured * np.array([1.1, 0.9, 1.0, 1.05])
    np.testing.assert_allclose(mnae(predicted, measured), [0.1, 0.1, 0.0, 0.05])
    assert objective(predicted, measured) == pytest.approx(0.25)
    assert np.all((weights(measured) > 0.0) & (weights(measured) < 1.0))


def test_rows_without_a_prediction_are_left_out_of_errors():
    measured = np.array([[100.0, 200.0, 2e5, 220.0]] * 2)
    predicted = measured * 1.1
    predicted[1] = np.nan
    np.testing.assert_allclose(mnae(predicted, measured), 0.1)
    assert math.isnan(objective(np.full((2, 4), np.nan), measured))


def test_held_out_states_are_really_left_out(sea, done):
    """A state with false readings is predicted as if it had never been seen."""
    held = hold_out(done.estimator).predicted
    windows = done.estimator.windows
    exact = [
        sea.ClosedForm()
        .predict(sea.TRUTH, w.means['port_length'], w.means['starboard_length'], w.means['speed'])
        .values[0]
        for w in windows
    ]
    for window in windows[:1]:
        window.means['door_spread'] *= 1.5
    again = hold_out(done.estimator).predicted
    np.testing.assert_allclose(held[:, 0], exact, rtol=0.02)
    assert again[0, 0] == pytest.approx(exact[0], rel=0.02)
    np.testing.assert_array_equal(done.estimate.values, done.estimator.coefficients)


def test_one_state_cannot_be_held_out(sea, model, prior):
    identification = make(sea, model, prior)
    for sample in sea.tow(model, [sea.Leg(500.0, 2.0, 400.0)]):
        identification.feed(sample)
    identification.finish()
    assert np.all(np.isnan(hold_out(identification.estimator).predicted))
    found = result(report(identification))
    assert found['channels']['door_spread']['mnae_held_out'] is None
    assert json.loads(json.dumps(found, allow_nan=False)) == found
