"""A tow in time: it starts steady, obeys, settles, and is the same every time."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState, ScenarioError
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.truth import Truth
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.equilibrium import steady_state

START = Command(500.0, 500.0, 2.1)


def advance(simulation: Simulation, instants: int) -> Truth:
    for _ in range(instants):
        simulation.advance()
    return simulation.truth()


def numbers(truth: Truth) -> np.ndarray:
    """Every number of a truth."""
    parts: list[np.ndarray] = []

    def collect(value: object) -> None:
        if isinstance(value, tuple):
            for part in value:
                collect(part)
        elif hasattr(value, '__dataclass_fields__'):
            for part in vars(value).values():
                collect(part)
        else:
            parts.append(np.ravel(np.asarray(value, float)))

    collect(truth)
    return np.concatenate(parts)


def test_it_starts_in_the_equilibrium_of_its_command_and_stays_there(model: GearModel) -> None:
    simulation = Simulation(model, START, heading=0.4, stamp=1_000)
    first = simulation.truth()
    wanted = steady_state(model, 500.0, 2.1).observables
    assert first.stamp == 1_000
    assert -first.doors[0].position[2] == pytest.approx(wanted.port_door_depth, rel=1e-6)
    assert first.winches[1].tension == pytest.approx(wanted.starboard_tension, rel=1e-6)
    later = advance(simulation, 50)
    assert later.stamp == 1_000 + 5_000_000_000
    assert later.net.headrope_depth == pytest.approx(first.net.headrope_depth, abs=1e-3)
    np.testing.assert_allclose(
        later.vessel.position, 10.5 * np.array([np.cos(0.4), np.sin(0.4), 0.0]), atol=1e-9
    )


def test_the_same_commands_give_the_same_bits_also_after_a_reset(model: GearModel) -> None:
    def tow(simulation: Simulation) -> list[np.ndarray]:
        simulation.command = Command(503.0, 498.0, 2.2, 0.002)
        return [numbers(advance(simulation, 5)) for _ in range(6)]

    def same(found: list[np.ndarray], expected: list[np.ndarray]) -> None:
        # The number of points of the net's section changes along the tow.
        for here, there in zip(found, expected, strict=True):
            np.testing.assert_array_equal(here, there)

    simulation = Simulation(model, START)
    one = tow(simulation)
    simulation.reset()
    same(one, tow(simulation))
    same(one, tow(Simulation(model, START)))


def test_the_winches_haul_at_their_speed_and_the_gear_follows(model: GearModel) -> None:
    simulation = Simulation(model, START)
    before = simulation.truth()
    simulation.command = replace(START, port_length=492.0, starboard_length=492.0)
    hauling = advance(simulation, 100)
    limit = model.gear.winch.max_speed_m_s
    for winch, first in zip(hauling.winches, before.winches, strict=True):
        assert winch.speed == pytest.approx(-limit)
        assert winch.tension > 1.01 * first.tension
    hauled = advance(simulation, 200)
    assert [(winch.length, winch.speed) for winch in hauled.winches] == [(492.0, 0.0)] * 2


def test_after_a_haul_it_settles_in_the_equilibrium_of_the_new_length(model: GearModel) -> None:
    simulation = Simulation(model, START, period=0.5)
    before = simulation.truth()
    simulation.command = replace(START, port_length=485.0, starboard_length=485.0)
    after = advance(simulation, 2 * 1600)
    wanted = steady_state(model, 485.0, 2.1).observables
    for was, found, expected in (
        (-before.doors[0].position[2], -after.doors[0].position[2], wanted.port_door_depth),
        (before.winches[0].tension, after.winches[0].tension, wanted.port_tension),
        (before.net.headrope_depth, after.net.headrope_depth, wanted.net_depth),
    ):
        assert abs(found - expected) < 0.05 * abs(was - expected)


def test_in_a_turn_the_gear_cuts_the_corner(model: GearModel) -> None:
    simulation = Simulation(model, START)
    simulation.command = replace(START, turn_rate=np.radians(0.2))
    truth = advance(simulation, 600)
    assert truth.vessel.yaw_rate == pytest.approx(np.radians(0.2))
    # She turns to port: the starboard block leads and pulls harder.
    assert truth.winches[1].tension > 1.001 * truth.winches[0].tension
    astern = truth.net.sonar_position - truth.vessel.position
    left = np.array([-np.sin(truth.vessel.heading), np.cos(truth.vessel.heading), 0.0])
    assert astern @ left > 50.0


def test_it_does_not_start_where_there_is_no_steady_state(model: GearModel) -> None:
    with pytest.raises(NoSteadyState, match=r'warp 500 m at 0\.5 m/s'):
        Simulation(model, Command(500.0, 500.0, 0.5))
    with pytest.raises(ScenarioError, match=r'0\.01 rad/s'):
        Simulation(model, Command(500.0, 500.0, 2.1, 0.01))
