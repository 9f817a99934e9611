"""The counting wheel counts stretched wire, the load cell feels tension through friction."""

import pytest

from trawl_ros.instruments.winch import CountingWheel, LoadCell

STIFFNESS = 41e6


def test_wire_paid_out_under_tension_counts_longer_than_it_is() -> None:
    wheel = CountingWheel(STIFFNESS, calibrated_at=0.0)
    assert wheel.count(200.0, 100e3) == 200.0
    assert wheel.count(500.0, 164e3) - 200.0 == pytest.approx(300.0 * (1 + 164e3 / STIFFNESS))


def test_what_was_paid_out_lightly_and_hauled_heavily_does_not_come_back_to_the_mark() -> None:
    wheel = CountingWheel(STIFFNESS, calibrated_at=100e3)
    wheel.count(300.0, 100e3)
    assert wheel.count(700.0, 100e3) == pytest.approx(700.0)
    assert wheel.count(300.0, 200e3) == pytest.approx(300.0 - 400.0 * 100e3 / STIFFNESS)


def test_standing_wire_counts_nothing_whatever_the_tension() -> None:
    wheel = CountingWheel(STIFFNESS, calibrated_at=0.0)
    assert [wheel.count(400.0, tension) for tension in (1e5, 3e5, 0.0)] == [400.0] * 3


def test_wire_without_a_stiffness_does_not_stretch() -> None:
    wheel = CountingWheel(None, calibrated_at=0.0)
    assert [wheel.count(length, 2e5) for length in (200.0, 700.0)] == [200.0, 700.0]


def test_a_load_cell_lags_up_and_down_by_its_friction() -> None:
    cell = LoadCell(2e3)
    felt = [cell.feel(tension) for tension in (100e3, 101e3, 110e3, 109e3, 100e3)]
    assert felt == [100e3, 100e3, 108e3, 108e3, 102e3]


def test_without_friction_it_feels_the_tension() -> None:
    cell = LoadCell(0.0)
    assert [cell.feel(tension) for tension in (1e5, 1.2e5, 0.9e5)] == [1e5, 1.2e5, 0.9e5]
