"""Sets of effects that are there at once."""

from types import SimpleNamespace

import numpy as np

from trawl_ros.diagnosis import several
from trawl_ros.diagnosis.evidence import Evidence
from trawl_ros.diagnosis.rules import LEAST_BIC
from trawl_ros.diagnosis.several import PAIR, THREE, SetsTried, likeliest_sets
from trawl_ros.effects.registry import catalogue

TRUE = ('heave', 'counter_scale', 'net_drag')
LOOKS_LIKE_TWO = 'floats'
"""Looks like the first two and something that is not there, in equal parts."""


def score_test_of(strengths):
    """Score test of four effects with one value each, the true ones at right angles."""
    signatures = np.eye(4)[:, :3]
    like_two = np.array([1.0, 1.0, 0.0, 1.0]) / np.sqrt(3.0)
    root = np.column_stack((signatures, like_two))
    seen = signatures @ np.array(strengths)
    names = (*TRUE, LOOKS_LIKE_TWO)
    wanted = tuple(SimpleNamespace(name=name, effect=catalogue()[name]) for name in names)
    return SimpleNamespace(
        wanted=wanted,
        evidence=Evidence(root.T @ root, root.T @ seen, root),
        readings=400,
        block=lambda candidate: range(names.index(candidate.name), names.index(candidate.name) + 1),
    )


def names_of(sets):
    return [{candidate.name for candidate in own} for own in sets]


def test_the_best_three_need_not_have_the_best_of_one_or_two_among_them():
    test = score_test_of((10.0, 10.0, 10.0))
    assert names_of(likeliest_sets(test, 1))[0] == {LOOKS_LIKE_TWO}
    assert names_of(likeliest_sets(test, 2))[0] == {LOOKS_LIKE_TWO, 'net_drag'}
    assert names_of(likeliest_sets(test, 3))[0] == set(TRUE)


def test_every_set_is_there_once_and_has_an_effect_once():
    sets = names_of(likeliest_sets(score_test_of((10.0, 3.0, 1.0)), 3))
    assert all(len(own) == 3 for own in sets)
    assert len({frozenset(own) for own in sets}) == len(sets) == 4


def test_a_set_with_a_part_of_a_swap_is_none_and_a_swap_alone_stays(monkeypatch):
    def refitted(predictor, base, test, wanted):
        names = tuple(candidate.name for candidate in wanted)
        return SimpleNamespace(names=names, in_part=lambda: 'swapped_cells' in names)

    monkeypatch.setattr(several, 'refitted', refitted)
    tried = SetsTried(None, None, None, [], on_progress=lambda _: None)
    cells, doors, log = (
        SimpleNamespace(name=name, effect=catalogue()[name])
        for name in ('swapped_cells', 'swapped_doors', 'speed_log')
    )
    for wanted in ((cells,), (cells, doors), (cells, log), (doors, log)):
        tried.add(wanted)
    assert [own.names for own in tried.refits] == [
        ('swapped_cells',), ('swapped_doors', 'speed_log'),
    ]  # fmt: skip


class Tried(SetsTried):
    """Sets with the criterion that each refit comes to."""

    def weighed(self):
        entries = [SimpleNamespace(refit=own, delta_bic=own.criterion) for own in self.refits]
        return tuple(sorted(entries, key=lambda own: -own.delta_bic))


def refit_of(criterion, *wanted):
    return SimpleNamespace(
        names=tuple(candidate.name for candidate in wanted),
        wanted=wanted,
        criterion=criterion,
        fit=SimpleNamespace(negative_log_likelihood=-criterion),
        in_part=lambda: False,
    )


def tried_with(monkeypatch, from_the_pair, doors_by_themselves=None):
    """A pair beside an askew sensor, or swapped doors too, and what each comes to from its rest."""
    doors, mount = (
        SimpleNamespace(name=name, effect=catalogue()[name])
        for name in ('swapped_doors', 'attitude_mount')
    )

    def refitted_without(predictor, base, larger, left_out):
        (rest,) = (own for own in larger.wanted if own is not left_out)
        return refit_of(from_the_pair[rest.name], rest)

    monkeypatch.setattr(several, 'refitted_without', refitted_without)
    monkeypatch.setattr(several, '_more', lambda test, smaller, larger: LEAST_BIC)
    refits = [refit_of(1665.0, mount), refit_of(2065.0, doors, mount)]
    if doors_by_themselves is not None:
        refits.append(refit_of(doors_by_themselves, doors))
    return Tried(None, None, None, refits, on_progress=lambda _: None)


def test_a_pair_is_none_where_one_of_it_alone_that_was_not_tried_explains_as_much(monkeypatch):
    tried = tried_with(monkeypatch, {'swapped_doors': 2085.0, 'attitude_mount': 1500.0})
    assert not several._explains_more(tried, PAIR)
    assert tried.weighed()[0].refit.names == ('swapped_doors',)


def test_a_pair_is_none_where_one_of_it_alone_had_come_to_rest_in_another_valley(monkeypatch):
    found = {'swapped_doors': 2085.0, 'attitude_mount': 1500.0}
    tried = tried_with(monkeypatch, found, doors_by_themselves=212.0)
    assert not several._explains_more(tried, PAIR)
    assert [own.delta_bic for own in tried.weighed()] == [2085.0, 2065.0, 1665.0]


def test_a_pair_stays_where_neither_of_it_explains_as_much(monkeypatch):
    tried = tried_with(monkeypatch, {'swapped_doors': 1900.0, 'attitude_mount': 1500.0})
    assert several._explains_more(tried, PAIR)
    # Of two refits of the same effect the likelier is kept.
    assert [own.delta_bic for own in tried.weighed()] == [2065.0, 1900.0, 1665.0]


def test_three_are_none_where_one_alone_explains_as_much_though_no_pair_does(monkeypatch):
    log, cell, mount = (
        SimpleNamespace(name=name, effect=catalogue()[name])
        for name in ('speed_log', 'tension_cell', 'attitude_mount')
    )
    monkeypatch.setattr(several, 'refitted_without', lambda *_: None)
    monkeypatch.setattr(several, '_more', lambda test, smaller, larger: LEAST_BIC)
    refits = [
        refit_of(2100.0, log), refit_of(1800.0, cell, mount), refit_of(2105.0, log, cell, mount),
    ]  # fmt: skip
    tried = Tried(None, None, None, refits, on_progress=lambda _: None)
    assert not several._explains_more(tried, THREE)
    tried.refits[0] = refit_of(1700.0, log)
    assert several._explains_more(tried, THREE)
