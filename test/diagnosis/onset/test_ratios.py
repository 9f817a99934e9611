"""The rarity of a likelihood ratio is that of a χ²; an onset leaves its mark from then on."""

import numpy as np
import pytest
from scipy.stats import chi2

from trawl_ros.diagnosis.onset.candidates import WATCHED, candidate_table
from trawl_ros.diagnosis.onset.chain import MAX_INNOVATION, Belief, Chain
from trawl_ros.diagnosis.onset.ratios import FEWEST, MOVING, NEAR, RatioBank, rarity
from trawl_ros.effects.registry import catalogue
from trawl_ros.records.channels import CHANNELS, MEASURED

TABLE = candidate_table({'tension_cell': catalogue()['tension_cell']})
TENSIONS = [WATCHED.index(name) for name in MEASURED if name.endswith('tension')]
NOISE = np.array([CHANNELS[name].noise for name in WATCHED])
K, P = len(WATCHED), len(TABLE.parameters)


def watched(size, stretches=12, begin=0, manoeuvre=None):
    """Innovations, marks and evidence of a tension cell that begins to read too much."""
    rng = np.random.default_rng(2)
    columns = np.tile(rng.standard_normal((K, 12)) * NOISE[:, None], (stretches, 1))
    covariance = columns @ columns.T + np.diag(np.tile(NOISE**2, stretches))
    chain, bank = Chain(Belief(np.zeros(12), np.eye(12))), RatioBank(TABLE, stretches + 1)
    lasting = np.zeros((K, P))
    lasting[TENSIONS, 0] = 1.0
    seen = []
    for number in range(stretches):
        own = slice(number * K, (number + 1) * K)
        residual = (number >= begin) * size * lasting[:, 0]
        link = chain.append(covariance[own, : own.stop], columns[own], residual)
        unrest = float(number == manoeuvre)
        marks = bank.step(link, np.repeat(lasting[None], stretches + 1, axis=0), unrest)
        seen.append((link.innovations, marks[number, :, 0]))
    return seen, {one.candidate.name: one for one in bank.best()}


@pytest.mark.parametrize('stds', [1.0, 30.0, 1000.0])
def test_innovations_are_the_marks_of_what_made_them_and_never_beyond_the_edge(stds):
    size = stds * NOISE[TENSIONS[0]]
    seen, evidence = watched(size)
    for innovations, mark in seen:
        np.testing.assert_allclose(innovations, size * mark, rtol=1e-6, atol=1e-6)
        assert np.abs(innovations).max() <= MAX_INNOVATION + 1e-9
    told = evidence['tension_cell']
    assert told.ratio == max(one.ratio for one in evidence.values())


def test_more_is_asked_for_of_an_onset_near_a_manoeuvre():
    size, begin = 15.0 * NOISE[TENSIONS[0]], 6
    evidence = {
        when: watched(size, begin=begin, manoeuvre=when)[1]['tension_cell']
        for when in (None, begin, begin + FEWEST, begin + FEWEST + 1)
    }
    still = evidence[None]
    freedom = len(still.candidate.columns)
    assert still.age == 12 - 1 - begin
    assert still.rarity == pytest.approx(rarity(still.ratio, freedom))
    for when, one in evidence.items():
        asked = rarity(one.ratio, freedom) - one.rarity
        near = when is not None and begin <= when <= begin + FEWEST
        assert asked == pytest.approx(MOVING if near else 0.0, abs=0.5), when


def test_of_onsets_that_were_discarded_there_is_no_evidence():
    bank = RatioBank(TABLE, 5)
    none = Chain(Belief(np.zeros(0), np.eye(0))).append(*np.zeros((2, 0, 0)), np.zeros(0))
    for _ in range(4):
        bank.step(none, np.zeros((5, 0, P)), 0.0)
    assert bank.best()
    bank.forget()
    assert bank.best() == []


@pytest.mark.parametrize('ratio', [-3.0, 0.0, 1e-6, 0.3, 5.0, 100.0, 1400.0])
def test_a_ratio_is_as_rare_as_chi_squared(ratio):
    for freedom in (1, 2, 3, 4, 7):
        expected = -chi2.logsf(ratio, freedom) / np.log(10.0)
        assert rarity(ratio, freedom) == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_what_is_rarer_than_the_smallest_number_still_has_its_rarity():
    # Of two degrees of freedom it is exponential; of more the same ratio is less rare.
    assert rarity(1e5, 2) == pytest.approx(5e4 / np.log(10.0), rel=1e-12)
    rarities = [rarity(1e5, freedom) for freedom in (1, 2, 3, 4, 7)]
    assert rarities == sorted(rarities, reverse=True)
    assert np.ptp(rarities) < 20.0


def test_what_is_near_is_within_the_95_percent_of_one_value():
    assert pytest.approx(chi2.ppf(0.95, 1)) == NEAR
