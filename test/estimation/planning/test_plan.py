"""A plan can be towed, fits its time, and tells more than the paper's sweep."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.fit.fit import AS_STATED, Fit
from trawl_ros.estimation.fit.laws import QUANTITIES
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.planning.duration import (
    Timetable,
    VesselLimits,
    arranged,
    holding_time,
    minutes_of,
    rest_of,
    winch_time,
)
from trawl_ros.estimation.planning.information import (
    covariance_from,
    information_before,
    information_of,
)
from trawl_ros.estimation.planning.limits import limits_of
from trawl_ros.estimation.planning.plan import TrialPlan, plan_for
from trawl_ros.estimation.planning.search import MAX_VISITS_PER_STATE, Designer, shortfall
from trawl_ros.estimation.planning.states import Explorer, Limits, Manoeuvre
from trawl_ros.estimation.planning.windows import imagined_windows
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.simulation.ship import Winch
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.predict import Predictor

FEW = Limits(lengths=(200.0, 500.0), speeds=(2.1, 2.5), shorter=(5.0,))
SWEEP_HOURS = 2.0
"""Time for the sweep out and back; gear on this much warp settles for half an hour and more."""

LIMITS = VesselLimits(0.4, 0.1, 0.02, least_speed=1.9, most_speed=2.5)


@pytest.fixture(scope='module')
def record(coarse_gear):
    return load_gear(coarse_gear)


@pytest.fixture(scope='module')
def plan(record) -> TrialPlan:
    return plan_for(record, hours=SWEEP_HOURS, limits=FEW)


def test_the_time_is_used_and_not_overdrawn(plan):
    assert plan.trial.minutes == sum(leg.total_minutes for leg in plan.trial.legs)
    shortest = min(leg.total_minutes for leg in plan.trial.legs)
    assert 60.0 * SWEEP_HOURS - 2 * shortest < plan.trial.minutes <= 60.0 * SWEEP_HOURS
    assert max(map(plan.trial.manoeuvres.count, plan.trial.manoeuvres)) <= MAX_VISITS_PER_STATE


def test_every_leg_can_be_towed_with_the_board_as_believed_and_as_filed(plan, record):
    model = build_model(record)
    known = {one.manoeuvre: one.part.state for one in plan.choice.candidates}
    for coefficients in (board_prior(record).start, record.board.coefficients.array()):
        board = model.with_coefficients(coefficients)
        for one in (plan.trial.manoeuvres[0], plan.trial.manoeuvres[-1]):
            lengths = (one.port_length, one.starboard_length)
            assert steady_state(board, lengths, one.speed, start=known[one])


def test_it_tells_more_than_the_sweep_in_the_same_time(plan):
    sweep, few_channels = plan.sweeps
    assert len(sweep.legs) >= 3
    assert sweep.minutes <= 60.0 * SWEEP_HOURS
    assert len({one.speed for one in sweep.manoeuvres}) == 1
    assert shortfall(plan.trial.known) < 0.5 * shortfall(sweep.known)
    assert plan.trial.known.well_known.sum() > sweep.known.well_known.sum()
    assert shortfall(sweep.known) < shortfall(few_channels.known) < shortfall(plan.before)


def test_no_other_manoeuvre_in_any_place_would_tell_more(plan):
    designer = Designer(plan.problem, plan.choice.candidates)
    done = plan.trial.manoeuvres
    best = designer.shortfall(done)
    for place in range(len(done)):
        for one in plan.choice.candidates:
            other = (*done[:place], one.manoeuvre, *done[place + 1 :])
            if designer.legs(other) is not None:
                assert designer.shortfall(other) > best - 1e-8


def test_the_same_question_gets_the_same_plan(plan):
    again = Designer(plan.problem, plan.choice.candidates).best()
    assert again == plan.trial.legs


def by_the_fit(windows, problem):
    """Posterior covariance that the estimator gives with these windows."""
    fit = Fit(tuple(windows), problem.coefficients, AS_STATED, problem.prior, problem.estimator)
    return fit.posterior.covariance


def test_planner_and_estimator_agree_on_what_windows_teach(plan):
    problem = plan.problem
    designer = Designer(problem, plan.choice.candidates)
    done = plan.trial.manoeuvres
    candidates = {one.manoeuvre: one for one in plan.choice.candidates}
    windows = [
        replace(linear, window=replace(linear.window, index=index, state=index // 2))
        for index, linear in enumerate(
            linear for manoeuvre in done for linear in designer._windows(candidates[manoeuvre])
        )
    ]
    assert problem.windows.max_windows_per_state == 2
    ours, fits = designer.covariance(done), by_the_fit(windows, problem)
    size = np.sqrt(np.outer(np.diag(fits), np.diag(fits)))
    assert np.max(np.abs(ours - fits) / size) < 1e-8
    assert plan.trial.known.sd == pytest.approx(problem.quantities(fits).sd, rel=1e-6)


def test_what_limits_is_named_and_its_remedy_helps(plan):
    problem = replace(plan.problem, minutes=20.0)
    designer = Designer(problem, plan.choice.candidates)
    short = [leg.manoeuvre for leg in designer.best()]
    known = designer.quantities(short)
    named = limits_of(designer, short, known)
    assert len(named) == (~known.well_known).sum() > 0
    endless = problem.quantities(
        covariance_from(designer.information(short, 1e4), problem.prior)
    ).well_known
    for name, why in named.items():
        assert (why == 'noise') == endless[QUANTITIES.index(name)]


def test_tension_and_seabed_keep_manoeuvres_away(plan, record):
    seen = {one.manoeuvre: one.part.state.observables for one in plan.choice.candidates}
    fast, deep = Manoeuvre(200.0, 200.0, 2.5), Manoeuvre(500.0, 500.0, 2.1)
    predictor = Predictor(build_model(record))
    start = board_prior(record).start
    limits = replace(FEW, max_tension=seen[fast].port_tension - 1.0)
    assert Explorer(predictor, start, limits).look_up(fast, []).reason == 'tension'
    bottom = seen[deep].net_depth + seen[deep].vertical_opening
    limits = replace(FEW, seabed=bottom + 0.5 * FEW.clearance)
    assert Explorer(predictor, start, limits).look_up(deep, []).reason == 'seabed'


def test_too_little_time_and_nothing_to_tow_are_said(record):
    with pytest.raises(TrawlError, match=r'0\.1 h .* 0 of .* 2 legs'):
        plan_for(record, hours=0.1, limits=Limits((200.0,), (2.5,), ()))
    with pytest.raises(TrawlError, match=r'none of 1 manoeuvres, 30 to 30 m'):
        plan_for(record, limits=Limits((30.0,), (2.1,), ()))


def test_windows_of_one_state_share_what_stays_wrong(plan):
    """Twice as many windows of a state tell less than twice as many states."""
    problem = plan.problem
    candidate = plan.choice.candidates[0]
    before = information_before(problem.prior, problem.estimator)

    def sd(number: int) -> np.ndarray:
        parts = imagined_windows(candidate, problem.coefficients, state=0, number=number)
        taught = information_of(parts, problem.prior, problem.estimator)
        return np.sqrt(np.diag(covariance_from(before + taught, problem.prior)))

    parts = imagined_windows(candidate, problem.coefficients, state=0, number=2)
    fits = by_the_fit(parts, problem)
    assert sd(2) == pytest.approx(np.sqrt(np.diag(fits)), rel=1e-8)
    assert np.all(sd(4) <= sd(2))
    assert np.all(sd(400) > 0.1 * sd(2))


def test_lengths_rise_and_no_state_follows_itself():
    one, two = Manoeuvre(200.0, 200.0, 2.1), Manoeuvre(200.0, 200.0, 2.5)
    far = Manoeuvre(400.0, 400.0, 2.1)
    ordered = arranged([far, one, two, one])
    assert ordered == (one, two, one, far)
    assert arranged([far, one, one]) is None


def test_the_winch_takes_as_long_as_the_simulated_one():
    class Limit:
        max_speed_m_s, max_acceleration_m_s2 = 0.4, 0.1

    for metres in (0.5, 5.0, 100.0):
        winch, seconds = Winch(200.0, 0.0), 0.0
        while winch.length != 200.0 + metres or winch.speed:
            winch, seconds = winch.advanced(Limit, 200.0 + metres, 0.1), seconds + 0.1
        assert winch_time(LIMITS, metres) == pytest.approx(seconds, abs=0.7)


def test_warp_runs_out_at_a_speed_that_keeps_the_boards_up(plan):
    options, vessel = WindowOptions(), plan.problem.vessel
    timetable = Timetable(vessel, options, plan.choice.candidates)
    short, longer = Manoeuvre(200.0, 200.0, 2.1), Manoeuvre(500.0, 500.0, 2.1)
    out = timetable.legs([short, longer])[1]
    faster = vessel.veering_speed - 2.1
    assert faster == pytest.approx(min(0.4, 2.5 - 2.1))
    assert out.veering_speed == pytest.approx(vessel.veering_speed)
    assert 60.0 * out.veering_minutes >= winch_time(vessel, 300.0) + faster / 0.02
    assert 60.0 * out.minutes >= holding_time(longer, options) + faster / 0.02
    back = timetable.legs([longer, short])[1]
    assert back.veering_minutes == 0.0
    assert 60.0 * back.minutes >= holding_time(short, options) + winch_time(vessel, 300.0)
    assert minutes_of([out, back]) == out.minutes + out.veering_minutes + back.minutes


def test_a_leg_is_held_until_the_net_sinks_slowly_enough(plan):
    for candidate in plan.choice.candidates:
        rest = rest_of(candidate, WindowOptions())
        assert rest.time(0.0) == 0.0
        for change, moving in ((20.0, 0.0), (20.0, 300.0), (80.0, 700.0)):
            seconds = 100.0 + rest.time(rest.left(change, moving, 100.0))
            # Integrated: what is to come grows with the change and decays all the time.
            left, step = 0.0 if moving else change, 0.5
            for _ in np.arange(0.0, moving, step):
                left += step * (change / moving - left / rest.decay)
            left *= np.exp(-seconds / rest.decay)
            drift = left * (1.0 - np.exp(-rest.window / rest.decay))
            assert drift == pytest.approx(rest.drift, rel=0.01)
