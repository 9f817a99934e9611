"""Factorisation in an order found beforehand, held against one that chooses its pivots."""

import numpy as np
import pytest

from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.linear.factor import (
    MIN_RIGHTS_FOR_PANELS,
    factorised,
    factorised_part,
    solve_refined,
)


@pytest.fixture(scope='module')
def rng() -> np.random.Generator:
    return np.random.default_rng(1)


def gear_like(model: GearModel, rng: np.random.Generator) -> np.ndarray:
    """Data on the pattern: at random, and heavier on the diagonal."""
    pattern = model.pattern
    data = rng.normal(size=len(pattern.indices))
    return data + np.where(on_diagonal(model), 10.0, 0.0)


def on_diagonal(model: GearModel) -> np.ndarray:
    pattern = model.pattern
    return pattern.indices == np.repeat(np.arange(pattern.dof), np.diff(pattern.indptr))


@pytest.mark.parametrize('turned', [1.0, 1.0 + 0.5j])
def test_solutions_are_those_of_superlu(
    model: GearModel, rng: np.random.Generator, turned: complex
) -> None:
    data = turned * gear_like(model, rng) + 0.1 * gear_like(model, rng)
    right = rng.normal(size=model.dof)
    factor = factorised(model.pattern, data)
    expected = factorised_part(model.pattern.matrix(data)).solve(right.astype(data.dtype))
    assert np.abs(factor.solve(right) - expected).max() < 1e-12 * np.abs(expected).max()


def test_many_right_hand_sides_are_solved_one_by_one(
    model: GearModel, rng: np.random.Generator
) -> None:
    factor = factorised(model.pattern, gear_like(model, rng))
    right = rng.normal(size=(model.dof, 3))
    columns = [factor.solve(column) for column in right.T]
    assert (factor.solve(right) == np.column_stack(columns)).all()


@pytest.mark.parametrize('turned', [1.0, 1.0 + 0.5j])
def test_many_side_by_side_are_solved_as_one_is(
    model: GearModel, rng: np.random.Generator, turned: complex
) -> None:
    data = turned * gear_like(model, rng) + 0.1 * gear_like(model, rng)
    factor = factorised(model.pattern, data)
    right = rng.normal(size=(model.dof, MIN_RIGHTS_FOR_PANELS + 1))
    columns = np.column_stack([factor.solve(column) for column in right.T])
    assert np.abs(factor.solve(right) - columns).max() < 1e-12 * np.abs(columns).max()


@pytest.mark.parametrize('pivot', [0.0, 1e-14])
def test_pivots_outside_their_front_are_found_as_well(model: GearModel, pivot: float) -> None:
    # Each pair of nodes at the ends of a bar changes places: nothing but that is on the diagonal.
    pattern = model.pattern
    pairs = model.ends[pattern.plain]
    for first, second in pairs:
        data = np.where(on_diagonal(model), 1.0, 0.0)
        columns = np.repeat(np.arange(pattern.dof), np.diff(pattern.indptr))
        for axis in range(3):
            a, b = 3 * first + axis, 3 * second + axis
            data[(pattern.indices == a) & (columns == a)] = pivot
            data[(pattern.indices == b) & (columns == b)] = pivot
            data[(pattern.indices == a) & (columns == b)] = 1.0
            data[(pattern.indices == b) & (columns == a)] = 1.0
        right = np.arange(1.0, model.dof + 1)
        left = pattern.matrix(data) @ factorised(pattern, data).solve(right) - right
        assert np.abs(left).max() < 1e-9


def test_a_singular_matrix_is_told(model: GearModel) -> None:
    with pytest.raises(RuntimeError, match='singular'):
        factorised(model.pattern, np.zeros(len(model.pattern.indices)))


def test_refinement_solves_to_rounding(model: GearModel, rng: np.random.Generator) -> None:
    data, right = gear_like(model, rng), rng.normal(size=(model.dof, 2))
    solution = solve_refined(factorised(model.pattern, data), right)
    assert np.abs(model.pattern.matrix(data) @ solution - right).max() < 1e-13
