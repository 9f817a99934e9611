"""Temperature of the log Bayes factors: the probability of the truth falls with it."""

import pytest

from studies.discrepancy.temperature import best_temperature, of_truth
from studies.discrepancy.trial import BlindTrial

CHAIN, NET, NOTHING = ('mouth/weight',), ('net/netting',), ()


def trial(number, *parts, hidden='mouth/weight'):
    """Trial with explanations of some log Bayes factors."""
    cause = {
        'name': 'hidden',
        'size': 0.1,
        'unit': '',
        'leaves': [],
        'nodes': [hidden],
        'sizes': {},
    }
    truth = {'series': 'alone', 'strength': 3.0, 'causes': [cause]}
    if not hidden:
        truth = {'series': 'clean', 'strength': 0.0}
    explanations = tuple((nodes, False, 0.0, factor) for nodes, factor in parts)
    return BlindTrial(
        truth['series'], number, '', truth=truth, answer={'verdict': 'UNKNOWN'},
        explanations=explanations,
    )  # fmt: skip


def test_the_probability_of_the_truth_falls_with_the_temperature():
    own = trial(0, (CHAIN, 4.0), (NET, 0.0))
    assert of_truth(own, 1.0) == pytest.approx(1.0 / (1.0 + 2.718281828**-4))
    assert of_truth(own, 4.0) < of_truth(own, 1.0)
    clean = trial(1, (NOTHING, 2.0), (NET, 0.0), hidden='')
    assert of_truth(clean, 1.0) == pytest.approx(0.8808, abs=1e-4)


def test_overconfident_odds_want_a_higher_temperature():
    half = [
        trial(number, (CHAIN if number % 2 else NET, 6.0), (NET if number % 2 else CHAIN, 0.0))
        for number in range(20)
    ]
    sure = [trial(number, (CHAIN, 6.0), (NET, 0.0)) for number in range(20)]
    assert best_temperature(half) > best_temperature(sure)
