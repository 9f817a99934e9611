"""Errors as found make the innovations white, and manoeuvres tell less of what lasts."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.part import LIVE
from trawl_ros.diagnosis.onset.residuals import (
    MODEL_FACTOR_IN_MANOEUVRES,
    PASSING_MODEL_FACTOR,
    STATED_STD_FACTOR,
    UNREST_S,
    belief_of,
    log_factor,
    residual_rows,
    unrest_of,
)
from trawl_ros.effects.effect_set import NO_EFFECTS
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.motion.processes import ErrorSizes
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS, TowInputs
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS

STRETCHES, K = 5, len(WATCHED)
NOISE = np.array([CHANNELS[name].noise for name in WATCHED])
KNOWN = Knowledge(np.zeros(12), 1e-6 * np.eye(12))


@pytest.fixture(scope='module')
def gear(coarse_gear):
    return TowedGear(build_model(load_gear(coarse_gear)), NO_EFFECTS)


@pytest.fixture(scope='module')
def linear(gear):
    """Tow whose means are as predicted, and which nothing changes."""
    grid = np.zeros((STRETCHES * 30 + 1, 3))
    tow = MovingTow(
        'a tow', 0, 3.0, 30.0, WATCHED, np.full((STRETCHES, K), 100.0),
        np.tile(NOISE, (STRETCHES, 1)), np.ones((STRETCHES, K), int),
        np.full((STRETCHES, K, 11), 1.0 / 11.0), TowInputs(1.0, grid, grid, *grid.T[:2]),
    )  # fmt: skip
    point = TowedPoint(np.zeros(12), 0.0, np.zeros(len(INPUT_ERRORS)), np.zeros(0))
    found = LinearisedTow.of(tow, point, gear, [], ())
    found.values[:] = 100.0
    return found


@pytest.fixture
def variances(gear, linear):
    """Variances (n, k) of the residuals by what is known of the errors."""

    def of(known, unrest=0.0, absorbed=None):
        none = np.zeros((STRETCHES, K, 0)) if absorbed is None else absorbed
        rows = residual_rows(
            gear, linear, belief_of(known), known,
            log_density=1.0, unrest=np.full(STRETCHES, unrest), absorbed=none,
        )  # fmt: skip
        found = np.zeros((STRETCHES, K))
        found[rows.stretches, rows.channels] = np.diag(rows.covariance)
        assert (np.diff(rows.stretches) >= 0).all()
        return found

    return of


THRICE = ErrorSizes(noise=(3.0,) * len(GROUPS))
DENSITIES = {name: 3.0 * CHANNELS[name].noise * np.sqrt(LIVE.stretch_s) for name in WATCHED}


@pytest.mark.parametrize('told', [{'sizes': THRICE}, {'densities': DENSITIES}])
def test_means_scatter_by_what_was_found(variances, told):
    more = variances(replace(KNOWN, **told)) - variances(KNOWN)
    np.testing.assert_allclose(
        more, np.tile(8.0 * (STATED_STD_FACTOR * NOISE) ** 2, (STRETCHES, 1)), rtol=1e-6
    )


def test_less_than_readings_scatter_changes_nothing(variances):
    quiet = replace(KNOWN, densities=dict.fromkeys((*WATCHED, 'speed'), 1e-9))
    np.testing.assert_array_equal(variances(quiet), variances(KNOWN))


def test_a_log_that_is_worse_than_its_readings_show_is_as_bad_as_was_found():
    for told, factor in (
        ({}, 1.0), ({'densities': {'speed': 0.06}}, 3.0), ({'sizes': ErrorSizes(log=4.0)}, 4.0),
    ):  # fmt: skip
        assert log_factor(replace(KNOWN, **told), density=0.02) == pytest.approx(factor)


def test_in_a_manoeuvre_the_model_is_less_exact(variances):
    without = replace(KNOWN, sizes=ErrorSizes(model=(0.0,) * len(GROUPS)))
    still = variances(KNOWN) - variances(without)
    moving = variances(KNOWN, unrest=1.0) - variances(without)
    factor = MODEL_FACTOR_IN_MANOEUVRES**2 + PASSING_MODEL_FACTOR**2
    np.testing.assert_allclose(moving, factor * still, rtol=1e-6)
    unrest = unrest_of([False, True, False, True])
    np.testing.assert_allclose(unrest, [0.0, 1.0, np.exp(-LIVE.stretch_s / UNREST_S), 1.0])


def test_what_was_found_before_may_be_of_any_size_up_to_its_prior(variances):
    absorbed = np.zeros((STRETCHES, K, 1))
    absorbed[3:, 0] = 7.0
    more = variances(KNOWN, absorbed=absorbed) - variances(KNOWN)
    np.testing.assert_allclose(more, np.square(absorbed[..., 0]), atol=1e-6)
