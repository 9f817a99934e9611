"""A plan knows what a fit of the whole tow will know, and says where the model cannot be towed."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from trawl_ros.estimation.planning.duration import Leg, winch_time
from trawl_ros.estimation.planning.in_motion import planned_readings
from trawl_ros.estimation.planning.plan import TrialPlan, plan_for, towed_plan
from trawl_ros.estimation.planning.scenario import scenario_of
from trawl_ros.estimation.planning.states import PLANNED, Limits, Manoeuvre
from trawl_ros.gear.load import load_gear
from trawl_ros.scenario.scenario import load_scenario

FEW = Limits(lengths=(300.0, 400.0), speeds=(2.1, 2.4), shorter=(5.0,))
HOURS = 1.2


@pytest.fixture(scope='module')
def record(coarse_gear):
    return load_gear(coarse_gear)


@pytest.fixture(scope='module')
def plan(record) -> TrialPlan:
    return towed_plan(record, plan_for(record, hours=HOURS, limits=FEW))


def test_hauling_and_veering_tell_more_than_steady_parts(plan):
    known = plan.in_motion
    assert not plan.windows_only
    assert not known.left_out
    assert np.all(known.whole.sd < known.steady.sd)
    assert known.ratio < 0.8
    assert known.whole.well_known.sum() > known.steady.well_known.sum()
    assert np.array_equal(known.whole.span, plan.trial.known.span)


def test_steady_parts_tell_about_what_their_windows_tell(plan):
    ratio = plan.in_motion.steady.sd / plan.trial.known.sd
    assert np.all((ratio > 0.7) & (ratio < 1.3)), ratio


def test_readings_follow_the_commands_at_the_speed_of_winch_and_ship(plan, record, tmp_path):
    scenario = scenario_file(plan, record, tmp_path)
    read = planned_readings(scenario)
    assert read.duration_s == scenario.duration_s
    assert set(PLANNED) < set(read.series)
    port, speed = read.series['port_length'], read.series['speed']
    winch, ship = record.winch, record.ship
    assert np.max(np.abs(np.diff(port.values))) <= winch.max_speed_m_s + 1e-9
    assert np.max(np.abs(np.diff(speed.values))) <= ship.max_acceleration_m_s2 + 1e-9
    for begin, command in scenario.commands:
        moved = abs(command.port_length - np.interp(begin, port.times, port.values))
        there = begin + winch_time(plan.problem.vessel, moved) + 3.0
        assert np.interp(there, port.times, port.values) == pytest.approx(command.port_length)


def scenario_file(plan, record, folder):
    """The scenario of a plan, read from a file as `trawl tow` reads it."""
    path = folder / 'trial.yaml'
    path.write_text(yaml.safe_dump(scenario_of(plan.trial, 'kaifuha')))
    return load_scenario(path)


NOT_TOWABLE = Leg(Manoeuvre(30.0, 900.0, 0.6), 20.0)


def with_legs(plan, *legs):
    return replace(plan, trial=replace(plan.trial, legs=legs), in_motion=None)


def test_where_the_model_cannot_be_towed_the_plan_says_so(plan, record):
    told = towed_plan(record, with_legs(plan, NOT_TOWABLE, NOT_TOWABLE))
    assert told.in_motion is None
    assert 'cannot be towed' in told.windows_only


def test_what_can_be_towed_counts_and_the_rest_is_told(plan, record):
    told = towed_plan(record, with_legs(plan, plan.trial.legs[0], NOT_TOWABLE))
    assert 10.0 < told.in_motion.left_out_minutes <= NOT_TOWABLE.minutes
    assert np.any(told.in_motion.whole.sd < 0.5 * plan.before.sd)


def test_a_trial_that_the_fit_would_refuse_is_not_towed(plan, record):
    legs = [replace(leg, minutes=300.0) for leg in plan.trial.legs]
    assert 'at most' in towed_plan(record, with_legs(plan, *legs)).windows_only
