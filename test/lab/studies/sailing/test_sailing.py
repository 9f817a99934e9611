"""Sailed trials are held against planned ones and the sweep on the same boards and errors."""

import json

import numpy as np
import pytest

from trawl_ros.estimation.planning.duration import Leg
from trawl_ros.estimation.planning.states import Manoeuvre
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.studies.sailing.courses import Course, Sea, planned_course
from trawl_ros.lab.studies.sailing.report import REPORT, write_sailing
from trawl_ros.lab.studies.sailing.study import SailedBoard, SailingPlan, run_sailing


@pytest.fixture(scope='module')
def sea(coarse_gear):
    return Sea(load_gear(coarse_gear), (1, 2))


def test_windows_of_the_first_states_stay_as_they_were(sea):
    looks = [sea.look(Manoeuvre(295.0, 300.0, 2.3)), sea.look(Manoeuvre(300.0, 300.0, 2.5))]
    first, both = sea.windows(looks[:1]), sea.windows(looks)
    assert [window.state for window in both] == [0, 0, 1, 1]
    assert both[:2] == first
    assert first[0].means['port_length'] == pytest.approx(295.0, abs=3.0)
    assert first[0].means != first[1].means


def test_a_state_in_which_the_board_cannot_be_towed_costs_its_time(sea, coarse_gear):
    assert sea.look(Manoeuvre(500.0, 500.0, 0.5)) is None
    legs = [Leg(Manoeuvre(300.0, 300.0, 2.5), 15.0), Leg(Manoeuvre(500.0, 500.0, 0.5), 15.0)]
    course = planned_course(sea, load_gear(coarse_gear), legs)
    assert course.hours == 0.5
    assert (len(course.states), course.refused) == (1, 1)
    assert course.mean_std > 0.0
    prior = load_gear(coarse_gear).identification.std
    nothing = planned_course(sea, load_gear(coarse_gear), legs[1:])
    assert nothing.std.tolist() == list(prior)


def course(std):
    return Course(('300 m at 2.1 m/s',), 0, 6.0, np.full(12, std))


def test_the_report_has_ratios_with_their_interval(tmp_path):
    boards = [
        SailedBoard(number, [0.0] * 12, course(0.1), course(0.1 * over), course(0.4), course(0.09))
        for number, over in enumerate((1.0, 4.0))
    ]
    plan, sweep, known = write_sailing(tmp_path, SailingPlan(boards=2), boards)
    assert plan.value == pytest.approx(0.5)
    assert plan.low < plan.value < plan.high
    assert sweep.value == pytest.approx(0.25)
    assert plan.ok
    assert sweep.ok
    assert known.value == pytest.approx(0.45)
    assert known.target is None
    record = json.loads((tmp_path / 'sailing.json').read_text())
    assert record['boards'][0]['planned']['mean_std'] == pytest.approx(0.1)
    assert '| 0 | sailed | 1 | 0 | 6.00 | 0.1000 |' in (tmp_path / REPORT).read_text()


@pytest.mark.slow
def test_a_short_trial_is_sailed(coarse_gear):
    (board,) = run_sailing(SailingPlan(str(coarse_gear), hours=1.0, boards=1))
    assert len(board.sailed.states) + board.sailed.refused >= 2
    assert board.sailed.hours <= 1.0
    assert board.sailed.states[0] == '500 m at 2.1 m/s'
