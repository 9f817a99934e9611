"""Boards of other laws are fitted: corrections to tables, and laws with their own parameters.

Readings of the latter are from a plant with twice as many meshes and segments as the model.
"""

from typing import Any

import numpy as np
import pytest

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.from_gear import board_prior, estimator_options
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.predict import Predictor


def test_parameters_are_found_within_their_intervals(board_of_law: Any) -> None:
    model, prior = build_model(board_of_law.model), board_prior(board_of_law.gear)
    truth, near = board_of_law.values, None
    plant = build_model(board_of_law.plant).with_coefficients(truth)
    estimator = Estimator(Predictor(model), prior, OBSERVABLES, estimator_options())
    for index, (length, speed) in enumerate(board_of_law.states):
        near = find_equilibrium(plant, OperatingPoint(length, length, speed), near)
        means = {name: getattr(near.observables, name) for name in MEASURED}
        means |= dict(zip(INPUTS, (length, length, speed), strict=True))
        bias = {name: CHANNELS[name].bias_std(mean) for name, mean in means.items()}
        noise = {name: 0.1 * size for name, size in bias.items()}
        start, counts = index * 10**12, dict.fromkeys(means, 60)
        estimator.add(
            SteadyWindow(index, index, start, start + 6 * 10**10, means, noise, bias, counts)
        )
    estimate = estimator.finish()
    assert estimate is not None
    assert estimate.converged, estimate.reason
    assert estimate.names == board_of_law.gear.board.parameters.names
    # Of a dozen intervals of 95 % about one misses.
    assert np.sum((estimate.low <= truth) & (truth <= estimate.high)) >= len(truth) - 1
    shrink = dict(zip(estimate.names, estimate.shrink, strict=True))
    assert all(shrink[name] > 0.5 for name in board_of_law.well_known)
    # Lift at the angles where the boards work is known far better than before.
    after, std = board_of_law.lift(estimate.values, estimate.covariance)
    assert std < 0.5 * board_of_law.lift(prior.start, np.diag(prior.std**2))[1]
    true = board_of_law.lift(truth, estimate.covariance)[0]
    assert after == pytest.approx(true, abs=2.0 * std)
