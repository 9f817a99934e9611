"""What an effect leaves in the innovations is its mark; errors as found make them white."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.diagnosis.onset import whitening
from trawl_ros.diagnosis.onset.candidates import WATCHED, candidate_table
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.ratios import FEWEST, MOVING, RatioBank, rarity
from trawl_ros.diagnosis.onset.responses import LEAP_TAPS, LOG_TAPS, OnsetResponses
from trawl_ros.diagnosis.onset.stretches import LIVE, CounterLeap, LastStretch
from trawl_ros.diagnosis.onset.towing import TowedStretch
from trawl_ros.diagnosis.onset.whitening import (
    AWAY,
    LEANING,
    LEANING_S,
    MAX_INNOVATION,
    WhiteningFilter,
)
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.motion.processes import ErrorSizes
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.records.channels import CHANNELS, MEASURED

TABLE = candidate_table({'tension_cell': catalogue()['tension_cell']})
TENSIONS = [WATCHED.index(name) for name in MEASURED if name.endswith('tension')]
NOISE = np.array([CHANNELS[name].noise for name in WATCHED])
VALUES = np.array([1e5 if n in TENSIONS else 100.0 for n in range(len(WATCHED))])
K, P = len(WATCHED), len(TABLE.parameters)
STEADY = CounterLeap(0.0, 0.1)


KNOWN = Knowledge(np.zeros(12), np.eye(12))


def responses(by_log=0.0):
    """Responses of a gear that follows at once, to 1 m/s by ``by_log`` in all channels."""
    log = np.zeros((LOG_TAPS, K))
    log[0] = by_log
    return OnsetResponses(
        np.zeros((1, K, P)), np.zeros((1, K, P)), log, np.ones((1, P)), np.zeros((LEAP_TAPS, K, 2))
    )


def watched(size, stretches=12, begin=0, winches=()):
    """Innovations, marks and evidence of a tension cell that begins to read too much, and winches
    that run in some stretches.
    """
    nothing = responses()
    filtered = WhiteningFilter(KNOWN, nothing, 1.0)
    bank = RatioBank(TABLE, stretches + 1, filtered.size)
    by_values = np.zeros((K, P))
    by_values[TENSIONS, 0] = 1.0
    by_coefficients = np.random.default_rng(2).standard_normal((K, 12)) * NOISE[:, None]
    towed = TowedStretch(
        VALUES, by_coefficients, np.zeros((K, len(INPUT_ERRORS))), by_values,
        Situation((400.0, 400.0, 2.2)),
    )  # fmt: skip
    seen = []
    for number in range(stretches):
        means = VALUES + (number >= begin) * size * by_values[:, 0]
        last = LastStretch(
            number, number, number + 1, log_std=0.01, leaps=(STEADY, STEADY),
            moves=(number in winches, False),
        )  # fmt: skip
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
        assert np.abs(innovations).max() <= MAX_INNOVATION + 1e-9
    told = evidence['tension_cell']
    assert told.ratio == max(one.ratio for one in evidence.values())


def test_more_is_asked_for_of_an_onset_near_winches_that_run():
    size, begin = 15.0 * NOISE[TENSIONS[0]], 6
    evidence = {
        winches: watched(size, begin=begin, winches=winches)[1]['tension_cell']
        for winches in ((), (begin,), (begin + FEWEST,), (begin + FEWEST + 1,))
    }
    still = evidence[()]
    freedom = len(TABLE.candidates[still.candidate].columns)
    assert still.age == 12 - 1 - begin
    assert still.rarity == pytest.approx(rarity(still.ratio, freedom))
    for winches, one in evidence.items():
        asked = rarity(one.ratio, freedom) - one.rarity
        near = any(begin <= number <= begin + FEWEST for number in winches)
        assert asked == pytest.approx(MOVING if near else 0.0, abs=0.5), winches


def innovations(known, by_log=0.0, noise=1.0, log=0.0, stretches=200):
    """Innovations (n, k) where means scatter by so many of their `NOISE`, and the log by ``log``
    (m/s) more than its readings show.
    """
    rng = np.random.default_rng(7)
    filtered = WhiteningFilter(known, responses(by_log), 1.0)
    towed = TowedStretch(
        VALUES, np.zeros((K, 12)), np.zeros((K, len(INPUT_ERRORS))), np.zeros((K, P)),
        Situation((400.0, 400.0, 2.2)),
    )  # fmt: skip
    found = []
    for number in range(stretches):
        last = LastStretch(number, number, number + 1, log_std=0.005, leaps=(STEADY, STEADY))
        means = VALUES + noise * NOISE * rng.standard_normal(K) + log * by_log * rng.normal()
        white = filtered.step(means, NOISE, towed, np.zeros(12), last, np.zeros((K, 6)))
        found.append(white.whitened(white.residual))
    return np.array(found[10:])


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


THRICE = ErrorSizes(noise=(3.0,) * len(GROUPS))
DENSITIES = {name: 3.0 * CHANNELS[name].noise * np.sqrt(LIVE.stretch_s) for name in WATCHED}


@pytest.mark.parametrize('told', [{'sizes': THRICE}, {'densities': DENSITIES}])
def test_means_that_scatter_more_than_their_readings_show_are_white_by_what_was_found(told):
    assert rms(innovations(KNOWN, noise=3.0)) > 1.9
    assert rms(innovations(replace(KNOWN, **told), noise=3.0)) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(
    'told', [{'sizes': ErrorSizes(log=4.0)}, {'densities': {'speed': 0.02 * LIVE.stretch_s**0.5}}]
)
def test_a_log_that_is_worse_than_its_readings_show_is_white_by_what_was_found(told):
    by_log = 400.0 * NOISE
    assert rms(innovations(KNOWN, by_log, log=0.02)) > 1.2
    found = innovations(replace(KNOWN, **told), by_log, log=0.02)
    assert rms(found) == pytest.approx(1.0, abs=0.1)


def test_less_than_readings_scatter_changes_nothing():
    quiet = replace(KNOWN, densities=dict.fromkeys((*WATCHED, 'speed'), 1e-9))
    np.testing.assert_array_equal(innovations(quiet), innovations(KNOWN))


def test_what_changes_with_states_changes_by_as_much_as_was_found():
    by_state = ErrorSizes(state=(3.0,) * len(GROUPS))
    leaps = []
    for known in (KNOWN, replace(KNOWN, sizes=by_state)):
        filtered = WhiteningFilter(known, responses(), 1.0)
        filtered.begin_state()
        leaps.append(np.diag(filtered.variance)[filtered.calibrations] - 1.0)
    np.testing.assert_allclose(leaps[1], 9.0 * leaps[0])


def test_a_prediction_is_the_less_exact_the_farther_boards_are_from_those_towed_with():
    """Derivatives are of those: what coefficients change is wrong by a part of it."""
    by_coefficients = np.zeros((K, 12))
    by_coefficients[:, 0] = 100.0 * NOISE
    towed = TowedStretch(
        VALUES, by_coefficients, np.zeros((K, len(INPUT_ERRORS))), np.zeros((K, P)),
        Situation((400.0, 400.0, 2.2)),
    )  # fmt: skip
    sharp = replace(KNOWN, covariance=1e-6 * np.eye(12))
    last = LastStretch(0, 0, 1, log_std=0.01, leaps=(STEADY, STEADY))
    found = []
    for far in (0.0, 10.0):
        at = np.eye(12)[0] * far
        filtered = WhiteningFilter(sharp, responses(), 1.0)
        white = filtered.step(VALUES, NOISE, towed, at, last, np.zeros((K, 6)))
        found.append(np.linalg.norm(white.root, axis=1))
    assert (found[1] >= 0.99 * AWAY * 1000.0 * NOISE).all()
    assert (found[0] < 0.1 * found[1]).any()


def test_a_stretch_in_which_winches_run_tells_less_of_what_lasts(monkeypatch):
    still = TowedStretch(
        VALUES, np.zeros((K, 12)), np.zeros((K, len(INPUT_ERRORS))), np.zeros((K, P)),
        Situation((400.0, 400.0, 2.2)),
    )  # fmt: skip

    def variances(leaning, moves):
        """Variances of the innovations in two stretches, of which warps run in the first."""
        monkeypatch.setattr(whitening, 'LEANING', leaning)
        filtered, found = WhiteningFilter(KNOWN, responses(), 1.0), []
        for number in range(2):
            last = LastStretch(
                number, number, number + 1, log_std=0.01, leaps=(STEADY, STEADY),
                moves=(moves and number == 0, False),
            )  # fmt: skip
            white = filtered.step(VALUES, NOISE, still, np.zeros(12), last, np.zeros((K, 6)))
            found.append(np.sum(white.root**2, axis=1))
        return np.array(found)

    more = (variances(LEANING, True) - variances(0.0, True)) / still.model_error**2
    np.testing.assert_allclose(more[0], LEANING**2)
    # In the next a part of that is left, and less is known from the first.
    faded = LEANING**2 * np.exp(-2.0 * LIVE.stretch_s / LEANING_S)
    assert (more[1] > faded).all()
    assert (more[1] < LEANING**2).all()
    np.testing.assert_array_equal(variances(LEANING, False), variances(0.0, False))
