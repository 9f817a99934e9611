"""Ship and winches keep within what they can do, and end where they are sent."""

import numpy as np
import pytest

from trawl_ros.gear.records import ShipRecord, WinchRecord
from trawl_ros.simulation.ship import Ship, Winch

WINCH = WinchRecord(max_speed_m_s=1.0, max_acceleration_m_s2=0.1)
SHIP = ShipRecord(
    block_spacing_m=12.0, max_acceleration_m_s2=0.02, max_turn_acceleration_deg_s2=0.05
)
STILL = np.zeros(3)


def wind(start: Winch, target: float, dt: float, seconds: float) -> list[Winch]:
    path = [start]
    for _ in range(round(seconds / dt)):
        path.append(path[-1].advanced(WINCH, target, dt))
    return path


@pytest.mark.parametrize('dt', [0.05, 0.1, 0.2])
@pytest.mark.parametrize('target', [500.0, 500.003, 501.0, 489.7, 640.0, 380.0])
def test_a_winch_arrives_and_stays(target: float, dt: float) -> None:
    path = wind(Winch(500.0, 0.0), target, dt, 200.0)
    assert path[-1] == Winch(target, 0.0)
    beyond = max((winch.length - target) * np.sign(target - 500.0) for winch in path)
    assert beyond < 1e-9


@pytest.mark.parametrize('target', [640.0, 380.0])
def test_a_winch_keeps_its_limits(target: float) -> None:
    path = wind(Winch(500.0, 0.0), target, 0.1, 200.0)
    speeds = np.array([winch.speed for winch in path])
    lengths = np.array([winch.length for winch in path])
    assert np.abs(speeds).max() == pytest.approx(1.0)
    # The last crumb of a metre is taken in one step.
    assert np.abs(np.diff(speeds)).max() <= 0.1 * 0.1 + 1e-3
    np.testing.assert_allclose(np.diff(lengths), 0.05 * (speeds[:-1] + speeds[1:]), atol=1e-3)


def test_a_winch_turns_round_when_it_is_told_to() -> None:
    out = wind(Winch(500.0, 0.0), 600.0, 0.1, 20.0)[-1]
    assert out.speed == pytest.approx(1.0)
    path = wind(out, 500.0, 0.1, 200.0)
    assert max(winch.length for winch in path) < out.length + 1.0**2 / (2 * 0.1) + 0.1
    assert path[-1] == Winch(500.0, 0.0)


def test_a_winch_is_told_a_length_from_an_array() -> None:
    length = np.array([500.0, 520.0])[1]
    assert wind(Winch(500.0, 0.0), length, 0.1, 1.0) == wind(Winch(500.0, 0.0), 520.0, 0.1, 1.0)


def test_a_ship_changes_speed_within_her_acceleration() -> None:
    ship = Ship(STILL, 0.3, 2.0, 0.0)
    speeds = []
    for _ in range(400):
        ship = ship.advanced(SHIP, 2.5, 0.0, STILL, 0.1)
        speeds.append(ship.speed)
    assert np.diff(speeds).max() <= 0.02 * 0.1 + 1e-12
    assert ship.speed == pytest.approx(2.5)
    # 25 s of even acceleration, then even speed, all of it along her heading.
    assert np.linalg.norm(ship.position) == pytest.approx(2.25 * 25 + 2.5 * 15, rel=1e-9)
    np.testing.assert_allclose(
        ship.position / np.linalg.norm(ship.position), ship.ahead, atol=1e-12
    )


def test_a_ship_turns_on_a_circle() -> None:
    rate = np.radians(0.5)
    ship = Ship(STILL, 0.0, 2.0, rate)
    for _ in range(round(2 * np.pi / rate / 0.1)):
        ship = ship.advanced(SHIP, 2.0, rate, STILL, 0.1)
    assert ship.heading == pytest.approx(2 * np.pi, abs=1e-3)
    assert np.linalg.norm(ship.position) < 0.3
    started = Ship(STILL, 0.0, 2.0, 0.0).advanced(SHIP, 2.0, rate, STILL, 0.1)
    assert started.yaw_rate == pytest.approx(np.radians(0.05) * 0.1)


def test_a_current_sets_the_ship_over_the_ground() -> None:
    current = np.array([0.0, 0.5, 0.0])
    ship = Ship(STILL, 0.0, 2.0, 0.0).advanced(SHIP, 2.0, 0.0, current, 10.0)
    np.testing.assert_allclose(ship.position, [20.0, 5.0, 0.0])
    assert ship.heading == 0.0
