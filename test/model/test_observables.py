"""Angles of boards are those of their rotations, with their derivatives."""

import math

import numpy as np
import pytest

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.compiled import as_kind
from trawl_ros.model.numerics import STEP, stepped
from trawl_ros.model.observables import fallen_boards, fill_attitude, lies_by_attitude
from trawl_ros.model.rotations import about_axis, rotation
from trawl_ros.model.state import State


def attitude(turn: FloatArray) -> FloatArray:
    """Pitch, roll and inclination (3,), complex."""
    angles = np.empty(3, complex)
    fill_attitude(*as_kind(complex, turn), angles)
    return angles


def test_inclination_pitch_and_roll() -> None:
    turn = about_axis(2, 0.4) @ about_axis(1, 0.2) @ about_axis(0, -0.3)
    expected = 0.2, -0.3, math.acos(math.cos(0.2) * math.cos(0.3))
    np.testing.assert_allclose(attitude(turn).real, expected, rtol=1e-12)


@pytest.mark.parametrize('degrees', [-179.0, -90.0, -10.0, 0.0, 60.0, 135.0])
def test_roll_goes_all_round_with_its_derivative(degrees: float) -> None:
    vector = np.array([np.radians(degrees), 0.0, 0.0])
    roll = attitude(rotation(stepped(vector, np.array([1.0, 0.0, 0.0]))))[1]
    assert roll.real == pytest.approx(vector[0])
    assert roll.imag / STEP == pytest.approx(1.0)


@pytest.mark.parametrize('pitch', [-0.2, 1.2])
@pytest.mark.parametrize('degrees', [-170.0, -65.0, -45.0, -21.0, 0.0, 45.0, 65.0, 170.0])
def test_a_board_that_lies_by_its_attitude_has_fallen(degrees: float, pitch: float) -> None:
    none, roll = np.zeros((2, 3)), np.radians(degrees)
    turn = about_axis(2, 0.4) @ about_axis(1, pitch) @ about_axis(0, roll)
    lies = lies_by_attitude(pitch, roll)
    assert lies == (abs(degrees) > 60.0 or pitch > 1.0)
    both = fallen_boards(State(none, none, np.stack([turn, turn]), none, none, none))
    assert not lies or all(both)
    assert not lies_by_attitude(math.nan, roll)
