"""A gear from a published net plan, to which nothing was tuned, has plausible steady states."""

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.state import mirrored
from trawl_ros.records.channels import INPUTS
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.equilibrium import SteadyState, steady_state
from trawl_ros.solver.predict import Predictor
from trawl_ros.solver.sensitivity import sensitivities


@pytest.fixture(scope='module')
def planned() -> GearModel:
    return build_model(load_gear('krill_800').refined(net=0.4))


@pytest.fixture(scope='module')
def steady(planned: GearModel) -> SteadyState:
    return steady_state(planned, 500.0, 1.2)


def test_it_is_found_cold_and_works_within_its_boards_law(
    planned: GearModel, steady: SteadyState
) -> None:
    seen = steady.observables
    assert 10.0 < np.degrees(seen.port_attack) < 22.0
    assert 60.0 < seen.door_spread < 130.0
    assert 10.0 < seen.vertical_opening < 40.0
    assert seen.net_depth > seen.port_door_depth
    assert steady.stability.stable


def test_it_is_its_own_mirror_image(planned: GearModel, steady: SteadyState) -> None:
    seen = steady.observables
    assert seen.port_tension == pytest.approx(seen.starboard_tension, rel=1e-6)
    assert seen.port_door_depth == pytest.approx(seen.starboard_door_depth, rel=1e-6)
    nodes = steady.equilibrium.state.nodes
    apart = np.linalg.norm(nodes[:, None] * [1.0, -1.0, 1.0] - nodes[None], axis=2)
    twin = apart.argmin(axis=1)
    image = mirrored(steady.equilibrium.state, twin)
    np.testing.assert_allclose(image.nodes, nodes, atol=1e-3)


def test_speed_and_warp_do_what_they_do_at_sea(planned: GearModel, steady: SteadyState) -> None:
    slow, start = steady.observables, steady.equilibrium
    fast = steady_state(planned, 500.0, 1.4, start=start).observables
    long = steady_state(planned, 600.0, 1.2, start=start).observables
    assert fast.net_depth < slow.net_depth < long.net_depth
    assert fast.vertical_opening < slow.vertical_opening
    assert fast.warp_tension > slow.warp_tension
    assert long.door_spread > slow.door_spread


def test_weights_at_the_wing_tips_open_and_sink_it(steady: SteadyState) -> None:
    gear = load_gear('krill_800').refined(net=0.4)
    more = tuple(
        item.model_copy(update={'weight_in_water_n': 2.0 * item.weight_in_water_n})
        if item.name == 'front weight'
        else item
        for item in gear.hung
    )
    heavy = build_model(gear.model_copy(update={'hung': more}))
    seen = steady_state(heavy, 500.0, 1.2, start=steady.equilibrium).observables
    assert seen.vertical_opening > steady.observables.vertical_opening
    assert seen.net_depth > steady.observables.net_depth


def test_its_coefficients_are_corrections_that_a_fit_can_move(planned: GearModel) -> None:
    predictor = Predictor(planned)
    assert not planned.coefficients.any()
    changed = np.zeros(12)
    changed[3] = 0.1
    more_lift = steady_state(planned.with_coefficients(changed), 500.0, 1.2).observables
    assert more_lift.door_spread > steady_state(predictor.model, 500.0, 1.2).observables.door_spread


@pytest.mark.parametrize('name', ['c1', 'c2', 'c6', 'speed'])
def test_sensitivities_hold_for_a_board_that_follows_a_table(
    planned: GearModel, steady: SteadyState, name: str
) -> None:
    """Slopes of spread and depth by a correction to the table, against states solved anew."""
    column = sensitivities(planned, steady.equilibrium)[:, (*COEFFICIENTS, *INPUTS).index(name)]
    h, seen = 1e-3, []
    for change in (h, -h):
        values = np.zeros(12)
        if name != 'speed':
            values[(*COEFFICIENTS, *INPUTS).index(name)] = change
        speed = 1.2 + (change if name == 'speed' else 0.0)
        model = planned.with_coefficients(values)
        found = steady_state(model, 500.0, speed, start=steady.equilibrium).observables
        seen.append(found.array())
    slope = (seen[0] - seen[1]) / (2 * h)
    for quantity in ('door_spread', 'port_door_depth', 'port_tension', 'port_attack'):
        k = OBSERVABLES.index(quantity)
        assert column[k] == pytest.approx(slope[k], rel=2e-3), quantity


def test_it_is_hauled_and_turned_in_time(planned: GearModel) -> None:
    simulation = Simulation(planned, Command(400.0, 400.0, 1.3))
    start = simulation.truth()
    simulation.command = Command(380.0, 380.0, 1.3, turn_rate=np.radians(0.1))
    for _ in range(600):
        simulation.advance()
    later = simulation.truth()
    assert later.winches[0].length == pytest.approx(380.0)
    assert later.doors[0].position[2] > start.doors[0].position[2]
    assert later.vessel.heading == pytest.approx(np.radians(0.1 * 60), rel=0.1)
    assert 0.5 < later.net.vertical_opening / start.net.vertical_opening < 1.5
    # Half of the mouth's points are the headrope's, whatever nodes the footrope has.
    half = len(later.net.mouth) // 2
    assert len(planned.layout.headrope) == half
    np.testing.assert_allclose(later.net.mouth[half // 2], later.net.sonar_position)
