"""Sensitivities by the implicit function theorem against states solved anew."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.records.channels import INPUTS
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import SteadyState
from trawl_ros.solver.first_guess import at_velocity
from trawl_ros.solver.operating_point import steady_tow
from trawl_ros.solver.predict import Predictor
from trawl_ros.solver.relax import relax
from trawl_ros.solver.sensitivity import sensitivities

PARAMETERS = (*COEFFICIENTS, *INPUTS)

STEPS = dict.fromkeys(PARAMETERS, 2e-4) | {
    'port_length': 2e-2,
    'starboard_length': 2e-2,
    'speed': 2e-4,
}


@pytest.fixture(scope='module')
def exact(model: GearModel, steady: SteadyState) -> np.ndarray:
    return sensitivities(model, steady.equilibrium)


def solved_anew(model: GearModel, steady: SteadyState, name: str, change: float) -> np.ndarray:
    """Observables of the state with one parameter changed, solved to rounding."""
    found = steady.equilibrium
    point = found.point
    if name in ('port_length', 'starboard_length', 'speed'):
        point = replace(point, **{name: getattr(point, name) + change})
    else:
        values = model.coefficients.copy()
        values[PARAMETERS.index(name)] += change
        model = model.with_coefficients(values)
    tow = steady_tow(model, point)
    start = at_velocity(found.state, tow.block_velocities[0])
    state, _, left = relax(model, start, tow, tolerance=1e-6, time_step=1e9)
    assert left < 1e-6
    return observe(model, state, tow).array()


@pytest.mark.parametrize('name', PARAMETERS)
def test_every_observable_agrees_with_central_differences(
    model: GearModel, steady: SteadyState, exact: np.ndarray, name: str
) -> None:
    h = STEPS[name]
    # Four points: the error of two, with h² of the third derivative, would decide.
    one, two = (
        solved_anew(model, steady, name, step) - solved_anew(model, steady, name, -step)
        for step in (h, 2 * h)
    )
    difference = (8 * one - two) / (12 * h)
    column = exact[:, PARAMETERS.index(name)]
    for observable, found, expected in zip(OBSERVABLES, column, difference, strict=True):
        # Observables have units of their own: each against its own slope, or, where that
        # nearly vanishes, against a thousandth of what its whole value would give.
        value = abs(getattr(steady.observables, observable))
        scale = max(abs(expected), 1e-3 * value)
        assert abs(found - expected) < 1e-4 * scale, (observable, found, expected)


def test_predictions_carry_values_derivatives_and_a_warm_start(
    model: GearModel, steady: SteadyState, exact: np.ndarray
) -> None:
    predictor = Predictor(model)
    first = predictor.predict(model.coefficients, 500.0, 500.0, 2.1)
    np.testing.assert_allclose(first.values, steady.observables.array(), rtol=1e-7, atol=1e-8)
    assert np.abs((first.jacobian - exact) / np.abs(exact).max(axis=0)).max() < 1e-6
    changed = model.coefficients * 1.02
    warm = predictor.predict(changed, 500.0, 500.0, 2.1, first.state)
    cold = predictor.predict(changed, 500.0, 500.0, 2.1)
    np.testing.assert_allclose(warm.values, cold.values, rtol=1e-7, atol=1e-8)
    # To first order the derivatives say what two per cent of every coefficient do.
    expected = first.values + first.jacobian[:, :12] @ (changed - model.coefficients)
    assert abs(warm.values[0] - expected[0]) < 0.1 * abs(warm.values[0] - first.values[0])
