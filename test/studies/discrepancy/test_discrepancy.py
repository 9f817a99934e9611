"""Scores of blind trials: names right and wrong, temperature, calibration and the certified cut."""

import pytest

from studies.discrepancy.calibration import (
    Claim,
    best_temperature,
    calibration_error,
    certified_cut,
    claim,
    of_truth,
    wrong_at,
)
from studies.discrepancy.plan import ALONE, BlindStudyPlan
from studies.discrepancy.rows import all_sections, is_right, is_wrong
from studies.discrepancy.trial import BlindTrial

CHAIN = ('footrope_weight',), ('mouth/weight',)
NET = ('net_drag',), ('net/netting',)
NOTHING = (), ()


def trial(number, *parts, series='alone', effects=('footrope_chain',), named=()):
    """Trial with explanations of some log posterior odds."""
    explanations = tuple((*what, False, 0.0, factor) for what, factor in parts)
    return BlindTrial(
        series, number, list(effects), 3.0, [-0.3], '', 'NAMED' if named else 'AMBIGUOUS',
        tuple(named), ('footrope_weight',), 0.0, 0.0, {'footrope_weight': 0.9}, {}, explanations,
    )  # fmt: skip


def test_a_leaf_or_its_node_is_right_and_another_wrong():
    right = trial(0, (CHAIN, 5.0), named=['mouth/weight'])
    wrong = trial(0, (CHAIN, 5.0), named=['mouth/lift'])
    both = trial(0, (CHAIN, 5.0), named=['mouth/weight', 'mouth/lift'])
    assert [is_right(own) for own in (right, wrong, both)] == [True, False, False]
    assert [is_wrong(own) for own in (right, wrong, both)] == [False, True, True]


def test_the_probability_of_the_truth_falls_with_the_temperature():
    own = trial(0, (CHAIN, 4.0), (NET, 0.0))
    assert of_truth(own, 1.0) == pytest.approx(1.0 / (1.0 + 2.718281828**-4))
    assert of_truth(own, 4.0) < of_truth(own, 1.0)
    clean = trial(1, (NOTHING, 2.0), (NET, 0.0), series='clean', effects=())
    assert of_truth(clean, 1.0) == pytest.approx(0.8808, abs=1e-4)
    assert claim(clean, 1.0).right


def test_overconfident_odds_want_a_higher_temperature():
    half = [
        trial(number, (CHAIN if number % 2 else NET, 6.0), (NET if number % 2 else CHAIN, 0.0))
        for number in range(20)
    ]
    sure = [trial(number, (CHAIN, 6.0), (NET, 0.0)) for number in range(20)]
    assert best_temperature(half) > best_temperature(sure)


def test_claims_that_come_true_as_often_as_said_have_no_error():
    fair = [Claim(0.8, number % 5 != 0) for number in range(100)]
    assert calibration_error(fair) < 0.05
    assert calibration_error([Claim(0.99, number % 2 == 0) for number in range(100)]) > 0.4


def test_a_cut_is_certified_by_a_hundred_trials_without_a_wrong_name_and_not_by_fifty():
    good = [trial(number, (CHAIN, 9.0), (NET, 0.0)) for number in range(100)]
    assert certified_cut(good, 1.0) == 0.8
    assert certified_cut(good[:50], 1.0) is None
    bad = [trial(number, (NET, 9.0), (CHAIN, 0.0)) for number in range(100)]
    assert wrong_at(bad[0], 1.0, 0.95)
    assert certified_cut(bad, 1.0) is None


def test_all_rows_are_made_of_few_trials():
    sections = all_sections([trial(0, (CHAIN, 5.0), named=['mouth/weight'])])
    assert sum(len(section.rows) for section in sections) > 15


def test_trials_are_drawn_from_all_causes_and_the_same_again():
    plan = BlindStudyPlan(seed=7, trials=400)
    specs = [plan.spec(number) for number in range(400)]
    assert specs[3] == plan.spec(3)
    assert {name for spec in specs if spec.series == 'alone' for name in spec.effects} == set(ALONE)
    assert 50 < sum(spec.series == 'clean' for spec in specs) < 110
