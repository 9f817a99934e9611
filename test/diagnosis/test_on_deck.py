"""What goes wrong on deck between a baseline and later tows is named, from windows."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.diagnosis import procedure
from trawl_ros.diagnosis.diagnosis import values_of
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.refit import refitted
from trawl_ros.diagnosis.report.result import result
from trawl_ros.diagnosis.report.sentences import headline
from trawl_ros.diagnosis.report.what_to_do import what_to_do
from trawl_ros.diagnosis.worsening import on_holdout
from trawl_ros.effects.registry import catalogue
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

TURN = 5.0
"""Degrees that boards are turned by a shackle in a wrong hole."""

RIVALS = ('board_rigging', 'net_drag', 'spread_sensor')
"""Effects that are looked for."""


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
def few():
    """The catalogue with but few of its effects."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(procedure, 'catalogue', lambda: {name: catalogue()[name] for name in RIVALS})
        yield


@pytest.fixture(scope='module')
def rerigged(coarse, hide, few):
    return diagnosed(coarse, hide, hide.Hidden(gear=turned), states=3)


def is_right(found, name, parameter, hidden):
    """Hold a diagnosis against what was hidden."""
    assert found.verdict == 'NAMED', found.reason
    assert found.best.refit.names == (name,)
    value, low, high, _ = values_of(found.best.refit)[name][parameter]
    assert low < value < high
    assert low < hidden < high


def test_rerigged_boards_are_named_with_their_angle(rerigged):
    is_right(rerigged, 'board_rigging', 'epsilon', np.radians(TURN))
    value = values_of(rerigged.best.refit)['board_rigging']['epsilon'][0]
    assert f'= {np.degrees(value):.3g}° (' in headline(rerigged)
    assert 'shackle' in what_to_do(rerigged)


def test_the_right_repair_makes_nothing_worse(coarse, rerigged):
    predictor = Predictor(build_model(coarse), without=rerigged.baseline)
    compared = on_holdout(predictor, rerigged.base, rerigged.best.refit, rerigged.split.kept_back)
    assert {own.name for own in compared} >= {'tension', 'door_spread', 'vertical_opening'}
    assert not any(own.worse for own in compared)
    assert all(abs(own.part - 1.0) < 3.5 * own.part_std for own in compared)
    assert rerigged.named.held_out == compared
    assert set(result(rerigged, ())['held_out']) == {own.name for own in compared}
    assert sum(own.after for own in compared) < sum(own.before for own in compared)


def test_a_wrong_repair_makes_something_worse(coarse, rerigged):
    """A net of half as much drag again for what the boards do."""
    predictor = Predictor(build_model(coarse), without=rerigged.baseline)
    (drag,) = [own for own in rerigged.score_test.wanted if own.name == 'net_drag']
    wrong = refitted(predictor, rerigged.base, rerigged.score_test, (drag,))
    values = np.concatenate((rerigged.base.estimate.values, [1.5, 0.0]))
    wrong = replace(wrong, estimate=replace(wrong.estimate, values=values))
    compared = on_holdout(predictor, rerigged.base, wrong, rerigged.split.kept_back)
    (opening,) = [own for own in compared if own.name == 'vertical_opening']
    assert opening.worse
    assert opening.part + opening.part_std < 0.5
