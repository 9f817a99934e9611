"""Outcome of a fit of tows: calibration errors of the instruments, and what the data tell."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.motion.holdout import HeldOut
from trawl_ros.estimation.motion.outcome import MotionOutcome
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.lab.benchmark.motion import run_motion_trial

SILENT = 'vertical_opening'


@pytest.fixture(scope='module')
def outcome(coarse):
    trial = run_motion_trial(TowedGear(coarse), 11, errors=True, duration_s=80.0, std_factor=0.05)
    (linear,) = trial.fit.linear
    means = linear.tow.means.copy()
    means[:, linear.tow.channels.index(SILENT)] = np.nan
    silent = replace(linear, tow=replace(linear.tow, means=means))
    return MotionOutcome(replace(trial.fit, linear=(silent,)), trial.prior, (0,), (), HeldOut())


def test_biases_are_those_of_instruments_that_were_read(outcome):
    biases = {bias.channel: bias for bias in outcome.tow_biases}
    assert SILENT not in biases
    assert {'port_length', 'speed', 'door_spread', 'port_pitch'} <= set(biases)
    for bias in biases.values():
        assert np.isfinite(bias.value)
        assert 0.0 < bias.std <= 1.001 * bias.known


def test_the_posterior_is_that_of_the_estimate(outcome):
    np.testing.assert_allclose(outcome.posterior.covariance, outcome.fit.covariance, rtol=1e-6)
