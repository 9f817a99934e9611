"""What goes wrong on deck between a baseline and later tows is named, from windows."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.diagnosis.diagnosis import values_of
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.predictive_check import on_holdout
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.report.result import result
from trawl_ros.diagnosis.report.sentences import headline
from trawl_ros.diagnosis.report.what_to_do import what_to_do
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

TURN = 5.0
"""Degrees that boards are turned by a shackle in a wrong hole."""

OPTIONS = InferenceOptions()


def turned(model, hours):
    return model.with_board(installation=(np.radians(TURN), 0.0, 0.0))


def diagnosed(coarse, hide, hidden, states=5, seed=3):
    """Diagnose three tows beside a baseline of one, each of so many states."""
    before = hide.trial(coarse, hide.nothing, seed, tows=1)
    after = hide.trial(coarse, hidden, seed + 1, tows=3, first=1)
    apart = [
        replace(window, index=len(before) + window.index, state=len(before) + window.state)
        for window in after
    ]
    windows = [window for window in (*before, *apart) if window.index % 5 < states]
    return diagnose_windows(coarse, windows, hide.names[:4], frozenset({0}))


@pytest.fixture(scope='module')
def rerigged(coarse, hide):
    return diagnosed(coarse, hide, hide.Hidden(gear=turned), states=3)


def test_rerigged_boards_are_named_with_their_angle(rerigged):
    found = rerigged
    # Three tows of three states leave other causes at the boards.
    assert found.verdict in ('NAMED', 'AMBIGUOUS'), found.reason
    assert found.best.names == ('board_rigging',)
    assert found.among[0] == 'board_rigging'
    assert found.posterior.nodes['boards/rigging'] > 0.5
    value, low, high, _ = values_of(found.best)['board_rigging']['epsilon']
    assert low < np.radians(TURN) < high
    assert f'epsilon {np.degrees(value):.3g}° (' in headline(found)
    assert 'shackle' in what_to_do(found)


def test_the_right_repair_makes_nothing_worse(rerigged):
    compared = rerigged.held_out
    assert {own.name for own in compared} >= {'tension', 'door_spread', 'vertical_opening'}
    assert not any(own.is_worse(OPTIONS) for own in compared)
    assert all(abs(own.part - 1.0) < 3.5 * own.part_std for own in compared)
    assert set(result(rerigged, ())['held_out']) == {own.name for own in compared}
    assert sum(own.after for own in compared) < sum(own.before for own in compared)


def test_a_wrong_repair_makes_something_worse(coarse, rerigged):
    """Boards turned by three times as much."""
    predictor = Predictor(build_model(coarse), without=rerigged.baseline)
    right = rerigged.best.refit
    values = right.estimate.values.copy()
    values[12] *= 3.0
    wrong = replace(right, estimate=replace(right.estimate, values=values), predicted={})
    kept = rerigged.split.kept_back
    compared = on_holdout(predictor, rerigged.base, wrong, kept, OPTIONS.errors)
    worse = [own for own in compared if own.is_worse(OPTIONS)]
    assert worse
    assert all(own.part + own.part_std < 0.6 for own in worse)
