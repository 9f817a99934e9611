"""Boards that fall at the start of the prior are fitted from where they were seen to stand."""

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.from_gear import board_prior, predictor_for
from trawl_ros.lab.trials.linearised_plant import LinearisedState, MeshResolution
from trawl_ros.lab.trials.readings import AS_STATED, steady_windows
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.trimming.drawn_board import draw_board, fastened_as

PLACES = (415.0, 2.3), (600.0, 2.1)
NOTHING = np.empty(0)


@pytest.fixture(scope='module')
def rigged():
    """Gear rigged for boards that were drawn, their coefficients, and a window of each state."""
    gear = MeshResolution(12).model('kaifuha')
    plant = draw_board(gear, PLACES, np.random.default_rng(3))
    predictor = predictor_for(plant.gear)
    found = [
        predictor.predict(plant.coefficients, place[0], *place, plant.steady[place])
        for place in PLACES
    ]
    states = [
        LinearisedState(place, own.values, NOTHING, NOTHING)
        for place, own in zip(PLACES, found, strict=True)
    ]
    windows = steady_windows([states], AS_STATED, np.random.default_rng(1))
    return fastened_as(gear, plant.gear), plant.coefficients, windows


def test_a_fit_begins_where_the_boards_stand(rigged):
    gear, truth, windows = rigged
    predictor, prior = predictor_for(gear), board_prior(gear)
    with pytest.raises(NoSteadyState):
        predictor.predict(prior.start, PLACES[0][0], *PLACES[0])
    estimator = Estimator(predictor, prior, OBSERVABLES)
    for window in windows:
        estimator.add(window)
    estimate = estimator.finish()
    assert len(estimator.windows) == len(PLACES)
    assert estimate.converged, estimate.reason
    away = np.abs(estimate.values - truth) / estimate.std
    assert np.median(away) < 2.0
