"""Data time follows wall time at a factor, and no rush follows a pause."""

import pytest

from trawl_ros.nodes.runtime.credit import LARGEST_DELAY_S, Pacer


class Wall:
    """Wall time that passes when told to."""

    def __init__(self):
        self.time = 100.0

    def __call__(self):
        return self.time


@pytest.fixture
def wall():
    return Wall()


@pytest.mark.parametrize('factor', [0.5, 1.0, 20.0])
def test_data_are_due_at_the_factor(wall, factor):
    pacer = Pacer(factor, wall)
    assert pacer.due(0.0)
    wall.time += 0.9 / factor
    assert not pacer.due(1.0)
    wall.time += 0.11 / factor
    assert pacer.due(1.0)


def test_without_a_pace_all_is_due(wall):
    assert Pacer(0.0, wall).due(1e6)


def test_a_long_pause_is_lost_and_said(wall):
    pacer = Pacer(1.0, wall)
    pacer.due(0.0)
    wall.time += LARGEST_DELAY_S + 5.0
    assert pacer.due(1.0)
    assert not pacer.due(1.1)
    assert pacer.lost_s == pytest.approx(LARGEST_DELAY_S + 4.0)


def test_a_change_of_factor_holds_from_there_on(wall):
    pacer = Pacer(1.0, wall)
    pacer.due(0.0)
    pacer.change(10.0)
    assert pacer.due(50.0)
    wall.time += 1.0
    assert pacer.due(60.0)
    assert not pacer.due(60.1)
