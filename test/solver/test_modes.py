"""Arnoldi's method ends when the eigenvalues asked for are known, or when there are no more."""

import numpy as np
import pytest

from trawl_ros.solver.modes import ritz_pairs


@pytest.mark.parametrize('kind', [float, complex])
def test_the_largest_eigenvalues_and_their_vectors_are_found(kind: type) -> None:
    rng = np.random.default_rng(1)
    matrix = np.diag(np.arange(1.0, 201.0) ** -2).astype(kind)
    matrix += 1e-4 * rng.standard_normal((200, 200))
    found = ritz_pairs(
        lambda x: matrix @ x, np.ones(200, kind), lambda _, errors: max(errors[:3]) < 1e-9, 60
    )
    every = np.linalg.eigvals(matrix)
    assert found.values[:3] == pytest.approx(every[np.argsort(-np.abs(every))][:3], rel=1e-8)
    assert len(found.values) < 40
    vectors = found.vectors(np.arange(len(found.values)) < 3)
    np.testing.assert_allclose(matrix @ vectors, vectors * found.values[:3], atol=1e-8)


def test_the_search_ends_where_no_vector_is_left() -> None:
    matrix = np.diag([3.0, 2.0, 1.0])
    found = ritz_pairs(lambda x: matrix @ x, np.ones(3), lambda *_: False, 20)
    assert found.values == pytest.approx([3.0, 2.0, 1.0])
