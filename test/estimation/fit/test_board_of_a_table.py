"""A board of another law is refitted by corrections to it, as one of eq. 14 is."""

import numpy as np
import pytest

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.from_gear import board_prior, estimator_options
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.predict import Predictor

STATES = ((300.0, 1.4), (300.0, 1.2), (450.0, 1.3), (600.0, 1.2), (600.0, 1.4), (800.0, 1.3))
HIDDEN = {'c1': 0.04, 'c2': 0.12}
"""Corrections of the boards at sea: more drag and more lift than the table says."""


def test_hidden_corrections_are_found_within_their_intervals(lawful: GearRecord) -> None:
    model, prior = build_model(lawful), board_prior(lawful)
    truth = np.array([HIDDEN.get(name, 0.0) for name in COEFFICIENTS])
    plant, near = model.with_coefficients(truth), None
    estimator = Estimator(Predictor(model), prior, OBSERVABLES, estimator_options())
    for index, (length, speed) in enumerate(STATES):
        near = find_equilibrium(plant, OperatingPoint(length, length, speed), near)
        means = {name: getattr(near.observables, name) for name in MEASURED}
        means |= dict(zip(INPUTS, (length, length, speed), strict=True))
        bias = {name: CHANNELS[name].bias_std(mean) for name, mean in means.items()}
        noise = {name: 0.1 * size for name, size in bias.items()}
        start = index * 10**12
        counts = dict.fromkeys(means, 60)
        estimator.add(
            SteadyWindow(index, index, start, start + 6 * 10**10, means, noise, bias, counts)
        )
    estimate = estimator.finish()
    assert estimate.converged, estimate.reason
    assert np.all((estimate.low <= truth) & (truth <= estimate.high))
    # Lift at the angles where the boards work is known far better than before.
    working = np.array([0.0, 0.0, np.radians(16.0), 1.0, *np.zeros(8)])
    spread = np.sqrt(working @ estimate.covariance @ working)
    before = np.sqrt(working**2 @ prior.std**2)
    assert spread < 0.5 * before
    assert working @ estimate.values == pytest.approx(working @ truth, abs=2.0 * spread)
