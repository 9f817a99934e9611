"""What instruments are told of a state: frames, signs and units."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from trawl_ros.model.assembly import bar_tensions
from trawl_ros.model.gear_model import GearModel
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.reading import quaternion_of
from trawl_ros.simulation.simulation import Simulation, tow_of


@pytest.fixture(scope='module')
def simulation(model: GearModel) -> Simulation:
    return Simulation(model, Command(500.0, 500.0, 2.1), heading=0.7)


def test_doors_are_upright_lean_outward_and_lift_outward(simulation: Simulation) -> None:
    truth = simulation.truth()
    ahead = np.array([np.cos(0.7), np.sin(0.7), 0.0])
    port = np.array([-np.sin(0.7), np.cos(0.7), 0.0])
    for door, outward in zip(truth.doors, (1.0, -1.0), strict=True):
        turn = Rotation.from_quat(door.orientation).as_matrix()
        assert turn[2, 2] == pytest.approx(np.cos(door.inclination))
        # Leading edges point outward, away from the net.
        assert turn[:, 0] @ ahead > 0.8
        assert outward * (turn[:, 0] @ port) > 0.1
        force = turn @ door.force
        assert outward * (force @ port) > 1e4
        assert force @ ahead < 0.0
        np.testing.assert_allclose(turn @ door.velocity, 2.1 * ahead, atol=1e-9)
        np.testing.assert_allclose(door.angular_velocity, 0.0, atol=1e-9)
    port_door, starboard_door = truth.doors
    np.testing.assert_allclose(port_door.force * [1, -1, 1], starboard_door.force, rtol=1e-6)
    np.testing.assert_allclose(port_door.moment * [-1, 1, -1], starboard_door.moment, rtol=1e-6)


def test_the_sonar_looks_forward_with_x_down_and_y_to_port(simulation: Simulation) -> None:
    turn = Rotation.from_quat(simulation.truth().net.sonar_orientation).as_matrix()
    down, port, forward = turn.T
    assert down[2] < -0.5
    assert port @ [-np.sin(0.7), np.cos(0.7), 0.0] > 0.999
    assert forward @ [np.cos(0.7), np.sin(0.7), 0.0] > 0.5


def test_the_mouth_runs_along_the_headrope_and_back_along_the_footrope(
    simulation: Simulation,
) -> None:
    truth = simulation.truth().net
    count = len(truth.mouth) // 2
    head, foot = truth.mouth[:count], truth.mouth[count:]
    port = np.array([-np.sin(0.7), np.cos(0.7), 0.0])
    assert (np.diff(head @ port) < 0.0).all()
    assert (np.diff(foot @ port) > 0.0).all()
    assert -head[count // 2, 2] == pytest.approx(truth.headrope_depth)
    assert head[count // 2, 2] - foot[count // 2, 2] == pytest.approx(truth.vertical_opening)
    np.testing.assert_array_equal(truth.sonar_position, head[count // 2])


def test_the_picture_shows_every_bar_with_its_tension(simulation: Simulation) -> None:
    model, now = simulation.model, simulation.now
    picture = simulation.picture()
    names = {line.name for line in picture.lines}
    assert {
        'port_warp',
        'starboard_warp',
        'headrope',
        'footrope',
        'netting',
        'codend',
        'port_upper_bridle',
        'starboard_lower_bridle',
    } <= names
    drawn = np.concatenate([bars for _, _, bars in model.layout.lines])
    np.testing.assert_array_equal(np.sort(drawn), np.arange(len(model.ends)))
    warp = next(line for line in picture.lines if line.name == 'port_warp')
    tensions = bar_tensions(model, now.motion.state, tow_of(model, now.ship, now.winches))
    assert warp.tension == pytest.approx(tensions[: model.warp_segments].mean())
    assert len(warp.points) == model.warp_segments + 1


def test_a_quaternion_is_that_of_its_rotation_with_the_scalar_not_negative():
    turns = Rotation.random(200, random_state=3).as_matrix()
    halves = [np.diag(signs) for signs in ((1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0))]
    for turn in (*turns, *halves, np.eye(3)):
        quaternion = quaternion_of(turn)
        assert quaternion[3] >= 0.0
        assert np.allclose(Rotation.from_quat(quaternion).as_matrix(), turn, atol=1e-12)
