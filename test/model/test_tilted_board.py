"""Loads of a board that leans, against those of the flume tank that its law was measured in."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.gear.boards import BoardLawRecord
from trawl_ros.gear.polars import UPRIGHT
from trawl_ros.model.board import Board, own_load
from trawl_ros.model.board_laws import TableLaw
from trawl_ros.model.gear_model import OUTWARD, build_board
from trawl_ros.model.numerics import STEP
from trawl_ros.model.rotations import about_axis
from trawl_ros.model.water import Water

SPEED, DENSITY = 2.0, 1025.0
POINTS = (
    {'attack_deg': 10.0, 'lift': 0.9, 'drag': 0.2},
    {'attack_deg': 20.0, 'lift': 1.4, 'drag': 0.5},
    {'attack_deg': 35.0, 'lift': 1.3, 'drag': 1.1},
)
HEEL = (
    {'tilt_deg': -10.0, 'lift_factor': 0.9, 'upward': -0.2},
    {'tilt_deg': 0.0, 'lift_factor': 1.0, 'upward': 0.05},
    {'tilt_deg': 10.0, 'lift_factor': 1.1, 'upward': 0.3},
)
TRIM = (
    {'tilt_deg': -10.0, 'lift_factor': 1.05, 'upward': -0.1},
    {'tilt_deg': 0.0, 'lift_factor': 1.0, 'upward': 0.0},
    {'tilt_deg': 10.0, 'lift_factor': 0.95, 'upward': 0.15},
)


def board_with(gear, **law) -> Board:
    record = BoardLawRecord.model_validate({'kind': 'table', **law})
    plate = gear.board.model_copy(update={'law': record})
    built = build_board(gear.model_copy(update={'board': plate}))
    return replace(built, inertia=np.zeros((3, 3)))


def load(board: Board, turn, side: float = 1.0, values=None):
    """Coefficients of the force ahead, outward and up in a level flow."""
    whole = own_load(
        replace(board, mass=0.0, volume=0.0),
        np.zeros(12) if values is None else values,
        np.array(side),
        np.zeros(3),
        turn,
        np.array([SPEED, 0.0, 0.0]),
        np.zeros(3),
        Water(density=DENSITY, gravity=0.0),
    )
    return np.array([1.0, side, 1.0]) * whole[:3] / (0.5 * DENSITY * board.area * SPEED**2)


def attitude(attack: float, heel: float = 0.0, trim: float = 0.0, side: float = 1.0):
    """Rotation of a board with its outward normal up by ``heel``, its nose by ``trim`` (deg)."""
    yaw, roll = side * np.radians(attack), side * np.radians(heel)
    return about_axis(2, yaw) @ about_axis(1, -np.radians(trim)) @ about_axis(0, roll)


@pytest.mark.parametrize('side', OUTWARD)
@pytest.mark.parametrize(('tilt', 'points'), [('heel', HEEL), ('trim', TRIM)])
def test_a_tilted_board_has_the_forces_of_the_tank(gear, tilt, points, side: float) -> None:
    board = board_with(gear, points=POINTS, **{tilt: points})
    for point in points:
        turn = attitude(20.0, **{tilt: point['tilt_deg']}, side=side)
        drag, lift, upward = load(board, turn, side)
        assert upward == pytest.approx(point['upward'], abs=1e-12)
        # Across a tilted face the same flow comes at 0.3° less attack.
        assert lift == pytest.approx(1.4 * point['lift_factor'], rel=0.01)
        assert -drag == pytest.approx(0.5, rel=0.03)


def test_a_tilt_that_was_not_measured_changes_nothing(gear) -> None:
    plain, heeled = board_with(gear, points=POINTS), board_with(gear, points=POINTS, heel=HEEL[1:])
    assert plain.law is not None
    attack = np.radians([5.0, 20.0, 50.0])
    upright = plain.law(np.full(12, 0.1), attack, 0.1 * attack)
    leaning = plain.law(np.full(12, 0.1), attack, 0.1 * attack, 0.3, -0.2)
    assert np.array_equal(upright, leaning)
    # Nor does trim, where only heel was measured.
    assert heeled.law is not None
    assert np.array_equal(
        heeled.law(np.zeros(12), attack, attack, 0.1, 0.2),
        heeled.law(np.zeros(12), attack, attack, 0.1),
    )


def test_beyond_the_measured_tilts_loads_turn_with_the_board(gear) -> None:
    law = board_with(gear, points=POINTS, heel=HEEL, trim=TRIM).law
    assert law is not None
    attack, end = np.radians([20.0]), np.sin(np.radians(10.0))
    for sign in (1, -1):
        last = law(np.zeros(12), attack, 0 * attack, sign * end, sign * end)
        beyond = law(np.zeros(12), attack, 0 * attack, sign * 0.6, sign * 0.5)
        np.testing.assert_allclose(beyond, last, atol=1e-12)
    step = 1e-6
    around = [law(np.zeros(12), attack, 0 * attack, end + x) for x in (-step, 0.0, step)]
    np.testing.assert_allclose(around[2] - around[1], around[1] - around[0], atol=1e-9)


def test_the_heel_of_the_tank_is_mostly_force_that_tilts_with_the_board(gear) -> None:
    door = board_with(gear, door='low_aspect_cambered')
    assert door.law is not None
    plain = replace(door, law=TableLaw(replace(door.law.polar, heel=UPRIGHT)))
    for heel, printed in ((5.0, 0.16), (10.0, 0.25)):
        attitudes = [attitude(attack, heel=heel) for attack in (15.5, 20.0, 25.0, 30.0)]
        assert [load(door, turn)[2] for turn in attitudes] == pytest.approx([printed] * 4)
        tilted = np.mean([load(plain, turn)[2] for turn in attitudes])
        assert tilted == pytest.approx(printed, abs=0.04)
    assert load(door, attitude(25.0, heel=10.0))[1] > load(door, attitude(25.0))[1]


@pytest.mark.parametrize('direction', np.eye(3))
@pytest.mark.parametrize('tilt', [(3.0, -4.0), (-7.0, 6.0), (20.0, 20.0)])
def test_the_derivative_by_the_attitude_is_exact(gear, tilt, direction) -> None:
    board = board_with(gear, points=POINTS, heel=HEEL, trim=TRIM)
    values = np.array([0.2, 0.01, -0.3, 0.05, -0.3, 0.01, -0.1, 0.02, 0.1, 0.01, 0.2, -0.05])
    turn = attitude(22.0, *tilt)
    cross = np.cross(np.eye(3), direction)
    exact = load(board, turn + 1j * STEP * turn @ cross, values=values).imag / STEP
    step = 1e-6
    ahead, behind = (
        load(board, turn @ (np.eye(3) + x * cross + x**2 / 2 * cross @ cross), values=values)
        for x in (step, -step)
    )
    np.testing.assert_allclose(exact, (ahead - behind) / (2 * step), atol=1e-7)
