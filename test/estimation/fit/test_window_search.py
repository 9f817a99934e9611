# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The search of a fit to windows: steps that are taken, and those not worth solving windows."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.window_search import WindowSearch
from trawl_ros.estimation.least_squares.descent import DescentOptions, descend


class Counted:
    """Predictor that counts the windows it is asked to solve."""

    def __init__(self, model) -> None:
        self.model, self.solves = model, 0

    def predict(self, *given):
        self.solves += 1
        return self.model.predict(*given)


@pytest.mark.parametrize(('away', 'tried'), [(0.02, False), (1.0, True)])
def test_windows_are_not_solved_again_for_a_step_that_gains_nothing(sea, model, prior, away, tried):
    estimator = Estimator(model, prior, sea.OBSERVABLES, EstimatorOptions())
    for window in sea.trial_windows(model, np.random.default_rng(0), noise=0.0):
        estimator.add(window)
    covariance, fit = estimator.finish().covariance, estimator.fit
    # So many std of one coefficient, the others going along, where the cost rises least.
    along = covariance[0] / np.sqrt(covariance[0, 0])
    aside = replace(fit, coefficients=fit.coefficients + away * along)
    counted = Counted(model)
    # With a threshold of nothing every step wants all windows solved again.
    search = WindowSearch(aside, counted, tuple(sea.OBSERVABLES), 0.0)
    rest = descend(search, DescentOptions(iterations=1, attempts=7, tolerance=0.02))
    assert rest.converged != tried
    assert (counted.solves > 0) == tried
