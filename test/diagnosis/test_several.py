"""Sets of effects that are there at once."""

from types import SimpleNamespace

import numpy as np

from trawl_ros.diagnosis import several
from trawl_ros.diagnosis.evidence import Evidence
from trawl_ros.diagnosis.several import SetsTried, likeliest_sets
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
