"""Drag of the net and area of its mouth."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.lab.validation.sea.quantities import DERIVED, mouth_area, quantities
from trawl_ros.model.assembly import board_loads
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import SteadyState, steady_state
from trawl_ros.solver.trimming.held_boards import rope_pulls


@pytest.fixture(scope='module')
def model() -> GearModel:
    return build_model(load_gear('krill_1600').refined(net=0.4))


@pytest.fixture(scope='module')
def steady(model: GearModel) -> SteadyState:
    return steady_state(model, 250.0, 1.08)


def test_drag_of_the_net_is_what_the_warps_pull_beside_the_drag_of_the_boards(
    model: GearModel, steady: SteadyState
) -> None:
    found = steady.equilibrium
    pulls = rope_pulls(model, found.state, found.tow)
    loads = board_loads(model, found.state).real[:, :3]
    # Boards are at rest: warps, ropes behind them and water balance.
    assert np.abs(pulls.sum(axis=1) + loads).max() < 1.0
    ahead = pulls[:, 0].sum(axis=0)[0] + loads.sum(axis=0)[0]
    assert quantities(model, steady)['net_drag'] == pytest.approx(ahead, rel=1e-4)
    assert 0.5 < ahead / (2 * steady.observables.warp_tension) < 1.0


def test_the_mouth_lies_within_its_width_and_height_and_grows_with_either(
    model: GearModel, steady: SteadyState
) -> None:
    state = steady.equilibrium.state
    area = mouth_area(model, state)
    rim = state.nodes[model.layout.net]
    width, height = np.ptp(rim[:, 1]), np.ptp(rim[:, 2])
    assert 0.5 * width * height < area < width * height
    wide = replace(state, nodes=state.nodes * np.array([1.0, 2.0, 1.0]))
    assert mouth_area(model, wide) == pytest.approx(2.0 * area)


def test_the_lower_bridle_and_the_angle_are_those_of_the_boards(
    model: GearModel, steady: SteadyState
) -> None:
    derived, seen = quantities(model, steady), steady.observables
    assert set(derived) == set(DERIVED)
    pulls = rope_pulls(model, steady.equilibrium.state, steady.equilibrium.tow)
    lower = float(np.linalg.norm(pulls[0, 2]))
    assert derived['lower_bridle_tension'] == pytest.approx(lower, rel=1e-3)
    assert np.radians(derived['board_attack']) == pytest.approx(seen.port_attack, rel=1e-3)
