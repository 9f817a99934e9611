"""The pieces that the benchmark measures with do what they claim."""

import os
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.lab.benchmark.fit import plant_of, trial
from trawl_ros.lab.benchmark.fit_rivals import CoordinateSearch, Counting, FiniteDifferencePredictor
from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.benchmark.growth import exponent
from trawl_ros.lab.benchmark.haul import WATCHED, Ride, error, haul_of
from trawl_ros.lab.running.timing import NO_BYTECODE, bytecode_kept, shares, timed
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import sensitivities


@pytest.fixture(scope='module')
def coarse():
    gear = default_gear(quick=True)
    model = build_model(gear)
    return SimpleNamespace(gear=gear, model=model, prior=board_prior(gear))


def test_the_exponent_is_the_slope_of_a_power_law():
    nodes = [100, 300, 1000, 3000]
    assert exponent(nodes, [1e-6 * n**1.48 for n in nodes]) == pytest.approx(1.48)


def test_an_error_is_the_largest_at_any_time_of_any_observable():
    converged = np.tile(np.linspace(100.0, 110.0, 6)[:, None], len(WATCHED))
    seen = converged.copy()
    seen[3, WATCHED.index('net_depth')] += 0.5
    found = error(Ride(seen, 1.0, 0), Ride(converged, 1.0, 0))
    assert found.worst == 'net_depth'
    assert found.of_range == pytest.approx(0.05)
    assert found.of_value == pytest.approx(0.5 / 105.0)


def test_the_clock_counts_work_and_no_waiting():
    result, seconds = timed(lambda: sum(range(300_000)))
    assert result == 299_999 * 150_000
    assert seconds > 0.0


def test_bytecode_is_kept_while_processes_are_measured_and_then_as_before(monkeypatch):
    monkeypatch.setenv(NO_BYTECODE, '1')
    with bytecode_kept('json'):
        assert NO_BYTECODE not in os.environ
    assert os.environ[NO_BYTECODE] == '1'


def test_shares_of_functions_add_up_and_hold_what_those_call(coarse):
    def twice() -> None:
        for _ in range(2):
            find_equilibrium(coarse.model, OperatingPoint(500.0, 500.0, 2.1))

    parts = {'searches': find_equilibrium, 'never called': sensitivities}
    told = dict(part.rsplit(' ', 2)[:2] for part in shares(twice, parts).split(', '))
    assert list(told) == ['searches', 'never called', 'the rest']
    assert sum(map(int, told.values())) == pytest.approx(100, abs=1)
    assert int(told['searches']) > 90
    assert told['never called'] == '0'


def test_shorter_steps_of_the_haul_come_closer_to_the_converged_run(coarse):
    haul = haul_of(coarse.model, 8.0)
    converged = haul.run(0.05, 0.05)
    assert len(converged.seen) == 160
    rides = [haul.run(step) for step in (0.25, 0.75)]
    # Steps of 0.75 s do not divide 2 s: they are looked at, and held against, each 2.25 s.
    assert [(ride.every_s, len(ride.seen)) for ride in rides] == [(2.0, 4), (2.25, 3)]
    errors = [np.abs(ride.seen - converged.at_steps_of(ride)).max(axis=0) for ride in rides]
    assert (errors[0] <= errors[1]).all()


def test_differences_are_derivatives_and_cost_a_solution_each(coarse):
    exact, differences = (
        Counting(coarse.model),
        FiniteDifferencePredictor(coarse.model, coarse.prior.std),
    )
    at = (coarse.model.coefficients, 500.0, 500.0, 2.1)
    known = exact.predict(*at)
    found = differences.predict(*at, known.state)
    assert (exact.solves, differences.solves) == (1, 1 + known.jacobian.shape[1])
    size = np.abs(known.jacobian).max(axis=0)
    # Forward differences err by the curvature over a step: 1.4e-3, and half of it at half the step.
    assert (np.abs(found.jacobian - known.jacobian) / size).max() < 2e-3


def test_the_search_lowers_the_objective_within_bounds_and_budget(coarse):
    windows = trial(plant_of(coarse.gear), (500.0,), (2.1,))
    search = CoordinateSearch(coarse.model, windows, coarse.prior)
    at_start = search.search(target=np.inf, budget=1)
    assert (at_start.solves, at_start.reached) == (1, True)
    found = CoordinateSearch(coarse.model, windows, coarse.prior).search(target=0.0, budget=12)
    assert found.objective < at_start.objective
    assert found.solves == 12
    assert not found.reached
