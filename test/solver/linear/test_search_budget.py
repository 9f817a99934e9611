"""Gears that are valid and absurd are refused in a sentence and in bounded time."""

import time
from contextlib import suppress

import numpy as np
import pytest

from trawl_ros.core.errors import GearError, NoSteadyState
from trawl_ros.core.schema import validated
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import find_equilibrium, steady_state
from trawl_ros.solver.linear import factor, search_budget
from trawl_ros.solver.operating_point import OperatingPoint


def changed(gear, key, value):
    """Gear with one number changed; keys of lists are their places."""
    data = gear.model_dump()
    *steps, last = [int(step) if step.isdigit() else step for step in key.split('.')]
    place = data
    for step in steps:
        if isinstance(place[step], tuple):
            place[step] = list(place[step])
        place = place[step]
    place[last] = value
    return validated(GearRecord, data, 'gear.yaml', GearError)


@pytest.fixture(scope='module')
def gear():
    return load_gear('kaifuha').refined(net=0.5)


@pytest.mark.parametrize(
    ('key', 'value'),
    [
        ('warp.stiffness_n', 1e17),
        ('warp.stiffness_n', 1.0),
        ('bridle.length_m', 12_000.0),
        ('headrope.weight_in_water_n_m', -1e6),
        ('netting.body.0.mesh_m', 1e-4),
        ('netting.body.0.length_m', 1e5),
        ('kite.area_m2', 1e4),
        ('board.fastening.warp_m', (1e5, 0.0, 0.0)),
        ('board.coefficients.a1', 1e17),
        ('clump.density_kg_m3', 1e9),
    ],
)
def test_numbers_that_no_gear_has_are_refused(gear, key, value):
    with pytest.raises(GearError, match=rf'gear.yaml: .*{key.rpartition(".")[2]}'):
        changed(gear, key, value)


@pytest.mark.slow
@pytest.mark.parametrize(
    ('key', 'value'),
    [
        ('warp.stiffness_n', 1e10),
        ('warp.stiffness_n', 1e3),
        ('warp.weight_in_water_n_m', -1000.0),
        ('kite.area_m2', 1000.0),
        ('kite.normal_limit', 1e9),
        ('netting.body.0.mesh_m', 0.002),
        ('netting.normal_drag', 1e9),
        ('board.mass_kg', 1e12),
        ('board.area_m2', 1e12),
        ('board.coefficients.a1', -10.0),
        ('clump.weight_in_water_n', 1e9),
    ],
)
def test_gears_at_the_bounds_are_answered_in_time(gear, key, value):
    began = time.thread_time()
    extreme = changed(gear, key, value)
    with suppress(NoSteadyState, GearError):
        steady_state(build_model(extreme), 500.0, 2.1)
    assert time.thread_time() - began < 40.0


def test_a_search_that_goes_on_for_long_is_given_up(gear):
    budget = search_budget.SearchBudget(max_values=1, min_factorisations=3)
    with search_budget.search_within(budget), pytest.raises(NoSteadyState, match=' 4 '):
        find_equilibrium(build_model(gear), OperatingPoint(500.0, 500.0, 2.1))
    # Outside of a search nothing is counted.
    search_budget.spend(10**12)


@pytest.mark.parametrize('reason', [np.linalg.LinAlgError('not positive'), ZeroDivisionError()])
def test_a_singular_matrix_is_no_steady_state(gear, monkeypatch, reason):
    def refuse(*_):
        raise reason

    monkeypatch.setattr(factor, 'elimination', refuse)
    with pytest.raises(NoSteadyState) as caught:
        steady_state(build_model(gear), 500.0, 2.1)
    assert caught.value.__cause__ is reason


def test_a_matrix_that_stays_singular_is_no_steady_state(gear, monkeypatch):
    def refuse(*_):
        raise RuntimeError('Factor is exactly singular')

    monkeypatch.setattr(factor, 'elimination', refuse)
    with pytest.raises(NoSteadyState):
        steady_state(build_model(gear), 500.0, 2.1)
