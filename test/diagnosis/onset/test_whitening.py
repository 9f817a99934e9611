"""What an effect leaves in the innovations is its mark, however large it is."""

import numpy as np
import pytest

from trawl_ros.diagnosis.onset.candidates import WATCHED, candidate_table
from trawl_ros.diagnosis.onset.ratios import RatioBank
from trawl_ros.diagnosis.onset.responses import LEAP_TAPS, LOG_TAPS, OnsetResponses
from trawl_ros.diagnosis.onset.stretches import CounterLeap, LastStretch
from trawl_ros.diagnosis.onset.towing import TowedStretch
from trawl_ros.diagnosis.onset.whitening import MOST, WhiteningFilter
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.motion.inputs import INPUT_ERRORS
from trawl_ros.records.channels import CHANNELS, MEASURED

TABLE = candidate_table({'tension_cell': catalogue()['tension_cell']})
TENSIONS = [WATCHED.index(name) for name in MEASURED if name.endswith('tension')]
NOISE = np.array([CHANNELS[name].noise for name in WATCHED])
VALUES = np.array([1e5 if n in TENSIONS else 100.0 for n in range(len(WATCHED))])
K, P = len(WATCHED), len(TABLE.parameters)
STEADY = CounterLeap(0.0, 0.1)


def watched(size, stretches=12):
    """Innovations, marks and evidence of a tension cell that reads too much from the start."""
    nothing = OnsetResponses(
        np.zeros((1, K, P)), np.zeros((1, K, P)), np.zeros((LOG_TAPS, K)), np.ones((1, P)),
        np.zeros((LEAP_TAPS, K, 2)),
    )  # fmt: skip
    filtered = WhiteningFilter(np.zeros(12), np.eye(12), nothing, 1.0)
    bank = RatioBank(TABLE, stretches + 1, filtered.size)
    by_values = np.zeros((K, P))
    by_values[TENSIONS, 0] = 1.0
    by_coefficients = np.random.default_rng(2).standard_normal((K, 12)) * NOISE[:, None]
    towed = TowedStretch(
        VALUES, by_coefficients, np.zeros((K, len(INPUT_ERRORS))), by_values,
        Situation((400.0, 400.0, 2.2)),
    )  # fmt: skip
    means = VALUES + size * by_values[:, 0]
    seen = []
    for number in range(stretches):
        last = LastStretch(number, number, number + 1, log_std=0.01, leaps=(STEADY, STEADY))
        white = filtered.step(means, NOISE, towed, np.zeros(12), last, np.zeros((K, 6)))
        lasting = np.repeat(by_values[None], stretches + 1, axis=0)
        marks = bank.step(filtered, white, lasting)
        seen.append((white.whitened(white.residual), marks[number, :, 0]))
    return seen, {TABLE.candidates[one.candidate].name: one for one in bank.best()}


@pytest.mark.parametrize('stds', [1.0, 30.0, 1000.0])
def test_innovations_are_the_marks_of_what_made_them_and_never_beyond_the_edge(stds):
    size = stds * NOISE[TENSIONS[0]]
    seen, evidence = watched(size)
    for innovations, mark in seen:
        np.testing.assert_allclose(innovations, size * mark, rtol=1e-6, atol=1e-6)
        assert np.abs(innovations).max() <= MOST + 1e-9
    told = evidence['tension_cell']
    assert told.ratio == max(one.ratio for one in evidence.values())
