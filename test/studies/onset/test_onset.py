"""The study of onsets counts what it says it counts."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from studies.harness import Work
from studies.onset.known import (
    BY_TOW,
    BY_WINDOWS,
    KNOWN,
    drawn_knowledge,
    knowledge_by_tow,
)
from studies.onset.limit import drawn_rarest
from studies.onset.plant import random_course, with_boards
from studies.onset.rows import onset_rows, reasons_table
from studies.onset.sizes import STEADY_SIZES, TIMES
from studies.onset.study import OnsetPlan, result
from studies.onset.trial import Beginning, OnsetTask, OnsetTrial, make_trial
from trawl_ros.core.errors import GearError
from trawl_ros.diagnosis.onset.candidates import candidate_table
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.records.observables import OBSERVABLES

FOUND = OnsetTrial(
    0, 'kite', 0.35, 900.0, 960.0, 930.0, 'kite', [], 20.0, watched_s=1800.0, unwatched_s=330.0,
    behind_s=600.0, clean_s=570.0, seconds=20.0,
)  # fmt: skip
CLEAN = OnsetTrial(0, '', 0.0, None, rarity=3.0, watched_s=3600.0, clean_s=3600.0, seconds=36.0)


def test_an_effect_that_begins_is_not_there_before():
    cell = catalogue()['tension_cell']
    begin = Beginning(
        cell.name, cell.sentence, cell.parameters, cell.excited_by, of=cell, begin_h=0.5
    )
    shown = dict.fromkeys(OBSERVABLES, 1000.0)
    values = cell.neutral + np.array([200.0, *np.zeros(len(cell.neutral) - 1)])
    at = Situation((400.0, 400.0, 2.2), hours=0.49)
    assert begin.apply_to_sensors(values, shown, at) == shown
    later = begin.apply_to_sensors(values, shown, replace(at, hours=0.5))
    assert later['port_tension'] == pytest.approx(1200.0)


def test_every_size_of_the_table_is_possible_three_times_over():
    for name, sizes in STEADY_SIZES.items():
        own = {parameter.name: parameter for parameter in catalogue()[name].parameters}
        ((parameter, size),) = sizes.items()
        there = own[parameter]
        way = [there.neutral + sign * TIMES * size for sign in (1.0, -1.0)]
        assert any(there.low <= value <= there.high for value in way), name


def test_each_shard_has_trials_of_both_kinds(tmp_path):
    tasks = list(OnsetPlan(trials=9, clean=6).tasks(Work(tmp_path)))
    assert len({task.name for task in tasks}) == 15
    for part in (0, 1):
        own = [task.series for task in tasks if task.number % 2 == part]
        assert own.count('clean') == 3


def test_delays_onsets_and_false_findings_are_counted():
    missed = replace(FOUND, number=1, raised_s=None, onset_s=None, name='', behind_s=270.0)
    alarmed = replace(CLEAN, false=1)
    trials = [FOUND, missed, CLEAN, alarmed]
    rows = {row.what: row for row in onset_rows(trials)}
    assert rows['effects that are detected'].value == 50.0
    assert rows['delay, median'].value == pytest.approx(1.0)
    assert rows['onsets within 3 min, of those detected'].value == 100.0
    false = rows['false findings in 230 h']
    # Two clean hours, and what was judged of both tows with an effect up to it.
    assert false.value == pytest.approx(230.0 / (2.0 + 2 * 570.0 / 3600.0))
    assert false.low < false.value < false.high
    assert not false.ok
    assert rows['largest rarity in 2 clean tows'].value == 3.0
    same = rows['the same, of tows judged for half of the 10 min behind its beginning']
    assert same.value == 100.0
    judged = rows['of the tows that is judged']
    assert judged.value == pytest.approx(100.0 * 10800.0 / 11460.0)
    assert judged.note.endswith('less than half in 0 of 4 tows')


def test_tows_whose_boards_lie_are_told_apart_from_those_a_ship_would_tow_on():
    lying = replace(FOUND, number=1, raised_s=None, onset_s=None, name='', fallen_s=300.0)
    alarmed = replace(CLEAN, false=1, fallen_s=90.0)
    rows = {row.what: row for row in onset_rows([FOUND, lying, alarmed])}
    standing = 'of tows in which boards lie for less than 60 s'
    assert rows['effects that are detected'].value == 50.0
    assert rows[f'the same, {standing}'].value == 100.0
    assert rows[f'false findings in 230 h {standing}'].value == 0.0
    assert rows[f'of these, {standing}'].value == pytest.approx(100.0 * 1800.0 / 2130.0)


def test_candidates_without_a_mark_are_never_rare_and_one_that_has_some_is_as_chance_says():
    table = candidate_table({})
    number, rng = len(table.parameters), np.random.default_rng(4)
    marks = np.zeros((4, 2, number))
    assert not drawn_rarest(table, [marks] * 3, 10, rng).any()
    (column,) = table.candidates[0].columns
    # A mark far larger than its prior: the ratio of one onset is then χ² of one.
    marks[:, 0, column] = 1e6 / table.scale[column]
    rarest = drawn_rarest(table, [marks, marks], 4000, rng)
    assert np.mean(rarest > 2.0) == pytest.approx(0.01, abs=0.006)


def test_plants_have_boards_of_their_own_and_what_is_known_of_them_is_wrong_as_stated(
    coarse_gear, tmp_path
):
    record, prior = load_gear(coarse_gear), board_prior(load_gear(coarse_gear))
    course = random_course(tmp_path, record, 6.0, np.random.default_rng(5))
    first, other = (with_boards(course, np.random.default_rng(seed)) for seed in (1, 2))
    boards = first.plant.board.coefficients.array()
    assert np.all((prior.low <= boards) & (boards <= prior.high))
    assert np.ptp((boards - prior.start) / prior.std) > 0.5
    assert not np.array_equal(boards, other.plant.board.coefficients.array())
    # The model that watches is that of the gear file, but for where its boards are fastened.
    assert first.gear.board.fastening == first.plant.board.fastening != course.gear.board.fastening
    assert first.gear.board.coefficients == course.gear.board.coefficients
    assert first.commands == course.commands
    rng = np.random.default_rng(6)
    away = [drawn_knowledge(record, boards, rng).values - boards for _ in range(300)]
    inside = np.minimum(boards - prior.low, prior.high - boards) > 3.0 * KNOWN * prior.std
    assert np.std(away, axis=0)[inside] == pytest.approx(KNOWN * prior.std[inside], rel=0.15)


@pytest.mark.slow
def test_boards_are_known_as_a_tow_before_tells_them(coarse_gear, tmp_path):
    record = load_gear(coarse_gear)
    course = random_course(tmp_path, record, 12.0, np.random.default_rng(5))
    known, by = knowledge_by_tow(tmp_path, course, course.gear, np.random.default_rng(1))
    assert by == BY_TOW
    prior = board_prior(record)
    away = known.values - record.board.coefficients.array()
    assert np.exp(np.mean(np.log(np.sqrt(np.diag(known.covariance)) / prior.std))) < 0.4
    assert away @ np.linalg.solve(known.covariance, away) < chi2.ppf(0.9999, len(away))


def test_what_boards_were_known_by_is_counted():
    known = [replace(FOUND, known=BY_TOW), replace(CLEAN, known=BY_WINDOWS)]
    told = result(OnsetPlan(known='tow'), known).sections[0].text
    assert told == 'Boards were known by all of a tow in 1, its steady windows in 1 of 2 tows.'
    assert result(OnsetPlan(), known).sections[0].text == ''


def test_time_that_is_not_judged_is_counted_by_its_reason():
    trials = [replace(FOUND, reasons={'begun': 213.0, 'falls': 106.5}), replace(CLEAN, reasons={})]
    also = replace(FOUND, number=1, reasons={'falls': 213.0}, unwatched_s=0.0, watched_s=0.0)
    rows = reasons_table([*trials, also]).rows
    assert rows == (('falls', '5.6'), ('begun', '3.7'))


def test_a_gear_without_boards_is_refused_at_once(pair_file):
    with pytest.raises(GearError, match='has no boards'):
        make_trial(OnsetTask('clean', 0, 1, str(pair_file), 25.0, 'draw', ''))


@pytest.mark.slow
def test_a_bridle_that_gives_way_is_named():
    # Large, and stiff: what it pulls with turns with the bridles from step to step.
    found = make_trial(OnsetTask('effect', 1, 2500, 'kaifuha', 35.0, 'draw', ''))
    assert found.effect == 'bridle_length'
    assert found.raised_s - found.begin_s < 120.0
    assert 'bridle_length' in (found.name, *found.alike)
    assert found.false == 0
