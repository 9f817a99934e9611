"""On its way a trial moves ship and winches at limited rates, and the boards keep their lift."""

import itertools

import pytest

from trawl_ros.control.trial.machine import Transit
from trawl_ros.control.trial.records import TrialSettings, TrialTarget

SETTINGS = TrialSettings(winch_speed=0.4, ship_acceleration=0.02, least_speed=1.9, most_speed=2.5)
SHORT = TrialTarget(port=300.0, starboard=300.0, speed=2.1)
LONG = TrialTarget(port=395.0, starboard=400.0, speed=1.9)
DT = 0.5


def sailed(here, target, share=1.0):
    transit = Transit(SETTINGS, here)
    transit.target = target
    course = [transit.wanted]
    while not transit.arrived:
        transit.advance(DT, share)
        course.append(transit.wanted)
        assert len(course) < 10_000
    return course


def test_it_arrives_at_limited_rates():
    for here, target in ((SHORT, LONG), (LONG, SHORT)):
        course = sailed(here, target)
        last = course[-1]
        assert (last.port, last.starboard, last.speed) == (
            target.port,
            target.starboard,
            target.speed,
        )
        for before, after in itertools.pairwise(course):
            assert abs(after.port - before.port) <= 0.4 * DT + 1e-9
            assert abs(after.speed - before.speed) <= 0.02 * DT + 1e-9


def test_while_warp_runs_out_the_gear_is_no_slower_than_it_may_be():
    course = sailed(SHORT, LONG)
    for before, after in itertools.pairwise(course):
        rate = max(after.port - before.port, after.starboard - before.starboard) / DT
        assert before.speed - rate >= SETTINGS.least_speed - 1e-9
    assert max(wanted.speed for wanted in course) == pytest.approx(2.3)


def test_it_hauls_slower_where_tension_leaves_less_room():
    assert len(sailed(LONG, SHORT, 0.5)) > 1.9 * len(sailed(LONG, SHORT))


def test_a_slow_ship_pays_out_all_the_same():
    slow = TrialTarget(port=300.0, starboard=300.0, speed=1.9)
    transit = Transit(TrialSettings(least_speed=1.9, most_speed=1.9), slow)
    transit.target = TrialTarget(port=301.0, starboard=301.0, speed=1.9)
    for _ in range(60):
        transit.advance(DT)
    assert transit.arrived
