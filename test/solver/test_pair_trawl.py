"""Two ships tow a net without boards: the warps hold its wings apart."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import GearError, NoSteadyState
from trawl_ros.estimation.planning.plan import plan_for
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.assembly import block_forces, board_loads, forces, linearised
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.numerics import STEP
from trawl_ros.records.observables import Observables
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.equilibrium import SteadyState, steady_state
from trawl_ros.solver.trim import trim

WARP, SPEED = 300.0, 1.5


def apart(gear: GearRecord, distance: float, plate: float = 60.0) -> GearRecord:
    data = gear.model_dump(exclude={'board'})
    data['pair'] = {'distance_m': distance, 'plate_mass_kg': plate}
    return GearRecord.model_validate(data)


@pytest.fixture(scope='module')
def steady(pair_gear: GearRecord) -> SteadyState:
    return steady_state(build_model(pair_gear), WARP, SPEED)


def seen(
    gear: GearRecord, warp: float | tuple[float, float] = WARP, speed: float = SPEED
) -> Observables:
    return steady_state(build_model(gear), warp, speed).observables


def test_plates_lie_between_ships_and_wings(steady: SteadyState) -> None:
    o = steady.observables
    assert 2 * o.horizontal_opening < o.door_spread < 0.5 * 200.0
    assert o.port_divergence == pytest.approx(o.starboard_divergence, rel=1e-6)
    # The warps run inward, nearly straight from block to plate.
    inward = np.arctan2(0.5 * (200.0 - o.door_spread), WARP)
    assert -o.port_divergence == pytest.approx(inward, rel=0.06)


def test_plates_turn_over_where_the_upper_bridle_is_the_heavier_one() -> None:
    tank = build_model(load_gear('flume_83_112').refined(net=0.4))
    turned = steady_state(tank, 250.0, 1.2)
    assert turned.stability.stable
    assert abs(np.degrees(turned.observables.port_roll)) > 90.0
    # So does the tow begin.
    at_start = Simulation(tank, Command(250.0, 250.0, 1.2)).truth()
    opening = turned.observables.vertical_opening
    assert at_start.net.vertical_opening == pytest.approx(opening, rel=1e-6)


def test_ships_pull_what_water_and_weight_do_not_carry(
    steady: SteadyState, pair_gear: GearRecord
) -> None:
    model, found = build_model(pair_gear), steady.equilibrium
    pull = block_forces(model, found.state, found.tow)
    across, down = pull[:, 1].sum(), -pull[:, 2].sum()
    assert abs(across) < 1e-3 * np.abs(pull[:, 1]).max()
    # Nothing but the plates' weight acts on them: no lift, no drag.
    loads = board_loads(model, found.state)
    weight = 60.0 * (1 - model.water.density / 7850.0) * model.water.gravity
    assert loads[:, 2] == pytest.approx([-weight, -weight], rel=1e-3)
    assert np.abs(loads[:, :2]).max() < 1e-9
    assert down > 0.0


def test_more_distance_opens_the_mouth_and_lifts_the_net(
    steady: SteadyState, pair_gear: GearRecord
) -> None:
    near, far = steady.observables, seen(apart(pair_gear, 300.0))
    assert far.horizontal_opening > 1.05 * near.horizontal_opening
    assert far.vertical_opening < near.vertical_opening
    assert far.net_depth < near.net_depth


def test_more_warp_and_heavier_plates_sink_the_net_and_speed_lifts_it(
    steady: SteadyState, pair_gear: GearRecord
) -> None:
    o = steady.observables
    assert seen(pair_gear, warp=400.0).net_depth > 1.1 * o.net_depth
    assert seen(apart(pair_gear, 200.0, plate=400.0)).net_depth > 1.02 * o.net_depth
    fast = seen(pair_gear, speed=1.1 * SPEED)
    assert fast.net_depth < o.net_depth
    assert 1.1**1.6 < fast.warp_tension / o.warp_tension < 1.1**2.0


def test_a_shorter_warp_carries_more(pair_gear: GearRecord) -> None:
    o = seen(pair_gear, warp=(295.0, 300.0))
    assert o.port_tension > o.starboard_tension


def test_slopes_are_those_of_the_forces(steady: SteadyState, pair_gear: GearRecord) -> None:
    model, found = build_model(pair_gear), steady.equilibrium
    step = np.random.default_rng(5).normal(size=model.dof)
    here = linearised(model, found.state, found.tow)
    exact = forces(model, found.state.moved(1j * STEP * step), found.tow).imag / STEP
    slope = -model.pattern.times(here.stiffness, step)
    assert np.abs(slope - exact).max() < 1e-9 * np.abs(exact).max()


def test_ships_too_far_apart_are_refused(pair_gear: GearRecord) -> None:
    with pytest.raises(NoSteadyState, match='ships 1000 m apart'):
        seen(apart(pair_gear, 1000.0))


def test_what_needs_boards_says_so(pair_gear: GearRecord) -> None:
    with pytest.raises(GearError, match='no boards'):
        trim(build_model(pair_gear), attack=0.3, inclination=0.2, warp_length=WARP, speed=SPEED)
    with pytest.raises(GearError, match='no boards'):
        plan_for(pair_gear)


def test_ships_that_turn_abreast_load_the_outer_warp(pair_gear: GearRecord) -> None:
    start = Command(WARP, WARP, SPEED)
    tow = Simulation(build_model(pair_gear), start, period=0.5)
    tow.command = replace(start, turn_rate=np.radians(0.05))
    for _ in range(120):
        tow.advance()
    truth = tow.truth()
    # To port: the starboard ship has the longer way.
    assert truth.winches[1].tension > 1.02 * truth.winches[0].tension
