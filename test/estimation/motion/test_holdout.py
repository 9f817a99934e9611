"""States that are left out of a fit in motion are predicted by a step of that fit's own options."""

from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.holdout import hold_out_states
from trawl_ros.estimation.motion.information import LinearGroup
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes, GroupRows
from trawl_ros.estimation.motion.sizes import LinearData
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.lab.benchmark.motion import course_tow

SHARED = 14
AWAY = 1.5
"""Where the readings have the first coefficient, in prior std from where they are linearised."""


@pytest.fixture(scope='module')
def fit():
    """Two halves of a tow, in each of which the readings lead far from where it is linearised."""
    tow = course_tow(400.0)
    number = len(tow)
    ones, none = np.ones(number), np.zeros(0)
    columns = np.zeros((number, SHARED))
    columns[:, 0] = 1.0
    rows = GroupRows(
        np.arange(number), np.zeros(number, int), tow.middles, 1e-3 * ones,
        1e-3 * ones, 1e-3 * ones, 1e-3 * ones, 0.0 * ones,
    )  # fmt: skip
    nothing = GroupRows(none.astype(int), none.astype(int), none, none, none, none, none, none)
    empty = LinearGroup(nothing, np.zeros((0, SHARED)), none)
    groups = (LinearGroup(rows, columns, AWAY * ones), *(empty,) * (len(GROUPS) - 1))
    data = LinearData((groups,), (slice(SHARED, SHARED),), SHARED, ErrorTimes())
    return SimpleNamespace(
        linear=(SimpleNamespace(tow=tow),), data=data, parameters=(np.zeros(SHARED),),
        sizes=ErrorSizes(), net=(),
    )  # fmt: skip


def windows():
    """One window at the end of each half."""
    return [
        SteadyWindow(state, state, (end - 60) * SECOND, end * SECOND, {}, {}, {}, {})
        for state, end in enumerate((200, 400))
    ]


@pytest.mark.parametrize(('largest', 'reached'), [(0.25, 0.25), (1.0, 1.0), (5.0, AWAY)])
def test_a_state_left_out_is_predicted_by_a_step_as_long_as_the_fit_may_take(
    fit, gear, largest, reached
):
    prior = board_prior(gear)
    predicted = hold_out_states(
        fit, prior, windows(), [(0,)],
        lambda values, chosen, net: np.tile(values[:4], (len(chosen), 1)),
        MotionOptions(largest_step=largest),
    )  # fmt: skip
    steps = (predicted[:, 0] - prior.start[0]) / prior.std[0]
    np.testing.assert_allclose(steps, reached, rtol=1e-3)
    np.testing.assert_allclose(predicted[:, 1:], np.tile(prior.start[1:4], (2, 1)))
