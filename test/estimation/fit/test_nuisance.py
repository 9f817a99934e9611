"""Eliminating errors tow by tow gives what the full covariance of all readings gives."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.fit.error_terms import (
    GROUP_OF,
    GROUPS,
    LONGER,
    TERMS,
    USUAL_LENGTH,
)
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.fitted_estimate import biases_of_fit
from trawl_ros.estimation.fit.linearised import linearise
from trawl_ros.estimation.fit.nuisance import MAX_ELIMINATIONS, WEIGHT_TOLERANCE, reweighted
from trawl_ros.records.channels import INPUTS

NORMAL = 1e9
"""A limit that no error reaches, so that the loss is that of normal errors."""


@pytest.fixture
def fit(sea, model, prior):
    """Two tows, an optional channel missing in one window."""
    windows = sea.trial_windows(model, np.random.default_rng(7))
    windows = [replace(w, tow=w.index // 8, noise={n: 0.1 * s for n, s in w.bias.items()})
               for w in windows]  # fmt: skip
    del windows[3].means['vertical_opening']
    at = sea.TRUTH + 0.1 * sea.STD
    parts = tuple(linearise(model, sea.OBSERVABLES, window, at) for window in windows)
    scales = tuple(np.linspace(0.7, 1.4, len(GROUPS)))
    return Fit(parts, at, scales, prior, EstimatorOptions(huber=NORMAL))


@pytest.fixture
def dense(fit):
    """Residual (n,), sensitivities (n, 12), own variance (n,) and covariance (n, n) of it all."""
    number, channels = fit.residual.shape
    own = np.zeros((number, channels))
    covariance = np.zeros((number, channels, number, channels))
    present = np.zeros((number, channels), dtype=bool)
    for tow in fit.errors:
        present[tow.rows] = tow.present
        own[tow.rows] = (tow.noise * np.array(fit.scales)[GROUP_OF]) ** 2
        for i, row in enumerate(tow.rows):
            covariance[row, :, row] += tow.inputs[i] @ tow.inputs[i].T
            for j, column in enumerate(tow.rows):
                covariance[row, :, column] += tow.calibration[i] @ tow.calibration[j].T
    models = np.zeros((number, channels, len(GROUPS)))
    for tow in fit.errors:
        models[tow.rows] = tow.model
    flat = models.reshape(-1, len(GROUPS))
    covariance = covariance.reshape(number * channels, -1) + flat @ flat.T
    covariance += np.diag(own.reshape(-1))
    there = present.reshape(-1)
    return (
        fit.residual.reshape(-1)[there],
        fit.jacobian.reshape(-1, 12)[there],
        own.reshape(-1)[there],
        covariance[np.ix_(there, there)],
        there,
    )


def test_tows_together_hold_the_information_of_all_readings(fit, dense):
    residual, jacobian, _, covariance, _ = dense
    weighed = np.linalg.solve(covariance, jacobian)
    known = fit.elimination.coefficients
    np.testing.assert_allclose(known.matrix, jacobian.T @ weighed, rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(known.right, weighed.T @ residual, rtol=1e-7, atol=1e-7)


def test_extrapolated_weights_are_nearer_to_their_end_than_those_of_plain_reweighting(fit):
    robust = replace(fit, options=replace(fit.options, huber=0.5))
    plain = replace(robust, weights=tuple(np.ones(tow.noise.shape) for tow in robust.errors))
    costs = []
    for _ in range(2000):
        plain = replace(robust, weights=reweighted(plain.elimination, 0.5))
        costs.append(plain.cost)
    end = costs[-1]
    assert abs(costs[MAX_ELIMINATIONS] - end) > 1e-7 * end
    assert abs(robust.cost - end) < 0.5 * abs(costs[MAX_ELIMINATIONS] - end)


def test_the_cost_is_half_the_squared_residual_in_that_covariance(fit, dense):
    residual, _, _, covariance, _ = dense
    expected = 0.5 * residual @ np.linalg.solve(covariance, residual)
    assert fit.elimination.cost == pytest.approx(expected, rel=1e-9)


def test_own_errors_and_their_shares_are_those_of_the_whole(fit, dense):
    residual, jacobian, own, covariance, there = dense
    solved = own * np.linalg.solve(covariance, residual)
    found = np.zeros(fit.residual.shape)
    for part in fit.elimination.tows:
        found[part.errors.rows] = part.own * part.std
    np.testing.assert_allclose(found.reshape(-1)[there], solved, rtol=1e-7, atol=1e-9)
    inverse = np.linalg.inv(covariance)
    known = inverse @ jacobian
    posterior = np.linalg.inv(jacobian.T @ known + np.eye(12))
    shares = own * np.diag(inverse - known @ posterior @ known.T)
    np.testing.assert_allclose(
        fit.redundancy_numbers.reshape(-1)[there], shares, rtol=1e-6, atol=1e-9
    )
    assert not fit.redundancy_numbers.reshape(-1)[~there].any()


def test_a_wild_reading_loses_weight_and_its_neighbours_do_not(fit):
    wild = [replace(part) for part in fit.windows]
    measured = np.array(wild[2].measured)
    measured[0] *= 3.0
    wild[2] = replace(wild[2], measured=measured)
    robust = replace(fit, windows=tuple(wild), options=EstimatorOptions())
    (first, _) = robust.elimination.tows
    assert first.weights[2, 0] < 0.02
    assert np.median(first.weights) == 1.0
    for tow, weights in zip(
        robust.elimination.tows, reweighted(robust.elimination, robust.options.huber), strict=True
    ):
        np.testing.assert_allclose(tow.weights, weights, atol=2.0 * WEIGHT_TOLERANCE)


def test_what_an_instrument_reads_too_high_is_found_per_tow(sea, model, prior):
    options = EstimatorOptions(unsettled=0.0)
    windows = [
        replace(window, index=15 * tow + window.index, state=15 * tow + window.index, tow=tow)
        for tow in (0, 1)
        for window in sea.trial_windows(model, np.random.default_rng(5), noise=0.0)
    ]
    estimator = Estimator(model, prior, sea.OBSERVABLES, options)
    for window in windows:
        if window.tow:
            window.means['net_depth'] += 0.8
        estimator.add(window)
    estimator.finish()
    biases = {(bias.tow, bias.channel): bias for bias in biases_of_fit(estimator._fit)}
    known = {term.channel for term in TERMS} & {*INPUTS, *sea.OBSERVABLES}
    assert {channel for _, channel in biases} == known
    assert len(biases) == 2 * len(known)
    for (_, _), bias in biases.items():
        assert 0.0 < bias.std <= bias.known * (1.0 + 1e-9)
    apart = biases[1, 'net_depth'].value - biases[0, 'net_depth'].value
    assert apart == pytest.approx(0.8, abs=0.15)
    assert biases[1, 'net_depth'].unit == 'm'
    others = [abs(bias.value / bias.known) for (_, name), bias in biases.items()
              if name != 'net_depth']  # fmt: skip
    assert max(others) < 0.5


def test_errors_of_the_model_may_change_with_the_warps(fit):
    trend = replace(fit, options=replace(fit.options, model_trend=0.5), known=None)
    groups = len(fit.scales)
    for tow in trend.errors:
        constant, changing = tow.model[:, :, :groups], tow.model[:, :, groups:]
        lengths = [fit.windows[row].window.means['port_length'] for row in tow.rows]
        longer = 0.5 * np.log(np.array(lengths) / USUAL_LENGTH) / np.log(LONGER)
        np.testing.assert_allclose(changing, constant * longer[:, None, None], rtol=0.02, atol=1e-4)
        assert np.ptp(longer) > 0.2
    # What may change is known less well.
    before, after = (np.linalg.norm(one.posterior.root, axis=1) for one in (fit, trend))
    assert np.all(after >= before * (1.0 - 1e-9))


def test_noise_is_not_found_smaller_than_the_least_that_is_taken(fit):
    exact = replace(fit.windows[0], measured=fit.windows[0].values)
    quiet = replace(fit, windows=(exact,) * len(fit.windows), known=None)
    assert max(quiet.rescaled().scales) < 1.0
    stated = replace(quiet, options=replace(fit.options, least_noise=1.0), known=None)
    assert stated.rescaled().scales == (1.0,) * len(fit.scales)
