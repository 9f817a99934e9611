"""A gear behind somebody else's vehicle moves and pulls as behind the project's own ship."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.rotations import about_z, rotation_matrix
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.simulation.tether import Tether, VehicleMotion
from trawl_ros.solver.equilibrium import steady_state

LENGTH, SPEED = 300.0, 2.1
STEP_S = 0.2


def motion(ship, current=0.0):
    return VehicleMotion(
        position=ship.position,
        rotation=about_z(ship.heading),
        velocity=ship.velocity + current,
        rates=np.array([0.0, 0.0, ship.yaw_rate]),
    )


def straight(time_s, *, speed=SPEED, heading=0.0, at=(0.0, 0.0, 0.0)):
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    return VehicleMotion(
        np.array(at) + speed * time_s * ahead, about_z(heading), speed * ahead, np.zeros(3)
    )


def test_towed_steadily_it_pulls_back_and_down_as_the_steady_state_does(model):
    heading = 1.0
    tether = Tether(model, straight(0.0, heading=heading, at=(70.0, -40.0, 0.0)), (LENGTH, LENGTH))
    for number in range(1, 26):
        tether.advance(straight(STEP_S * number, heading=heading, at=(70.0, -40.0, 0.0)), STEP_S)
    steady = steady_state(model, LENGTH, SPEED).observables
    tensions = np.linalg.norm(tether.block_forces(), axis=1)
    assert tensions == pytest.approx([steady.port_tension, steady.starboard_tension], rel=2e-3)
    wrench = tether.wrench()
    assert wrench.force[0] < 0.0
    assert wrench.force[2] < 0.0
    assert wrench.force[1] == pytest.approx(0.0, abs=1e-3 * abs(wrench.force[0]))
    assert np.allclose(wrench.moment, 0.0, atol=1e-3 * abs(wrench.force[0]))


def test_behind_the_same_ship_it_is_the_simulation(model):
    start = Command(LENGTH, LENGTH, SPEED)
    simulation = Simulation(model, start)
    tether = Tether(model, motion(simulation.now.ship), (LENGTH, LENGTH))
    simulation.command = replace(start, speed=2.3, turn_rate=0.01, port_length=303.0)
    tether.wanted = (303.0, LENGTH)
    for _ in range(50):
        simulation.advance()
        simulation.advance()
        tether.advance(motion(simulation.now.ship, model.water.surface_current), STEP_S)
    wanted = [winch.tension for winch in simulation.truth().winches]
    assert np.linalg.norm(tether.block_forces(), axis=1) == pytest.approx(wanted, rel=5e-3)
    assert tether.lengths == pytest.approx([w.length for w in simulation.truth().winches])
    doors = [door.position for door in simulation.truth().doors]
    shown = [door.position for door in tether.picture(0).doors]
    assert np.array(shown) == pytest.approx(np.array(doors), abs=0.05)


def test_long_spans_are_divided(model):
    every, seldom = (Tether(model, straight(0.0), (LENGTH, LENGTH)) for _ in range(2))
    for number in range(1, 11):
        every.advance(straight(STEP_S * number), STEP_S)
    seldom.advance(straight(10 * STEP_S), 10 * STEP_S)
    assert seldom.block_forces() == pytest.approx(every.block_forces(), rel=1e-6)


def test_a_tow_point_astern_turns_the_vehicle_by_its_arm(model):
    behind = Tether(model, straight(0.0), (LENGTH, LENGTH), tow_point=(-30.0, 0.0, 2.0))
    force, moment = behind.wrench().force, behind.wrench().moment
    assert moment[1] == pytest.approx(2.0 * force[0] + 30.0 * force[2], rel=1e-3)


def test_a_speed_at_which_nothing_can_be_towed_is_an_error(model):
    with pytest.raises(NoSteadyState):
        Tether(model, straight(0.0, speed=0.2), (LENGTH, LENGTH))


def test_an_orientation_is_the_rotation_of_its_quaternion():
    turns = Rotation.random(50, random_state=2)
    for quaternion, turn in zip(turns.as_quat(), turns.as_matrix()):
        assert np.allclose(rotation_matrix(quaternion), turn)
