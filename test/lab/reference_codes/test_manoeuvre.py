"""The manoeuvre covers what it says, smoothly."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from trawl_ros.lab.reference_codes.manoeuvre import WireManoeuvre, haul_and_turn


@pytest.fixture
def manoeuvre() -> WireManoeuvre:
    return haul_and_turn()


def test_it_hauls_two_hundred_metres_and_turns_by_ninety_degrees(manoeuvre: WireManoeuvre) -> None:
    assert manoeuvre.length_at(0.0) == 600.0
    assert manoeuvre.length_at(manoeuvre.duration) == pytest.approx(400.0)
    assert manoeuvre.velocity(0.0) == pytest.approx([2.0, 0.0, 0.0])
    assert manoeuvre.velocity(manoeuvre.duration) == pytest.approx([0.0, 2.0, 0.0])
    assert manoeuvre.haul.end < manoeuvre.turn.start < manoeuvre.turn.end < manoeuvre.duration


def test_lengths_are_the_integral_of_their_rate(manoeuvre: WireManoeuvre) -> None:
    haul = manoeuvre.haul
    corners = (haul.start, haul.start + haul.rise, haul.end - haul.rise, haul.end)
    for time in (21.0, 29.5, 200.0, haul.end - 3.0, haul.end + 5.0):
        pieces = [(a, min(b, time)) for a, b in pairwise(corners)]
        hauled = sum(quad(manoeuvre.length_rate, a, b)[0] for a, b in pieces if a < b)
        assert manoeuvre.length_at(time) == pytest.approx(600.0 + hauled, abs=1e-8)


def test_the_track_is_the_integral_of_the_velocity(manoeuvre: WireManoeuvre) -> None:
    track = manoeuvre.track(np.arange(0.0, manoeuvre.duration, 0.1))
    finer = manoeuvre.track(np.arange(0.0, manoeuvre.duration, 0.05))[::2]
    assert np.abs(track - finer[: len(track)]).max() < 1e-6
    assert np.linalg.norm(np.diff(track, axis=0), axis=1) == pytest.approx(0.2, rel=1e-4)
