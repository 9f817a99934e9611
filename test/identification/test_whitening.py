"""The robust whitening agrees with the joint problem that it shortens."""

import numpy as np
import pytest
from scipy.optimize import minimize

from trawl_ros.identification.whitening import whiten

RNG = np.random.default_rng(4)
STD = np.array([1.0, 2.0, 0.5, 3.0, 1.5])
BY_INPUTS = RNG.normal(size=(5, 3))
INPUT_STD = np.array([0.5, 0.7, 0.3])


def test_small_residuals_are_whitened_by_their_marginal_covariance():
    residual = 0.1 * RNG.normal(size=5)
    white = whiten(residual, STD, BY_INPUTS, INPUT_STD, 1.345)
    covariance = np.diag(STD**2) + (BY_INPUTS * INPUT_STD**2) @ BY_INPUTS.T
    np.testing.assert_allclose(white.root @ covariance @ white.root.T, np.eye(5), atol=1e-12)
    assert white.cost == pytest.approx(0.5 * residual @ np.linalg.solve(covariance, residual))


def test_a_wild_reading_costs_what_the_joint_huber_problem_says():
    residual = np.array([0.3, -0.5, 20.0, 1.0, -2.0])

    def joint(inputs):
        own = np.abs(residual - BY_INPUTS @ inputs) / STD
        loss = np.where(own <= 1.345, 0.5 * own**2, 1.345 * (own - 0.5 * 1.345))
        return loss.sum() + 0.5 * np.sum((inputs / INPUT_STD) ** 2)

    white = whiten(residual, STD, BY_INPUTS, INPUT_STD, 1.345)
    best = minimize(joint, np.zeros(3), method='Nelder-Mead', options={'xatol': 1e-9}).fun
    assert white.cost == pytest.approx(best, rel=1e-6)
    assert white.weights[2] < 0.1
    assert np.all(white.weights[[0, 1]] == 1.0)


def test_the_spread_is_on_average_about_what_is_expected_of_noise_as_stated():
    spread, expected = [], []
    for _ in range(2000):
        residual = STD * RNG.normal(size=5) + BY_INPUTS @ (INPUT_STD * RNG.normal(size=3))
        white = whiten(residual, STD, BY_INPUTS, INPUT_STD, 1.345)
        spread.append(white.spread)
        expected.append(white.expected)
    assert np.mean(spread) == pytest.approx(np.mean(expected), rel=0.06)
