"""Decisions on a posterior: what is named, withheld, or left unknown."""

from types import SimpleNamespace

import pytest

from trawl_ros.diagnosis.inference.decision import decide
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.posterior import Explanation, Posterior

OPTIONS = InferenceOptions(cut=0.95)
AT = {'epsilon': 'boards/rigging', 'hole': 'boards/rigging', 'cell': 'instruments/cell',
      'floats': 'mouth/lift'}  # fmt: skip


def suspect(name):
    node = SimpleNamespace(path=AT[name])
    return SimpleNamespace(entry=SimpleNamespace(name=name, node=node, path=f'{AT[name]}/{name}'))


def posterior(*parts):
    """Of (names, probability); a question mark is something else."""
    found = [
        Explanation(
            tuple(suspect(name) for name in names if name != '?'), 0.0, 0.0,
            refit=SimpleNamespace() if names and '?' not in names else None,
            unknown=SimpleNamespace() if '?' in names else None, probability=probability,
        )
        for names, probability in parts
    ]  # fmt: skip
    return Posterior(tuple(sorted(found, key=lambda own: -own.probability)))


@pytest.mark.parametrize(
    ('parts', 'verdict', 'named'),
    [
        ([((), 0.6), (('cell',), 0.4)], 'NO_DISCREPANCY', []),
        ([((), 0.01), (('cell',), 0.97), (('epsilon',), 0.02)], 'NAMED',
         ['instruments/cell/cell']),
        ([(('epsilon',), 0.6), (('hole',), 0.38), (('cell',), 0.02)], 'NAMED',
         ['boards/rigging']),
        ([(('epsilon',), 0.6), (('cell',), 0.4)], 'AMBIGUOUS', []),
        ([(('epsilon', 'cell'), 0.97), (('cell',), 0.03)], 'NAMED',
         ['instruments/cell/cell', 'boards/rigging/epsilon']),
        ([(('?',), 0.7), (('cell',), 0.3)], 'UNKNOWN', []),
        ([(('cell', '?'), 0.97), (('cell',), 0.03)], 'UNKNOWN', []),
    ],
)  # fmt: skip
def test_the_lowest_node_that_holds_the_cut_is_named(parts, verdict, named):
    found = decide(posterior(*parts), OPTIONS)
    assert found.verdict == verdict, found.reason
    assert [own.path for own in found.named] == named


def test_the_smallest_set_that_holds_the_cut_is_not_excluded():
    found = decide(posterior((('epsilon',), 0.5), (('cell',), 0.47), (('floats',), 0.03)), OPTIONS)
    assert found.among == ('epsilon', 'cell')
    assert found.best.names == ('epsilon',)


def test_a_repair_that_makes_held_out_readings_worse_is_no_name():
    found = decide(posterior((('cell',), 1.0)), OPTIONS, ['tension'])
    assert found.verdict == 'UNKNOWN'
    assert found.named == ()
    assert 'tension' in found.reason


def test_probabilities_add_up_the_tree():
    found = posterior((('epsilon',), 0.5), (('hole', 'cell'), 0.3), (('cell',), 0.2))
    assert found.leaves == pytest.approx({'epsilon': 0.5, 'cell': 0.5, 'hole': 0.3})
    assert found.nodes['boards/rigging'] == found.nodes['boards'] == pytest.approx(0.8)
    assert found.nodes['instruments'] == pytest.approx(0.5)
