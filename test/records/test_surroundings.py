"""Sound speed is TEOS-10's; spread scales with it and is lost when the doors turn away."""

import math

import numpy as np
import pytest

from trawl_ros.instruments.doors import DoorSpread, off_axis
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import SpreadParameters
from trawl_ros.model.water import Water
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import DoorTruth

PRESSURE = Water().pressure
LIMITS = {'min_range_m': 5.0, 'max_range_m': 400.0}


def door(y: float, yaw: float, depth: float = 100.0) -> DoorTruth:
    turn = np.array([0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)])
    place, no = np.array([0.0, y, -depth]), np.zeros(3)
    return DoorTruth(place, turn, no, no, 0.0, 0.0, 0.0, no, no)


def pair(toe_in: float = 0.0, depth: float = 100.0) -> tuple[DoorTruth, DoorTruth]:
    """Two doors 120 m apart; positive ``toe_in`` turns their outer faces forward."""
    return door(60.0, -toe_in, depth), door(-60.0, toe_in, depth)


@pytest.mark.parametrize(
    ('temperature', 'salinity', 'depth', 'speed'),
    # Mackenzie (1981), nine-term equation, good to 0.07 m/s; practical salinity 0.9953 of absolute.
    [(8.0, 35.0, 0.0, 1481.9), (8.0, 35.0, 300.0, 1486.8), (20.0, 35.0, 0.0, 1521.3)],
)
def test_the_speed_of_sound_is_that_of_sea_water(
    temperature: float, salinity: float, depth: float, speed: float
) -> None:
    sea = Surroundings(PRESSURE, ((0.0, temperature),), salinity)
    assert sea.sound_speed(depth) == pytest.approx(speed, abs=0.4)


def test_warm_water_above_cold_has_a_profile() -> None:
    sea = Surroundings(PRESSURE, ((0.0, 14.0), (50.0, 6.0), (300.0, 5.0)))
    assert sea.temperature(25.0) == 10.0
    assert sea.sound_speed(0.0) > sea.sound_speed(50.0)
    assert sea.sound_speed(50.0) < sea.mean_sound_speed(0.0, 50.0) < sea.sound_speed(0.0)


def test_spread_is_wrong_by_the_ratio_of_the_speeds() -> None:
    cold = Surroundings(PRESSURE, ((0.0, 2.0),))
    parameters = SpreadParameters(rate_hz=1.0, assumed_sound_speed_m_s=1500.0, **LIMITS)
    (sample,) = DoorSpread(parameters, cold, SeedPlan()).observe(pair(), 0)
    assert sample.distance == pytest.approx(120.0 * 1500.0 / cold.sound_speed(100.0))
    assert sample.distance - 120.0 > 3.0


def test_a_sensor_that_is_set_right_reads_right() -> None:
    parameters = SpreadParameters(rate_hz=1.0, **LIMITS)
    (sample,) = DoorSpread(parameters, Surroundings(PRESSURE), SeedPlan()).observe(pair(), 0)
    assert sample.distance == pytest.approx(120.0)


@pytest.mark.parametrize('toe_in', [0.0, 0.35, -0.6])
def test_the_angle_off_the_axis_is_that_of_the_boards(toe_in: float) -> None:
    assert off_axis(pair(toe_in)) == pytest.approx(abs(toe_in), abs=1e-7)


def test_one_door_that_turns_away_is_enough_to_lose_the_sound() -> None:
    parameters = SpreadParameters(rate_hz=1.0, beam_half_angle_deg=40.0, **LIMITS)
    sensor = DoorSpread(parameters, Surroundings(PRESSURE), SeedPlan())
    heard = [
        len(sensor.observe((door(60.0, -angle), door(-60.0, 0.3)), k * 10**9))
        for k, angle in enumerate(np.radians([20.0, 39.0, 41.0, 20.0]))
    ]
    assert heard == [1, 1, 0, 1]


def test_below_the_deepest_ocean_sound_is_no_faster() -> None:
    """A seabed that a false truth puts at 10⁸ m must not make a NaN of what is sounded."""
    sea = Surroundings(PRESSURE, ((0.0, 8.0),))
    assert sea.sound_speed(1e8) == sea.sound_speed(11_000.0)
    assert 1500.0 < sea.mean_sound_speed(5.0, 1e8) < 1700.0
