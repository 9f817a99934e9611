"""Windows kept back are predicted with boards upright, where the gear has such a state."""

from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis import holdout
from trawl_ros.records.channels import INPUTS
from trawl_ros.solver.predict import Predictor

WINDOW = SimpleNamespace(index=7, means=dict.fromkeys(INPUTS, 500.0))


@pytest.mark.parametrize(
    ('from_nearby', 'cold', 'taken'),
    [
        ('upright', 'upright', 'from nearby'),
        ('lying', 'upright', 'cold'),
        ('lying', 'lying', 'from nearby'),
        ('lying', None, 'from nearby'),
    ],
)
def test_a_board_lies_over_only_where_a_cold_start_says_so_too(
    from_nearby, cold, taken, monkeypatch
):
    def linearise(predictor, observables, window, values, starts=(None,)):
        way, posture = ('cold', cold) if starts == (None,) else ('from nearby', from_nearby)
        if posture is None:
            raise NoSteadyState('none found')
        return SimpleNamespace(way=way, window=window, state=SimpleNamespace(state=posture))

    monkeypatch.setattr(holdout, 'linearise', linearise)
    monkeypatch.setattr(holdout, 'lies_over', lambda model, state: state == 'lying')
    near = SimpleNamespace(inputs=np.full(3, 480.0), state='a state')
    refit = SimpleNamespace(
        wanted=(),
        predicted={},
        fit=SimpleNamespace(windows=(near,)),
        estimate=SimpleNamespace(values=np.zeros(12)),
    )
    found = holdout.predicted(Predictor(SimpleNamespace()), refit, WINDOW)
    assert found.way == taken
    assert refit.predicted == {WINDOW.index: found}


def test_what_is_kept_back_is_not_fitted_and_has_a_course_that_others_may_lack():
    tows = [SimpleNamespace(tow=tow, state=3 * tow + place, index=3 * tow + place)
            for tow in range(4) for place in range(3)]  # fmt: skip
    halves = holdout.split(tows, frozenset({0}))
    assert {window.tow for window in halves.kept_back} == {2}
    assert {window.tow for window in halves.fitted} == {0, 1, 3}
    asked = []

    def subset(states):
        asked.append(states)
        return SimpleNamespace(finish=lambda: 'estimate')

    refit = SimpleNamespace(wanted=('a cause',), estimator=SimpleNamespace(subset=subset))
    again = holdout.without_kept_back(refit, halves)
    assert asked == [{window.state for window in halves.fitted}]
    assert (again.wanted, again.estimate) == (('a cause',), 'estimate')
