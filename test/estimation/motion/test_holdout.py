"""Tows and states that are left out of a fit: what they are predicted by."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.estimation.fit.error_terms import GROUPS, group_of
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.holdout import hold_out_states
from trawl_ros.estimation.motion.information import LinearGroup
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes, GroupRows
from trawl_ros.estimation.motion.sizes import LinearData
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.lab.benchmark.motion import course_tow

SHARED = 14
OF_MODEL = slice(13, SHARED)
OF_ERRORS = slice(SHARED, SHARED + len(INPUT_ERRORS))
OF_SENSORS = slice(OF_ERRORS.stop, OF_ERRORS.stop + 1)
AWAY = 1.5
"""Where the readings have one parameter, in prior std from where they are linearised."""

MEASURED = 100.0
STEADY = {'first': slice(4, 8), 'second': slice(14, 20)}


def fit_of(column, tows=1):
    """Tows with two steady states, all of whose readings want the parameter of one column away."""
    tow = course_tow(400.0)
    number = len(tow)
    held = np.zeros(number)
    for own in STEADY.values():
        held[own] = 300.0
    tow = replace(tow, means=np.full(tow.means.shape, MEASURED), held_s=held)
    groups = []
    for group in GROUPS:
        channels = [i for i, name in enumerate(tow.channels) if group_of(name) == group]
        rows = np.repeat(np.arange(number), len(channels))
        small = np.full(len(rows), 1e-3)
        columns = np.zeros((len(rows), OF_SENSORS.stop))
        columns[:, column] = 1.0
        there = GroupRows(
            rows, np.tile(channels, number).astype(int), tow.middles[rows],
            small, small, small, small, 0.0 * small,
        )  # fmt: skip
        groups.append(LinearGroup(there, columns, AWAY * np.ones(len(rows))))
    no_log = slice(OF_SENSORS.stop, OF_SENSORS.stop)
    slices = {'model': OF_MODEL, 'errors': OF_ERRORS, 'calibration': OF_SENSORS}
    return SimpleNamespace(
        linear=(SimpleNamespace(tow=tow, values=tow.means),) * tows,
        data=LinearData((tuple(groups),) * tows, (no_log,) * tows, SHARED, ErrorTimes()),
        parameters=(np.zeros(OF_SENSORS.stop),) * tows, sizes=ErrorSizes(),
        layouts=(SimpleNamespace(slices=slices),) * tows,
    )  # fmt: skip


def reached(fit, gear, tow_of=(0,), **options):
    """Change of the predictions by the parameter, in the steady stretches."""
    found = hold_out_states(fit, board_prior(gear), tow_of, MotionOptions(**options))
    np.testing.assert_allclose(found.measured, MEASURED)
    assert found.predicted.shape == (10 * len(fit.linear), len(PAPER_CHANNELS))
    return found, found.predicted - MEASURED + AWAY


@pytest.mark.parametrize(('largest', 'step'), [(0.25, 0.25), (1.0, 1.0), (5.0, AWAY)])
def test_a_state_left_out_is_predicted_by_a_step_as_long_as_the_fit_may_take(gear, largest, step):
    found, change = reached(fit_of(0), gear, largest_step=largest)
    assert (found.by, found.groups) == ('state', 2)
    np.testing.assert_allclose(change, step, rtol=1e-3)


def test_a_log_that_errs_in_the_rest_of_a_tow_errs_in_the_state_that_is_left_out(gear):
    _, change = reached(fit_of(OF_ERRORS.start), gear)
    np.testing.assert_allclose(change, AWAY, rtol=1e-3)


def test_nothing_is_known_of_a_log_in_a_tow_that_is_left_out_whole(gear):
    found, change = reached(fit_of(OF_ERRORS.start, tows=2), gear, (0, 1))
    assert (found.by, found.groups) == ('tow', 2)
    assert found.tows.tolist() == [0] * 10 + [1] * 10
    np.testing.assert_allclose(change, 0.0, atol=1e-9)


def test_parts_of_one_tow_are_left_out_together(gear):
    _, change = reached(fit_of(OF_ERRORS.start, tows=3), gear, (0, 0, 1))
    np.testing.assert_allclose(change, 0.0, atol=1e-9)


@pytest.mark.parametrize('column', [OF_MODEL.start, OF_SENSORS.start])
def test_errors_of_sensors_and_model_are_no_part_of_a_prediction(gear, column):
    _, change = reached(fit_of(column), gear)
    np.testing.assert_allclose(change, 0.0, atol=1e-9)


def test_one_state_cannot_be_left_out(gear):
    fit = fit_of(0)
    held = np.zeros(len(fit.linear[0].tow))
    held[STEADY['second']] = 300.0
    fit.linear[0].tow = replace(fit.linear[0].tow, held_s=held)
    found = hold_out_states(fit, board_prior(gear), (0,), MotionOptions())
    assert found.groups == 1
    assert np.isnan(found.predicted).all()


def test_states_of_two_parts_of_a_tow_are_counted_apart(gear):
    found, _ = reached(fit_of(0, tows=2), gear, (0, 0))
    assert (found.by, found.groups) == ('state', 4)
