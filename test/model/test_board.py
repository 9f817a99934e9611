"""The board's law against a plain evaluation of eq. 1-14, and its behaviour beyond it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model.board import (
    Board,
    flow_at,
    hydrodynamics,
    own_load,
)
from trawl_ros.model.board_law import LAW_RANGE
from trawl_ros.model.board_laws import EQ14
from trawl_ros.model.gear_model import OUTWARD, GearModel, build_board
from trawl_ros.model.numerics import STEP
from trawl_ros.model.rotations import about_axis, rotation
from trawl_ros.model.water import Water

DENSITY = 1025.0
PRINTED = np.array([1.19, 0.041, 2.47, 0.67, -0.3, 0.01, -0.46, 0.02, 0.24, 0.016, 0.92, 0.25])
"""Eq. 37 in the order of eq. 36."""


@pytest.fixture(scope='module')
def board(gear) -> Board:
    return build_board(gear)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def plain_load(board: Board, side: float, turn, velocity, rate) -> tuple[list, list, float, float]:
    """Eq. 1-4 and 12-14 for one board, written out number by number, in fixed axes.

    The board's axes are n_x ahead, n_y outward, n_z up; the starboard ones (side = -1) are
    left-handed, in which a moment's vector turns the other way round. Loads act aft, outward, down.
    """
    axes = [turn[:, 0].tolist(), (side * turn[:, 1]).tolist(), turn[:, 2].tolist()]
    mean = [sum(board.points[k][i] for k in range(3)) / 3 for i in range(3)]
    arm = [sum(mean[i] * axes[i][j] for i in range(3)) for j in range(3)]
    swing = cross(rate, arm)
    relative = [-velocity[j] - swing[j] for j in range(3)]  # still water, eq. 4
    ux, uy, uz = (sum(relative[j] * axes[i][j] for j in range(3)) for i in range(3))  # eq. 3
    alpha = math.asin(uy / math.sqrt(ux**2 + uy**2))  # eq. 1
    beta = math.asin(uz / math.sqrt(ux**2 + uz**2))  # eq. 2
    a1, c1, a2, c2, b3, c3, a4, c4, b5, c5, a6, c6 = PRINTED
    pressure = DENSITY * 12.0 * (ux**2 + uy**2 + uz**2) / 2
    along = [ux / math.hypot(ux, uy), uy / math.hypot(ux, uy)]
    across = [along[1], -along[0]]
    drag, lift = a1 * alpha + c1, a2 * alpha + c2
    force = [
        pressure * (drag * along[0] + lift * across[0]),
        pressure * (drag * along[1] + lift * across[1]),
        -pressure * (b3 * beta + c3),
    ]
    b, chord = 5.63, 2.13
    moment = [
        -pressure * (a4 * alpha + c4) * b,
        pressure * (b5 * beta + c5) * math.sqrt(b**2 + chord**2),
        -pressure * (a6 * alpha + c6) * chord,
    ]
    fixed_force = [sum(force[i] * axes[i][j] for i in range(3)) for j in range(3)]
    fixed_moment = [side * sum(moment[i] * axes[i][j] for i in range(3)) for j in range(3)]
    return fixed_force, fixed_moment, alpha, beta


@pytest.mark.parametrize('seed', range(8))
def test_loads_equal_a_plain_evaluation_within_the_law(board: Board, seed: int) -> None:
    random = np.random.default_rng(seed)
    water = Water(density=DENSITY, gravity=0.0)
    board = replace(board, rotary_slope=0.0, inertia=np.zeros((3, 3)))
    yaw = random.uniform(np.radians(3.0), np.radians(35.0))
    lean = rotation(random.normal(0.0, 0.04, (2, 3)))
    turns = lean @ np.stack([about_axis(2, side * yaw) for side in OUTWARD])
    velocity = np.array([2.2, 0.0, 0.0]) + random.normal(0.0, 0.02, (2, 3))
    rate = random.normal(0.0, 0.02, (2, 3))
    position = np.tile([0.0, 0.0, -100.0], (2, 1))
    load = own_load(board, PRINTED, OUTWARD, position, turns, velocity, rate, water)
    flow = flow_at(board, OUTWARD, position, turns, velocity, rate, water)
    for k, side in enumerate(OUTWARD):
        force, moment, alpha, beta = plain_load(board, side, turns[k], velocity[k], rate[k])
        assert LAW_RANGE[0] < alpha < LAW_RANGE[1]
        assert flow.attack[k] == pytest.approx(alpha, rel=1e-12)
        assert flow.slip[k] == pytest.approx(beta, rel=1e-12)
        np.testing.assert_allclose(load[k, :3], force, rtol=1e-11, atol=1e-8)
        np.testing.assert_allclose(load[k, 3:], moment, rtol=1e-11, atol=1e-8)


def test_the_gear_file_has_the_printed_coefficients_and_table_1(
    model: GearModel, board: Board
) -> None:
    np.testing.assert_array_equal(model.coefficients, PRINTED)
    assert (board.mass, board.volume, board.area) == (2600.0, 0.33, 12.0)
    np.testing.assert_allclose(board.levers, [5.63, np.hypot(5.63, 2.13), 2.13])
    np.testing.assert_array_equal(
        board.inertia, [[7528.0, -56.3, 0.0], [-56.3, 8489.0, 0.0], [0.0, 0.0, 1143.0]]
    )


def directions(count: int, seed: int = 0) -> np.ndarray:
    flow = np.random.default_rng(seed).normal(size=(count, 3))
    return flow / np.linalg.norm(flow, axis=1)[:, None]


def load_in_flow(board: Board, values: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """Force and moment (..., 6) in the outward frame of a port board in a flow (..., 3)."""
    shape = flow.shape[:-1]
    zero = np.zeros((*shape, 3))
    args = (np.ones(shape), zero, np.broadcast_to(np.eye(3), (*shape, 3, 3)), -flow, zero)
    force, moment = hydrodynamics(board, values, flow_at(board, *args, Water()))
    return np.concatenate([force, moment], -1)


def test_water_never_drives_a_board_whatever_way_it_comes(board: Board) -> None:
    flow = directions(20_000)
    power = np.einsum('ij,ij->i', load_in_flow(board, PRINTED, flow)[:, :3], flow)
    assert power.min() > 0.0


def test_lift_and_moments_fade_outside_the_law_and_drag_does_not(board: Board) -> None:
    inside = EQ14(PRINTED, np.radians(20.0), 0.0)
    for attack in (-60.0, -120.0, 100.0, 170.0):
        beyond = EQ14(PRINTED, np.radians(attack), 0.0)
        np.testing.assert_array_equal(beyond[[1, 3, 5]], 0.0)
        assert beyond[0] > inside[0]


def test_loads_are_smooth_in_the_direction_of_the_flow(board: Board) -> None:
    # Flow along the span has no direction in the board's plane: eq. 12 cannot be smooth there.
    turn = np.linspace(0.1, 0.1 + 2 * np.pi, 20_001)
    for axis, rise in ((2, 0.1), (2, 0.7), (2, -0.4), (1, 0.3)):
        plane = [i for i in range(3) if i != axis]
        flow = np.empty((len(turn), 3))
        flow[:, plane[0]], flow[:, plane[1]] = np.cos(turn), np.sin(turn)
        flow[:, axis] = rise
        load = load_in_flow(board, PRINTED, flow)
        # A jump of the load by the whole circle's slope would show as 1e4 times this.
        slope = np.abs(np.diff(load, axis=0)).max(axis=0) / (turn[1] - turn[0])
        assert (slope < 30.0 * np.ptp(load, axis=0)).all()


def test_derivatives_are_finite_and_right_at_every_angle(board: Board) -> None:
    flow = directions(3000, seed=4)
    h = 1e-6
    for axis in range(3):
        step = np.eye(3)[axis]
        exact = load_in_flow(board, PRINTED, flow + 1j * STEP * step).imag / STEP
        low, high = (load_in_flow(board, PRINTED, flow + s * h * step) for s in (-1, 1))
        assert np.isfinite(exact).all()
        error = np.abs(exact - (high - low) / (2 * h)).max(axis=1)
        # At a few corners of second derivatives the difference spans two branches.
        assert np.quantile(error / np.abs(exact).max(), 0.99) < 1e-6


def test_a_starboard_board_is_the_mirror_image_of_a_port_board(board: Board) -> None:
    random = np.random.default_rng(9)
    flip = np.array([1.0, -1.0, 1.0])
    turn = rotation(random.normal(0.0, 2.0, 3))
    velocity, rate = random.normal(0.0, 2.0, (2, 3))
    water = Water(density_gradient=0.01)
    position = np.array([0.0, 0.0, -80.0])
    port = own_load(board, PRINTED, np.array(1.0), position, turn, velocity, rate, water)
    starboard = own_load(
        board,
        PRINTED,
        np.array(-1.0),
        position,
        flip[:, None] * turn * flip,
        velocity * flip,
        -rate * flip,
        water,
    )
    np.testing.assert_allclose(starboard[:3], port[:3] * flip, rtol=1e-12)
    np.testing.assert_allclose(starboard[3:], -port[3:] * flip, rtol=1e-12)


@pytest.mark.parametrize(
    ('installation', 'axis'), [((0.05, 0.0, 0.0), 2), ((0.0, 0.05, 0.0), 1), ((0.0, 0.0, 0.05), 0)]
)
def test_installation_angles_turn_the_board_against_its_rigging(
    board: Board, installation: tuple[float, float, float], axis: int
) -> None:
    turned = replace(board, installation=installation)
    # Turning the board on by the angle puts the points back where the rigging has them.
    np.testing.assert_allclose(
        turned.fastening_points @ about_axis(axis, 0.05).T, board.points, atol=1e-12
    )


def test_turning_strips_resist_a_spin(board: Board) -> None:
    still = np.zeros((1, 3))
    args = (PRINTED, np.ones(1), still, np.eye(3)[None], np.array([[2.0, 0.0, 0.0]]))
    water = Water(gravity=0.0)
    board = replace(board, inertia=np.zeros((3, 3)), points=np.zeros((3, 3)))
    calm = own_load(board, *args, still, water)[0, 3:]
    strip = np.linspace(-0.5, 0.5, 20_001) * 5.63
    width = strip[1] - strip[0]
    spun = own_load(board, *args, np.array([[0.1, 0.0, 0.0]]), water)[0, 3:]
    # Each strip lifts against its own motion: slope times its own attack angle ω r / u.
    expected = -np.sum(
        0.5 * DENSITY * 2.0**2 * 2.13 * width * board.rotary_slope * (0.1 * strip / 2.0) * strip
    )
    np.testing.assert_allclose(spun - calm, [expected, 0.0, 0.0], rtol=1e-3, atol=1e-6)
