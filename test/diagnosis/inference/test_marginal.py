"""Marginal likelihoods against the normal density of all readings written out."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from trawl_ros.diagnosis.inference.blocks import Blocks
from trawl_ros.diagnosis.inference.marginal import marginal
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.unknown import unknown
from trawl_ros.diagnosis.inference.variants import Chosen, log_factor

NUMBER, SHARED, VALUES = 12, 4, 5


@pytest.fixture(scope='module')
def made():
    """Readings of a known covariance, whitened, and the same written out."""
    rng = np.random.default_rng(0)
    mix = rng.standard_normal((NUMBER, NUMBER))
    covariance = mix @ mix.T + np.eye(NUMBER)
    shared, columns = (rng.standard_normal((NUMBER, k)) for k in (SHARED, VALUES))
    residual = 3.0 * rng.standard_normal(NUMBER)
    root = np.linalg.cholesky(covariance)
    white = [np.linalg.solve(root, part) for part in (residual, shared, columns)]
    blocks = Blocks(*white, float(np.log(np.diag(root)).sum()))
    return marginal(blocks), residual, covariance + shared @ shared.T, columns


def density(residual, covariance):
    return multivariate_normal(np.zeros(len(residual)), covariance).logpdf(residual)


def test_boards_are_integrated_out(made):
    found, residual, covariance, _ = made
    assert found.log_evidence == pytest.approx(density(residual, covariance))


def test_a_bayes_factor_is_that_of_the_densities(made):
    found, residual, covariance, columns = made
    mean, std = np.array([0.5, -1.0]), np.array([2.0, 0.7])
    own = columns[:, [1, 3]]
    wide = covariance + (own * std**2) @ own.T
    factor, _, _ = found.posterior([1, 3], mean, std)
    there = density(residual - own @ mean, wide)
    assert factor == pytest.approx(there - density(residual, covariance))


def test_one_cause_after_the_other_is_both_together(made):
    found, *_ = made
    zero, std = np.zeros(1), np.ones(1)
    both, _, _ = found.posterior([0, 4], np.zeros(2), np.ones(2))
    first, _, _ = found.posterior([0], zero, std)
    beside = found.given([0], zero, std)
    second, _, _ = beside.posterior([4], zero, std)
    assert both == pytest.approx(first + second)
    assert beside.log_evidence == pytest.approx(found.log_evidence + first)


def test_a_prior_that_ends_at_nothing_counts_what_lies_beyond(made):
    found, *_ = made
    wide = Chosen((0,), np.zeros(1), np.ones(1), np.full(1, -50.0), np.full(1, 50.0))
    sides = [
        Chosen((0,), np.zeros(1), np.ones(1), np.array([low]), np.array([high]))
        for low, high in ((-50.0, 0.0), (0.0, 50.0))
    ]
    free = log_factor(found, wide)
    each = [log_factor(found, side) for side in sides]
    # Either half has half of the prior.
    assert np.exp(each).mean() == pytest.approx(np.exp(free))


def test_a_cause_that_somebody_finds_is_not_of_size_zero(made):
    found, *_ = made
    values = np.zeros(1), np.ones(1), np.full(1, -50.0), np.full(1, 50.0)
    normal, moment = Chosen((0,), *values), Chosen((0,), *values, parts=(np.array([0]),))
    size = np.zeros(VALUES)
    quiet = type(found)(found.information, np.zeros(VALUES))
    size[0] = 5.0
    loud = type(found)(found.information, found.information @ size)
    # Readings that show nothing speak against it the more, and those that show it for it.
    assert log_factor(quiet, moment) < log_factor(quiet, normal)
    assert log_factor(loud, moment) > log_factor(loud, normal)
    blind = type(found)(np.zeros((VALUES, VALUES)), np.zeros(VALUES))
    assert log_factor(blind, moment) == pytest.approx(log_factor(blind, normal))


def test_something_else_is_found_by_its_patterns(made):
    found, *_ = made
    quiet = unknown(type(found)(found.information, np.zeros(VALUES)), InferenceOptions())
    assert quiet.log_factor < 0.0
    size = np.zeros(VALUES)
    size[2] = 20.0
    loud = unknown(type(found)(found.information, found.information @ size), InferenceOptions())
    assert loud.log_factor > 5.0
    assert loud.places[0] == 2
