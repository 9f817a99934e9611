"""Derivatives of the observables along many directions are those along one after another."""

from collections.abc import Callable

import numpy as np
import pytest

from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP, stepped
from trawl_ros.model.observables import observe
from trawl_ros.model.slopes.observed import observed_slopes
from trawl_ros.model.state import State, Tow, TowSlopes

DIRECTIONS = 4
Case = tuple[GearModel, State, Tow]


@pytest.fixture
def case(model: GearModel, random_case: Callable[[GearModel, int], Case]) -> Case:
    return random_case(model, 5)


def test_of_places_velocities_and_boundary(case: Case) -> None:
    model, state, tow = case
    rng = np.random.default_rng(6)
    places, velocities = rng.normal(size=(2, model.dof, DIRECTIONS))
    boundary = TowSlopes(
        *rng.normal(size=(2, DIRECTIONS, 2, 3)), *rng.normal(size=(2, DIRECTIONS, 2))
    )
    values, slopes = observed_slopes(*case, places, velocities, boundary)
    assert np.isfinite(slopes).all()
    np.testing.assert_allclose(values, observe(*case).array(), rtol=1e-12)
    for number in range(DIRECTIONS):
        along = state.moved(stepped(np.zeros(model.dof), places[:, number]))
        along = along.with_velocity(stepped(state.velocity, velocities[:, number]))
        parts = ('blocks', 'block_velocities', 'lengths', 'length_rates')
        there = Tow(*(stepped(getattr(tow, p), getattr(boundary, p)[number]) for p in parts))
        expected = observe(model, along, there).array().imag / STEP
        np.testing.assert_allclose(slopes[:, number], expected, rtol=1e-9, atol=1e-9)


def test_what_is_not_given_is_held(case: Case) -> None:
    places = np.random.default_rng(7).normal(size=(case[0].dof, DIRECTIONS))
    still = TowSlopes(*np.zeros((2, DIRECTIONS, 2, 3)), *np.zeros((2, DIRECTIONS, 2)))
    given = observed_slopes(*case, places, np.zeros_like(places), still)[1]
    assert np.array_equal(observed_slopes(*case, places)[1], given)
    assert observed_slopes(*case, places[:, :0])[1].shape == (len(given), 0)
