from dataclasses import replace

import numpy as np
import pytest

import trawl_ros
from trawl_ros.model.assembly import bar_tensions
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow
from trawl_ros.solver.relax import FORCE_TOLERANCE
from trawl_ros.solver.sensitivity import sensitivities
from trawl_ros.solver.warm_start import warm_start, warm_start_in_parts

AT = OperatingPoint(500.0, 500.0, 2.1)
SAME = 1e-5
"""Distance (m) of nodes and turn of boards within which two searches have found the same root."""


@pytest.fixture(scope='module')
def model() -> GearModel:
    return build_model(trawl_ros.load_gear('kaifuha').refined(net=0.5))


@pytest.fixture(scope='module')
def known(model: GearModel) -> Equilibrium:
    return find_equilibrium(model, AT)


def apart(one: Equilibrium, other: Equilibrium) -> float:
    a, b = one.state, other.state
    return max(
        float(np.abs(a.nodes - b.nodes).max()),
        float(np.abs(a.board_rotations - b.board_rotations).max()),
    )


@pytest.mark.parametrize(
    'point',
    [
        OperatingPoint(520.0, 520.0, 2.1),
        OperatingPoint(400.0, 400.0, 2.1),
        OperatingPoint(500.0, 500.0, 2.05),
        OperatingPoint(501.0, 500.0, 2.1),
    ],
)
def test_a_warm_start_finds_the_root_that_a_cold_one_finds(
    model: GearModel, known: Equilibrium, point: OperatingPoint
) -> None:
    found = warm_start(model, known.state, known.tow, steady_tow(model, point))
    assert found is not None
    assert found[2] < FORCE_TOLERANCE
    assert apart(find_equilibrium(model, point, known), find_equilibrium(model, point)) < SAME


@pytest.mark.parametrize('length', [200.0, 725.0, 1000.0])
def test_far_changes_of_the_warps_are_leapt_over(
    model: GearModel, known: Equilibrium, monkeypatch: pytest.MonkeyPatch, length: float
) -> None:
    point = OperatingPoint(length, length, 2.1)
    cold = find_equilibrium(model, point)
    monkeypatch.setattr(
        'trawl_ros.solver.equilibrium.relax', lambda *_, **__: pytest.fail('drifts')
    )
    assert apart(find_equilibrium(model, point, known, cold=False), cold) < SAME


def test_another_board_is_reached_along_the_tangent(model: GearModel, known: Equilibrium) -> None:
    coefficients = model.coefficients * 1.02
    other = model.with_coefficients(coefficients)
    cold = find_equilibrium(other, AT)
    fresh = replace(known)
    assert fresh.tangent is None
    without = find_equilibrium(other, AT, fresh)
    sensitivities(model, fresh)
    along = find_equilibrium(other, AT, fresh)
    assert apart(without, cold) < SAME
    assert apart(along, cold) < SAME


@pytest.mark.parametrize('longer', [0.75, -0.75])
def test_another_bridle_is_reached_although_it_would_be_slack_or_torn_at_once(
    model: GearModel, known: Equilibrium, longer: float
) -> None:
    sensitivities(model, known)
    (bars,) = [own for name, _, own in model.layout.lines if name == 'port_upper_bridle']
    rest = model.rest.copy()
    rest[bars] *= 1.0 + longer / rest[bars].sum()
    other = replace(model, rest=rest)
    found = warm_start(other, known.state, known.tow, known.tow, known.tangent)
    assert found is not None
    assert found[2] <= FORCE_TOLERANCE
    # What did not pass the lengths on gave up at once, and then took ninety iterations and more.
    assert found[1] < 15
    assert apart(find_equilibrium(other, AT, known, cold=False), find_equilibrium(other, AT)) < SAME


def test_the_tangent_is_that_of_states_found_anew(model: GearModel, known: Equilibrium) -> None:
    sensitivities(model, known)
    tangent = known.tangent
    assert tangent is not None
    step = 1e-3
    moved = find_equilibrium(model, replace(AT, speed=AT.speed + step), known)
    slope = (moved.state.nodes - known.state.nodes).ravel() / step
    expected = tangent.columns[: len(slope), -1]
    assert np.abs(slope - expected).max() < 0.02 * np.abs(expected).max()


@pytest.mark.parametrize('speed', [1.9, 2.3])
def test_bars_that_become_slack_or_taut_do_not_keep_newton_from_its_root(
    model: GearModel, known: Equilibrium, speed: float
) -> None:
    found = find_equilibrium(model, replace(AT, speed=speed), known)
    was, is_now = (bar_tensions(model, e.state, e.tow) > 1.0 for e in (known, found))
    assert (was != is_now).any()
    assert found.iterations <= 12


def test_a_change_from_which_newton_turns_away_is_made_in_parts(
    model: GearModel, known: Equilibrium
) -> None:
    point = OperatingPoint(480.0, 500.0, 2.1)
    way = known.state, known.tow, steady_tow(model, point)
    whole, parts = warm_start(model, *way), warm_start_in_parts(model, *way)
    assert whole is not None
    assert whole[2] > FORCE_TOLERANCE
    assert parts is not None
    assert parts[2] <= FORCE_TOLERANCE
    assert apart(find_equilibrium(model, point, known), find_equilibrium(model, point)) < SAME


def test_a_change_too_large_for_the_tangent_is_left_to_others(
    model: GearModel, known: Equilibrium
) -> None:
    tow = steady_tow(model, OperatingPoint(500.0, 700.0, 2.1))
    assert warm_start(model, known.state, known.tow, tow) is None
