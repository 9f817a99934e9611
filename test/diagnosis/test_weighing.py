"""Effects that are held against each other: what looks alike is no name for its fewer values."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.diagnosis.candidates import Candidate
from trawl_ros.diagnosis.evidence import Evidence
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.weighing import Weighed, possible_first, rivals_of_best, sparing
from trawl_ros.effects.registry import catalogue

READINGS = 400
PENALTY = np.log(READINGS)

BLOCKS = {'floats': (0,), 'gear_weight': (1, 2), 'kite': (3,)}
"""One value looks like the second of two, another like none of these."""


@pytest.fixture(scope='module')
def trial():
    """Score test of three effects, of which two are alike."""
    alike = np.sqrt(1.0 - 0.99**2)
    root = np.array([[1.0, 0.0, 0.99, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, alike, 0.0],
                     [0.0, 0.0, 0.0, 1.0]])  # fmt: skip
    seen = np.array([12.0, 0.5, 0.0, 0.0])
    wanted = tuple(SimpleNamespace(name=name) for name in BLOCKS)
    return SimpleNamespace(
        wanted=wanted,
        evidence=Evidence(root.T @ root, root.T @ seen, root),
        readings=READINGS,
        block=lambda candidate: range(BLOCKS[candidate.name][0], BLOCKS[candidate.name][-1] + 1),
    )


def weighed(trial, name, explained):
    """One of the effects, refitted, by the χ² that it explains."""
    (candidate,) = (own for own in trial.wanted if own.name == name)
    number = len(BLOCKS[name])
    values = trial.evidence.values(BLOCKS[name])
    own = SimpleNamespace(name=name, start=np.zeros(number), scale=np.ones(number))
    trial.wanted = tuple(own if one is candidate else one for one in trial.wanted)
    refit = SimpleNamespace(
        wanted=(own,),
        names=(name,),
        estimate=SimpleNamespace(values=values),
        fit=SimpleNamespace(prior=SimpleNamespace(blocks=lambda _: (range(number),))),
        at_bound=lambda: False,
        in_part=lambda: False,
    )
    criterion = explained - number * PENALTY
    return Weighed(refit, explained, criterion, criterion, np.ones(3), 1.0, (), 0.0)


def test_only_values_that_earn_their_place_are_counted(trial):
    both = weighed(trial, 'gear_weight', 141.0)
    alone = 141.0 - (trial.evidence.chi2([1, 2]) - trial.evidence.chi2([2])) - PENALTY
    assert sparing(trial, both.refit, 141.0) == pytest.approx(alone)
    assert alone > both.delta_bic


def test_what_looks_alike_is_no_name_for_its_fewer_values(trial):
    best, other = weighed(trial, 'floats', 144.0), weighed(trial, 'gear_weight', 141.0)
    assert best.delta_bic - other.delta_bic > 6.0
    assert rivals_of_best(trial, (best, other)) == ('gear_weight',)
    assert rivals_of_best(trial, (best, weighed(trial, 'gear_weight', 130.0))) == ()


def test_what_does_not_look_alike_is_a_rival_by_all_its_values(trial):
    best, other = weighed(trial, 'floats', 144.0), weighed(trial, 'kite', 140.0)
    assert rivals_of_best(trial, (best, other)) == ('kite',)
    far = replace(other, delta_bic=best.delta_bic - 6.5)
    assert rivals_of_best(trial, (best, far)) == ()


def test_a_part_of_what_is_there_as_a_whole_stands_behind_all_and_is_no_rival(trial):
    best, other = weighed(trial, 'floats', 144.0), weighed(trial, 'kite', 120.0)
    best.refit.in_part = lambda: True
    assert possible_first((best, other)) == (other, best)
    assert rivals_of_best(trial, (other, best)) == ()


@pytest.mark.parametrize(
    ('share', 'std', 'is_part'),
    [(-0.22, 0.05, True), (0.3, 0.1, True), (0.4, 0.3, False), (0.8, 0.02, False)],
)
def test_a_share_is_a_part_where_the_whole_is_surely_out_of_reach(share, std, is_part):
    swapped = Candidate(catalogue()['swapped_doors'], catalogue()['swapped_doors'].neutral)
    fit = SimpleNamespace(prior=SimpleNamespace(slice_of=lambda _: slice(12, 13)))
    estimate = SimpleNamespace(values=np.full(13, share), std=np.full(13, std))
    assert Refit((swapped,), SimpleNamespace(fit=fit), estimate).in_part() is is_part
