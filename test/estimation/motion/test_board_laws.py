"""Boards of other laws are fitted from the steady parts of a tow."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.fit.error_terms import group_of
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.fit import fit_steady
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS, TowInputs
from trawl_ros.estimation.motion.towing.lineariser import linearise_tow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint
from trawl_ros.lab.benchmark.motion import NOISE
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import MEASURED


def steady_states(states):
    """Tow of two steady stretches in each state, one stretch of motion apart."""
    grid = np.arange(0.0, 60.0 * 3 * len(states) + 0.5)
    number = np.minimum((grid / 180.0).astype(int), len(states) - 1)
    values = np.array([(length, length, speed) for length, speed in states])[number]
    n, still = 3 * len(states), np.zeros(len(grid))
    channels = tuple(name for name in MEASURED if group_of(name) in NOISE)
    noise = np.tile([NOISE[group_of(name)] for name in channels], (n, 1))
    return MovingTow(
        'states', 0, 3.0, 60.0, channels, np.zeros((n, len(channels))), noise,
        np.ones((n, len(channels)), dtype=int), np.full((n, len(channels), 21), 1.0 / 21.0),
        TowInputs(1.0, values, np.zeros((len(grid), 3)), still, still),
        held_s=np.tile([0.0, 60.0, 60.0], len(states)),
    )  # fmt: skip


# Close to its stall a board has two steady states, and a fit by equilibria jumps between them.
@pytest.mark.parametrize('board_of_law', ['foil', 'tilted table', 'heel'], indirect=True)
def test_parameters_are_found_within_their_intervals(board_of_law):
    gear, prior = TowedGear(build_model(board_of_law.gear)), board_prior(board_of_law.gear)
    truth, states = board_of_law.values, board_of_law.states
    point = TowedPoint(truth, 0.0, np.zeros(len(INPUT_ERRORS)), np.zeros(0))
    tow = steady_states(states).only_steady()
    seen = linearise_tow(gear, tow, point)
    assert seen.towed.sum() == 2 * len(states), seen.left_out[-3:]
    fit = fit_steady(gear, [replace(tow, means=seen.values)], prior, MotionOptions())
    assert fit.converged, fit.reason
    std = np.sqrt(np.diag(fit.covariance))
    assert np.all(np.abs(fit.values - truth) < 1.96 * std)
    ratio = dict(zip(prior.names, std / prior.std, strict=True))
    assert all(ratio[name] < 0.5 for name in board_of_law.well_known)
    # Lift at the angles where the boards work is known far better than before.
    spread = board_of_law.lift(fit.values, fit.covariance)[1]
    assert spread < 0.5 * board_of_law.lift(prior.start, np.diag(prior.std**2))[1]
