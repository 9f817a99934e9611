"""The evidence is that of least squares, and chance exceeds its threshold as often as it says."""

import numpy as np
import pytest

from trawl_ros.diagnosis.evidence import Evidence, detectable, tail, threshold
from trawl_ros.diagnosis.score_test import looks_at


@pytest.fixture(scope='module')
def case():
    """Whitened data of three effects beside two nuisances."""
    rng = np.random.default_rng(0)
    nuisance, effects = rng.normal(size=(60, 2)), rng.normal(size=(60, 5))
    basis, _ = np.linalg.qr(nuisance)
    seen = effects - basis @ (basis.T @ effects)
    return seen, rng


def gathered(seen, data):
    root = np.linalg.qr(seen)[1]
    return Evidence(seen.T @ seen, seen.T @ data, root)


BLOCKS = ([0], [1, 2], [3, 4])


def test_it_is_what_least_squares_gains(case):
    seen, rng = case
    data = seen @ [0.0, 1.0, -0.5, 0.0, 0.0] + rng.normal(size=60)
    found = gathered(seen, data)
    for block in BLOCKS:
        values, *_ = np.linalg.lstsq(seen[:, block], data, rcond=None)
        left = data - seen[:, block] @ values
        assert found.chi2(block) == pytest.approx(data @ data - left @ left)
        np.testing.assert_allclose(found.values(block), values)
    best = max(BLOCKS, key=found.strength)
    assert best == [1, 2]


def test_with_some_values_free_the_others_explain_the_rest(case):
    seen, rng = case
    data = rng.normal(size=60)
    found = gathered(seen, data)
    both = found.chi2([0, 1, 2])
    assert found.without([0]).chi2([1, 2]) == pytest.approx(both - found.chi2([0]))
    assert found.without([0]).chi2([0]) == pytest.approx(0.0, abs=1e-9)


def test_another_draw_of_the_noise_is_read_with_the_same_information(case):
    seen, rng = case
    found = gathered(seen, rng.normal(size=60))
    assert found.degrees_of_freedom([1, 2]) == len([1, 2])
    assert found.chi2([1, 2]) > 0.0
    drawn = found.with_noise(np.random.default_rng(3))
    alone = Evidence(drawn.information, drawn.score, drawn.root)
    for block in BLOCKS:
        assert drawn.chi2(block) == alone.chi2(block) != found.chi2(block)
        assert drawn.degrees_of_freedom(block) == alone.degrees_of_freedom(block)


def test_a_threshold_is_exceeded_as_often_as_it_says(case):
    seen, rng = case
    limit = threshold(gathered(seen, np.zeros(60)), BLOCKS, 0.05, seed=1)
    exceeded = 0
    for _ in range(2000):
        found = gathered(seen, rng.normal(size=60))
        exceeded += max(found.strength(block) for block in BLOCKS) > limit
    assert 0.035 < exceeded / 2000 < 0.068


def test_a_block_is_looked_at_as_a_whole_and_value_by_value():
    assert looks_at(range(3, 4)) == [range(3, 4)]
    assert looks_at(range(3, 5)) == [range(3, 5), range(3, 4), range(4, 5)]


def test_what_is_detectable_is_detected_four_times_of_five(case):
    seen, rng = case
    quiet = gathered(seen, np.zeros(60))
    limit = threshold(quiet, BLOCKS, 0.01)
    (size,) = detectable(quiet, [0], limit)
    found = [
        gathered(seen, size * seen[:, 0] + rng.normal(size=60)).strength([0]) > limit
        for _ in range(1000)
    ]
    assert np.mean(found) == pytest.approx(0.8, abs=0.05)


def test_twins_cover_each_other_and_strangers_do_not():
    rng = np.random.default_rng(3)
    one = rng.normal(size=50)
    other = rng.normal(size=50)
    other -= one * (one @ other) / (one @ one)
    seen = np.column_stack((one, -3.0 * one, other))
    found = gathered(seen, np.zeros(50))
    assert found.covered([0], np.ones(1), [1]) == pytest.approx(1.0)
    assert found.covered([0], np.ones(1), [2]) == pytest.approx(0.0, abs=1e-6)
    assert found.covered([2], np.ones(1), [0, 1]) == pytest.approx(0.0, abs=1e-6)


def test_what_is_not_seen_has_no_evidence():
    seen = np.column_stack((np.ones(10), np.zeros(10)))
    found = gathered(seen, np.ones(10))
    assert found.degrees_of_freedom([1]) == 0
    assert found.strength([1]) == 0.0
    assert found.std([1])[0] == np.inf
    assert found.degrees_of_freedom([0, 1]) == 1


def test_the_tail_is_a_probability():
    assert tail(3.841, 1) == pytest.approx(-np.log10(0.05), abs=1e-3)
