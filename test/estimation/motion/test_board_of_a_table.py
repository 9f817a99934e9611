"""A board of another law is refitted from the steady parts of a tow by corrections to it."""

from dataclasses import replace

import numpy as np

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
from trawl_ros.records.coefficients import COEFFICIENTS

STATES = ((300.0, 1.4), (450.0, 1.3), (600.0, 1.2), (600.0, 1.4))
HIDDEN = {'c1': 0.04, 'c2': 0.12}
"""Corrections of the boards at sea: more drag and more lift than the table says."""


def steady_states():
    """Tow of two steady stretches in each state, one stretch of motion apart."""
    grid = np.arange(0.0, 60.0 * 3 * len(STATES) + 0.5)
    number = np.minimum((grid / 180.0).astype(int), len(STATES) - 1)
    values = np.array([(length, length, speed) for length, speed in STATES])[number]
    n, still = 3 * len(STATES), np.zeros(len(grid))
    channels = tuple(name for name in MEASURED if group_of(name) in NOISE)
    noise = np.tile([NOISE[group_of(name)] for name in channels], (n, 1))
    return MovingTow(
        'states', 0, 3.0, 60.0, channels, np.zeros((n, len(channels))), noise,
        np.ones((n, len(channels)), dtype=int), np.full((n, len(channels), 21), 1.0 / 21.0),
        TowInputs(1.0, values, np.zeros((len(grid), 3)), still, still),
        held_s=np.tile([0.0, 60.0, 60.0], len(STATES)),
    )  # fmt: skip


def test_hidden_corrections_are_found_within_their_intervals(lawful):
    gear, prior = TowedGear(build_model(lawful)), board_prior(lawful)
    truth = np.array([HIDDEN.get(name, 0.0) for name in COEFFICIENTS])
    point = TowedPoint(truth, 0.0, np.zeros(len(INPUT_ERRORS)), np.zeros(0))
    tow = steady_states().only_steady()
    seen = linearise_tow(gear, tow, point)
    assert seen.towed.sum() == 2 * len(STATES)
    fit = fit_steady(gear, [replace(tow, means=seen.values)], prior, MotionOptions())
    assert fit.converged, fit.reason
    std = np.sqrt(np.diag(fit.covariance))
    assert np.all(np.abs(fit.values - truth) < 1.96 * std)
    # Lift at the angles where the boards work is known far better than before.
    working = np.array([0.0, 0.0, np.radians(16.0), 1.0, *np.zeros(8)])
    spread = np.sqrt(working @ fit.covariance @ working)
    assert spread < 0.5 * np.sqrt(working**2 @ prior.std**2)
