"""The Jacobian is exact: it equals the complex step of the forces to rounding."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model.assembly import forces, linearised
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP
from trawl_ros.model.state import State, Tow


def worst_column(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest error of a column relative to that column's largest element."""
    scale = np.abs(expected).max(axis=0)
    return float((np.abs(found - expected).max(axis=0) / np.where(scale > 0, scale, 1.0)).max())


def complex_step(model: GearModel, state: State, tow: Tow) -> tuple[np.ndarray, np.ndarray]:
    k, c = [], []
    for column in np.eye(model.dof):
        step = 1j * STEP * column
        k.append(-forces(model, state.moved(step), tow).imag / STEP)
        c.append(-forces(model, state.with_velocity(state.velocity + step), tow).imag / STEP)
    return np.column_stack(k), np.column_stack(c)


def test_both_matrices_equal_the_complex_step_in_every_column(
    model: GearModel, random_case
) -> None:
    model, state, tow = random_case(model, 1)
    # Bars of all kinds: slack, in the rounding, taut, and of each every fifth one bowed.
    bow = np.where(np.arange(len(model.ends)) % 5 == 0, 1e-9, 0.0)
    model = replace(model, bars=replace(model.bars, bow=bow))
    here = linearised(model, state, tow)
    stiffness, damping = complex_step(model, state, tow)
    assert worst_column(model.pattern.matrix(here.stiffness).toarray(), stiffness) < 1e-11
    assert worst_column(model.pattern.matrix(here.damping).toarray(), damping) < 1e-11


@pytest.mark.parametrize('seed', [1, 2, 4])
def test_forces_are_those_that_were_linearised(model: GearModel, random_case, seed: int) -> None:
    model, state, tow = random_case(model, seed)
    plain, along = forces(model, state, tow), linearised(model, state, tow).force
    assert np.abs(plain - along).max() < 1e-12 * np.abs(plain).max()


def test_central_differences_agree(model: GearModel, random_case) -> None:
    model, state, tow = random_case(model, 3)
    here = linearised(model, state, tow)
    columns = np.concatenate(
        [
            np.random.default_rng(3).choice(3 * model.nodes, 60, replace=False),
            np.arange(3 * model.nodes, model.dof),
        ]
    )
    h, v = 2e-5, 2.5e-4
    k, c = [], []
    for column in np.eye(model.dof)[columns]:
        low, high = (forces(model, state.moved(s * h * column), tow) for s in (-1, 1))
        k.append((low - high) / (2 * h))
        low, high = (
            forces(model, state.with_velocity(state.velocity + s * v * column), tow)
            for s in (-1, 1)
        )
        c.append((low - high) / (2 * v))
    found = model.pattern.matrix(here.stiffness).toarray()[:, columns]
    assert worst_column(found, np.column_stack(k)) < 1e-6
    found = model.pattern.matrix(here.damping).toarray()[:, columns]
    assert worst_column(found, np.column_stack(c)) < 1e-6
