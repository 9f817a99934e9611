"""Trials are made, answered by all methods, and scored; each step goes on where it ended."""

import json

import pytest

from trawl_ros.lab.missing_effect.answering import METHODS, answer_trials
from trawl_ros.lab.missing_effect.score_report import cases_of, write_score
from trawl_ros.lab.missing_effect.trials_folder import (
    make_trials,
    read_answers,
    read_input,
    read_key,
    read_trials,
)

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]


def test_a_trial_is_made_answered_and_scored(tmp_path):
    folder, out = tmp_path / 'trials', tmp_path / 'answers'
    make_trials(folder, seed=7, trials=1)
    key = make_trials(folder, seed=7, trials=2)
    trials = read_trials(folder)
    assert trials.names == tuple(key.trials) == ('trial_000', 'trial_001')
    assert key.trials['trial_001'].words == 'starboard_board_drag'
    data = read_input(folder, trials.trials[0], trials.form)
    assert {window.tow for window in data.windows} == {0, 1, 2, 3}
    answer_trials(folder, out)
    answer_trials(folder, out)
    truth, methods = read_key(folder), {}
    for name in METHODS:
        own = read_answers(out / f'{name}.json', trials)
        assert all(answer.seconds for answer in own.trials.values())
        methods[name] = cases_of(truth, own)
    damage = json.loads((out / 'trawl_diagnose.json').read_text())['trials']['trial_001']
    assert damage['named'] == ['boards/themselves/starboard_board_damage']
    write_score(tmp_path / 'report', 'trawl missing-effect score', truth, methods)
    page = (tmp_path / 'report' / 'missing_effect.md').read_text()
    assert all(name in page for name in METHODS)
    assert (tmp_path / 'report' / 'missing_effect_reliability.png').stat().st_size > 1000
