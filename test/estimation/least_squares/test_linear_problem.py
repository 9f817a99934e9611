"""Steps of blocks with shared and own parameters are those of one least-squares problem."""

import numpy as np
import pytest

from trawl_ros.estimation.least_squares.information import Information
from trawl_ros.estimation.least_squares.linear_problem import LinearProblem

SHARED, OWN, ROWS = 3, 2, 30


@pytest.fixture
def blocks():
    """Two blocks: derivatives, residuals and the roots of the covariance of their errors."""
    rng = np.random.default_rng(2)
    found = []
    for _ in range(2):
        root = np.linalg.cholesky(np.eye(ROWS) + 0.1 * np.ones((ROWS, ROWS)))
        found.append((root, rng.standard_normal((ROWS, SHARED + OWN)), rng.standard_normal(ROWS)))
    return found


def whole(blocks, damping=0.0, here=0.0):
    """Rows of all blocks and of the unit priors as one problem."""
    rows, right = [], []
    for number, (root, columns, residual) in enumerate(blocks):
        wide = np.zeros((ROWS, SHARED + 2 * OWN))
        wide[:, :SHARED] = columns[:, :SHARED]
        first = SHARED + number * OWN
        wide[:, first : first + OWN] = columns[:, SHARED:]
        rows.append(np.linalg.solve(root, wide))
        right.append(np.linalg.solve(root, residual))
    rows.append(np.eye(SHARED + 2 * OWN))
    right.append(np.zeros(SHARED + 2 * OWN))
    if damping:
        # The shared parameters stay with the weight of each block.
        weights = np.sqrt(damping * np.array([2.0] * SHARED + [1.0] * 2 * OWN))
        rows.append(np.diag(weights))
        right.append(weights * here)
    return np.vstack(rows), np.concatenate(right)


@pytest.mark.parametrize('damping', [0.0, 3.0])
def test_a_step_solves_all_blocks_at_once(blocks, damping):
    information = [Information.whitened(*block) for block in blocks]
    precision = np.ones(SHARED + OWN)
    free = np.full(SHARED, np.inf)
    here = [np.full(SHARED + OWN, 0.7)] * 2
    problem = LinearProblem(information, [precision] * 2, here, -free, free, SHARED)
    found = problem.target(damping)
    rows, right = whole(blocks, damping, 0.7)
    expected = np.linalg.lstsq(rows, right, rcond=None)[0]
    for number, own in enumerate(found):
        first = SHARED + number * OWN
        np.testing.assert_allclose(own[:SHARED], expected[:SHARED], atol=1e-9)
        np.testing.assert_allclose(own[SHARED:], expected[first : first + OWN], atol=1e-9)
    if not damping:
        covariance = np.linalg.inv(rows.T @ rows)
        std = np.sqrt(np.diag(covariance))[:SHARED]
        np.testing.assert_allclose(problem.std, std)
        away = np.abs(found[0][:SHARED] - 0.7) / std
        assert problem.distance(found) == pytest.approx(away.max())
        at = np.concatenate((found[0], found[1][SHARED:]))
        left = right - rows @ at
        assert problem.cost(found) == pytest.approx(0.5 * left @ left)


def test_a_step_stays_within_its_bounds(blocks):
    information = [Information.whitened(*block) for block in blocks]
    here, high = [np.zeros(SHARED + OWN)] * 2, np.full(SHARED, 0.01)
    found = LinearProblem(
        information, [np.ones(SHARED + OWN)] * 2, here, -high, high, SHARED
    ).target()
    assert np.all(np.abs(found[0][:SHARED]) <= 0.01 + 1e-12)
    np.testing.assert_array_equal(found[0][:SHARED], found[1][:SHARED])


def test_the_misfit_is_that_of_the_whitened_residual(blocks):
    root, columns, residual = blocks[0]
    at = np.arange(SHARED + OWN) / 10.0
    left = np.linalg.solve(root, residual - columns @ at)
    information = Information.whitened(root, columns, residual)
    assert information.squared_misfit(at) == pytest.approx(left @ left)
    moved = information.about(-at)
    assert moved.squared_misfit(np.zeros_like(at)) == pytest.approx(left @ left)
    assert Information.none(4).squared_misfit(np.ones(4)) == 0.0
