"""States that are left out of a fit in motion: the step they are predicted by, and its inputs."""

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
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.lab.benchmark.motion import course_tow
from trawl_ros.records.channels import INPUTS

SHARED = 14
OF_ERRORS = slice(SHARED, SHARED + len(INPUT_ERRORS))
LOG = next(n for n, error in enumerate(INPUT_ERRORS) if error.channel == 'speed')
AWAY = 1.5
"""Where the readings have one parameter, in prior std from where they are linearised."""

SHOWN = 420.0, 421.0, 2.2


def fit_of(column, tows=1):
    """Tows in two halves, all of whose readings want the parameter of one column elsewhere."""
    tow = course_tow(400.0)
    number = len(tow)
    ones, none = np.ones(number), np.zeros(0)
    columns = np.zeros((number, OF_ERRORS.stop))
    columns[:, column] = 1.0
    rows = GroupRows(
        np.arange(number), np.zeros(number, int), tow.middles, 1e-3 * ones,
        1e-3 * ones, 1e-3 * ones, 1e-3 * ones, 0.0 * ones,
    )  # fmt: skip
    nothing = GroupRows(none.astype(int), none.astype(int), none, none, none, none, none, none)
    empty = LinearGroup(nothing, np.zeros((0, OF_ERRORS.stop)), none)
    groups = (LinearGroup(rows, columns, AWAY * ones), *(empty,) * (len(GROUPS) - 1))
    no_log = slice(OF_ERRORS.stop, OF_ERRORS.stop)
    return SimpleNamespace(
        linear=(SimpleNamespace(tow=tow),) * tows,
        data=LinearData((groups,) * tows, (no_log,) * tows, SHARED, ErrorTimes()),
        parameters=(np.zeros(OF_ERRORS.stop),) * tows, sizes=ErrorSizes(), net=(),
        layouts=(SimpleNamespace(slices={'errors': OF_ERRORS}),) * tows,
    )  # fmt: skip


def windows(tows=(0, 0)):
    """One window at the end of each half."""
    return [
        SteadyWindow(
            state, state, (end - 60) * SECOND, end * SECOND,
            dict(zip(INPUTS, SHOWN, strict=True)), {}, {}, {}, tow=tow,
        )
        for state, (end, tow) in enumerate(zip((200, 400), tows, strict=True))
    ]  # fmt: skip


@pytest.mark.parametrize(('largest', 'reached'), [(0.25, 0.25), (1.0, 1.0), (5.0, AWAY)])
def test_a_state_left_out_is_predicted_by_a_step_as_long_as_the_fit_may_take(
    gear, largest, reached
):
    prior = board_prior(gear)
    predicted = hold_out_states(
        fit_of(0), prior, windows(), [(0,)],
        lambda values, chosen, net, inputs: np.tile(values[:4], (len(chosen), 1)),
        MotionOptions(largest_step=largest),
    )  # fmt: skip
    steps = (predicted[:, 0] - prior.start[0]) / prior.std[0]
    np.testing.assert_allclose(steps, reached, rtol=1e-3)
    np.testing.assert_allclose(predicted[:, 1:], np.tile(prior.start[1:4], (2, 1)))


def inputs_of(fit, left_out, tow_of, gear):
    """Inputs (n, 4) of the windows, the last NaN, with which they are predicted."""
    return hold_out_states(
        fit, board_prior(gear), left_out, tow_of,
        lambda values, chosen, net, inputs: np.column_stack((inputs, np.nan * inputs[:, :1])),
        MotionOptions(),
    )[:, :3]  # fmt: skip


def test_a_log_that_errs_in_the_rest_of_a_tow_errs_in_the_state_that_is_left_out(gear):
    inputs = inputs_of(fit_of(SHARED + LOG), windows(), [(0,)], gear)
    error = INPUT_ERRORS[LOG]
    speed = SHOWN[2] - AWAY * error.std * (SHOWN[2] if error.relative else 1.0)
    np.testing.assert_allclose(inputs, np.tile((*SHOWN[:2], speed), (2, 1)), rtol=1e-4)


def test_nothing_is_known_of_a_log_in_a_tow_that_is_left_out_whole(gear):
    inputs = inputs_of(fit_of(SHARED + LOG, tows=2), windows((0, 1)), [(0,), (1,)], gear)
    np.testing.assert_allclose(inputs, np.tile(SHOWN, (2, 1)))
