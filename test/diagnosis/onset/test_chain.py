"""Innovations of a chain are those of the joint distribution of all its rows."""

import numpy as np
import pytest

from trawl_ros.diagnosis.onset.chain import MAX_INNOVATION, Belief, Chain

ROWS, SIZE = 4, 3


@pytest.fixture
def rows():
    """Columns by three lasting parameters, errors that neighbours share, and a draw of both."""
    rng = np.random.default_rng(3)
    root = np.diag([1.0, 2.0, 0.5])
    columns = rng.standard_normal((6 * ROWS, SIZE)) @ root
    apart = np.abs(np.subtract.outer(np.arange(len(columns)), np.arange(len(columns))))
    covariance = columns @ columns.T + np.exp(-apart / 5.0) + 0.1 * np.eye(len(columns))
    drawn = np.linalg.cholesky(covariance) @ rng.standard_normal(len(columns))
    return root, columns, covariance, drawn


def chained(root, columns, covariance, values):
    chain = Chain(Belief(np.zeros(SIZE), root))
    links = [
        chain.append(covariance[n : n + ROWS, : n + ROWS], columns[n : n + ROWS], own)
        for n, own in ((n, values[n : n + ROWS]) for n in range(0, len(values), ROWS))
    ]
    return chain, links


def test_innovations_are_those_of_one_cholesky_factor(rows):
    _, _, covariance, drawn = rows
    chain, _ = chained(*rows)
    expected = np.linalg.solve(np.linalg.cholesky(covariance), drawn)
    np.testing.assert_allclose(chain.white, expected, rtol=1e-5, atol=1e-6)


def test_the_belief_after_each_stretch_is_the_posterior_by_the_rows_before(rows):
    root, columns, covariance, drawn = rows
    chain, _ = chained(*rows)
    for n in (0, ROWS, len(drawn)):
        belief = chain.belief(n)
        gain = root @ columns[:n].T @ np.linalg.inv(covariance[:n, :n])
        np.testing.assert_allclose(belief.mean, gain @ drawn[:n], rtol=1e-4, atol=1e-6)
        left = root @ root.T - gain @ columns[:n] @ root.T
        np.testing.assert_allclose(belief.root @ belief.root.T, left, rtol=1e-4, atol=1e-6)


def test_a_reading_far_off_moves_the_belief_as_one_at_the_edge(rows):
    root, columns, covariance, drawn = rows
    beliefs = []
    for off in (1e3, 1e6):
        shown = drawn.copy()
        shown[2 * ROWS + 1] += off
        chain, links = chained(root, columns, covariance, shown)
        assert np.abs([link.innovations for link in links]).max() == pytest.approx(MAX_INNOVATION)
        away = shown[2 * ROWS : 3 * ROWS] - links[2].back @ chain.white[: 2 * ROWS]
        np.testing.assert_allclose(links[2].whitened(away), links[2].white, rtol=1e-6)
        beliefs.append(chain.belief(3 * ROWS).mean)
    np.testing.assert_allclose(*beliefs, rtol=0.05, atol=0.05)
