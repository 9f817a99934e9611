"""The line search of a fit: steps that are taken, and those that are not worth their windows."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.line_search import NO_GAIN, SMALL, line_search


class Counted:
    """Predictor that counts the windows it is asked to solve."""

    def __init__(self, model) -> None:
        self.model, self.solves = model, 0

    def predict(self, *given):
        self.solves += 1
        return self.model.predict(*given)


@pytest.mark.parametrize(('away', 'tried'), [(0.8 * SMALL, False), (20.0 * SMALL, True)])
def test_windows_are_not_solved_anew_for_a_step_that_gains_nothing(sea, model, prior, away, tried):
    estimator = Estimator(model, prior, sea.OBSERVABLES, EstimatorOptions())
    for window in sea.trial_windows(model, np.random.default_rng(0), noise=0.0):
        estimator.add(window)
    covariance, fit = estimator.finish().covariance, estimator.fit
    # So many tolerances of one coefficient, the others going along, where the cost rises least.
    along = covariance[0] / np.sqrt(covariance[0, 0])
    aside = fit.coefficients + away * fit.options.tolerance * along
    counted = Counted(model)
    # With a threshold of nothing every step wants all windows anew.
    step = line_search(replace(fit, coefficients=aside), counted, tuple(sea.OBSERVABLES), 0.0)
    assert not step.needless
    assert (counted.solves > 0) == tried
    assert (step.obstacle == NO_GAIN) != tried
