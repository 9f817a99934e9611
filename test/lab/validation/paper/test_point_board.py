"""A board as a point: constant lift and drag, whatever its attitude and its ropes do."""

import numpy as np
import pytest

from trawl_ros.lab.validation.paper.comparison import point_board, point_observables
from trawl_ros.model.assembly import board_loads, forces
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.first_guess import attitudes
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow

ATTACK, SLIP = np.radians(20.0), np.radians(-4.0)
SPEED = 2.1


@pytest.fixture(scope='module')
def points(model: GearModel) -> GearModel:
    return point_board(model, ATTACK, SLIP)


def towed(model: GearModel, rotations: np.ndarray) -> State:
    """Nodes anywhere, boards at these attitudes, all moving ahead."""
    ahead = np.array([SPEED, 0.0, 0.0])
    still = np.zeros((model.nodes, 3))
    return State(
        nodes=still,
        board_positions=np.array([[0.0, 50.0, -80.0], [0.0, -50.0, -80.0]]),
        board_rotations=rotations,
        node_velocities=still,
        board_velocities=np.tile(ahead, (2, 1)),
        board_rates=np.zeros((2, 3)),
    )


def test_it_has_the_coefficients_of_the_mean_angles(model: GearModel, points: GearModel) -> None:
    load = board_loads(points, towed(points, attitudes(ATTACK, 0.0, 0.0)))
    a1, c1, a2, c2, b3, c3 = model.coefficients[:6]
    pressure = 0.5 * model.water.density * model.board.area * SPEED**2
    drag, lift = a1 * ATTACK + c1, a2 * ATTACK + c2
    span = -(b3 * SLIP + c3)
    heavy = (model.board.mass - model.water.density * model.board.volume) * model.water.gravity
    for side, outward in enumerate((1.0, -1.0)):
        expected = pressure * np.array([-drag, outward * lift, span]) - [0.0, 0.0, heavy]
        np.testing.assert_allclose(load[side, :3], expected, rtol=1e-12)


def test_it_has_no_moment_and_no_attack_angle_of_its_own(points: GearModel) -> None:
    one, other = (
        board_loads(points, towed(points, attitudes(np.radians(yaw), 0.0, 0.0)))
        for yaw in (12.0, 31.0)
    )
    np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(one[:, 3:], 0.0, atol=1e-9)


def test_ropes_do_not_turn_it(model: GearModel, points: GearModel) -> None:
    point = OperatingPoint(500.0, 500.0, SPEED)
    near = find_equilibrium(model, point)
    held = near.state.moved(np.zeros(model.dof))
    moments = forces(points, held, steady_tow(points, point))[3 * points.nodes :].reshape(2, 6)
    np.testing.assert_allclose(moments[:, 3:], 0.0, atol=1e-9)


def test_without_upward_lift_it_sinks_deeper(model: GearModel, points: GearModel) -> None:
    near = find_equilibrium(model, OperatingPoint(500.0, 500.0, SPEED))
    level = point_observables(points, near, ATTACK)
    tipped = point_observables(points, near, ATTACK, lean=np.radians(14.0))
    assert level.port_door_depth == pytest.approx(level.starboard_door_depth, rel=1e-9)
    assert level.door_depth > 1.1 * near.observables.door_depth
    assert tipped.door_depth < 0.9 * level.door_depth
    elsewhere = point_observables(points, near, np.radians(30.0))
    assert elsewhere.door_spread == pytest.approx(level.door_spread, rel=1e-6)
