"""A name is held against changes of the gear file: other boards are not taken for other rigging."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.diagnosis import mimicry, procedure
from trawl_ros.diagnosis.candidates import Candidate
from trawl_ros.diagnosis.mimicry import Mimic, in_another_form, mimics_of
from trawl_ros.diagnosis.mimics.gear_file_change import changed, changes_of
from trawl_ros.diagnosis.mimics.table import mimic_table
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.report.result import result
from trawl_ros.diagnosis.report.sentences import headline, sentences
from trawl_ros.diagnosis.report.what_to_do import what_to_do
from trawl_ros.diagnosis.weighing import weigh
from trawl_ros.effects.registry import catalogue
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

LARGER = 0.11
"""Part by which the boards are larger than the gear file says."""

RIVALS = ('board_rigging', 'net_drag')
"""Effects that are looked for."""

KNOWN = {own.name: own for own in mimic_table()}
AREA = KNOWN['board_area'].model_copy(update={'usual': 0.1})
"""Boards as of a ship that has two pairs of them."""

TABLE = (AREA, KNOWN['warp_weight'], KNOWN['twine'])
"""Changes that are looked for."""

LIBRARY = 'trawl_ros.diagnosis.mimics.gear_file_change.mimic_table'


def larger(model, hours):
    return build_model(changed(model.gear, AREA, LARGER))


@pytest.fixture(scope='module')
def exchanged(coarse, hide):
    """Three tows with larger boards beside a baseline of one, each of three states."""
    before = hide.trial(coarse, hide.nothing, 3, tows=1)
    after = hide.trial(coarse, hide.Hidden(gear=larger), 4, tows=3, first=1)
    apart = [
        replace(window, index=len(before) + window.index, state=len(before) + window.state)
        for window in after
    ]
    windows = [window for window in (*before, *apart) if window.index % 5 < 3]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(procedure, 'catalogue', lambda: {name: catalogue()[name] for name in RIVALS})
        patch.setattr(LIBRARY, lambda: TABLE)
        return diagnose_windows(coarse, windows, hide.names[:4], frozenset({0}))


def test_larger_boards_make_a_name_doubtful_and_are_told_with_their_size(exchanged):
    assert exchanged.verdict == 'AMBIGUOUS', exchanged.reason
    found = {mimic.change.name: mimic for mimic in exchanged.mimics}
    value, low, high = found['board_area'].interval
    assert low < LARGER < high
    assert low < value < high
    assert re.search(f'larger boards.* {100.0 * value:.2g} %', headline(exchanged))
    assert 'board.area_m2' in what_to_do(exchanged)
    listed = result(exchanged, ())['mimics']
    assert [own['name'] for own in listed] == [own.change.name for own in exchanged.mimics]
    assert exchanged.repair is None


def test_without_a_name_it_is_told_as_what_would_explain_more(exchanged):
    unknown = replace(exchanged, verdict='UNKNOWN')
    (told,) = [line for line in sentences(unknown) if 'What would explain more' in line]
    assert 'larger boards' in told


def test_a_change_that_is_the_same_thing_is_no_mimic(coarse, exchanged, monkeypatch):
    predictor = Predictor(build_model(coarse), without=exchanged.baseline)
    names = exchanged.best.refit.names
    same = tuple(own.model_copy(update={'same_as': names}) for own in TABLE)
    monkeypatch.setattr(LIBRARY, lambda: same)
    assert mimics_of(predictor, exchanged.base, exchanged.score_test, exchanged.best) == ()


def test_an_uncommon_size_makes_no_name_doubtful(coarse, exchanged, monkeypatch):
    seldom = tuple(own.model_copy(update={'usual': 0.02}) for own in TABLE)
    monkeypatch.setattr(LIBRARY, lambda: seldom)
    predictor = Predictor(build_model(coarse), without=exchanged.baseline)
    assert mimics_of(predictor, exchanged.base, exchanged.score_test, exchanged.best) == ()


def test_a_change_at_its_bound_makes_a_name_doubtful_and_is_no_better_explanation(
    coarse, exchanged, monkeypatch
):
    predictor = Predictor(build_model(coarse), without=exchanged.baseline)
    (found,) = (own for own in exchanged.mimics if own.change.name == 'board_area')
    near = AREA.model_copy(update={'high': 0.97 * found.interval[0]})
    monkeypatch.setattr(LIBRARY, lambda: (near,))
    given = predictor, exchanged.base, exchanged.score_test, exchanged.best
    (beside,) = mimics_of(*given)
    assert beside.refit.at_bound()
    assert mimics_of(*given, better=True) == ()


def test_a_change_that_is_the_same_as_a_rival_is_told_by_the_rival_alone(
    coarse, exchanged, monkeypatch
):
    predictor = Predictor(build_model(coarse), without=exchanged.baseline)
    same = tuple(own.model_copy(update={'same_as': ('kite',)}) for own in TABLE)
    monkeypatch.setattr(LIBRARY, lambda: same)
    given = predictor, exchanged.base, exchanged.score_test, exchanged.best
    assert len(mimics_of(*given)) == 1
    assert mimics_of(*given, others=('kite',)) == ()


def test_what_is_the_same_as_one_of_several_may_do_alone_what_all_of_them_do(exchanged):
    best = exchanged.best
    two = SimpleNamespace(refit=SimpleNamespace(names=('net_drag', 'board_rigging')))
    assert mimicry._in_other_words(best, ('kite',)) == (*best.refit.names, 'kite')
    assert mimicry._in_other_words(two, ('kite',)) == ('kite',)


@pytest.mark.parametrize(('explained', 'solved'), [(303.0, 2), (843.0, 4)])
def test_more_changes_are_solved_where_first_order_misses_what_the_effect_explains(
    coarse, explained, solved, monkeypatch
):
    first = 302.0
    changes = changes_of(coarse)[:5]
    wanted = [Candidate(change, np.array(change.neutral)) for change in changes]
    names = [change.name for change in changes]
    explains = dict(zip(names, (300.0, 280.0, 234.0, 165.0, 140.0), strict=True))
    terms = SimpleNamespace(
        wanted=wanted,
        penalised=lambda candidate: explains[candidate.name],
        block=lambda candidate: [0],
        evidence=SimpleNamespace(values=lambda block: np.zeros(1)),
    )
    monkeypatch.setattr(mimicry, 'sparing', lambda test, refit, explained: explained)
    monkeypatch.setattr(mimicry, 'block_of', lambda test, refit: [0])
    test = SimpleNamespace(evidence=SimpleNamespace(chi2=lambda block: first))
    best = SimpleNamespace(refit=None, delta_chi2=explained)
    found = mimicry._likeliest(test, terms, best, better=False)
    assert list(found) == wanted[:solved]


def test_tows_gain_by_the_refit_where_first_order_knows_nothing_of_the_effect(exchanged):
    test, best = exchanged.score_test, exchanged.best
    blind = replace(test, evidence=replace(test.evidence, score=0.0 * test.evidence.score))
    (entry,) = weigh(exchanged.base, blind, [best.refit])
    assert entry.gain[1] > 0.0
    assert np.sum(entry.gains) == pytest.approx(best.delta_chi2, rel=0.3)


def mimic(over, keys=('netting.body[].twine_diameter_m',), same_as=('net_drag',)):
    change = SimpleNamespace(keys=keys, same_as=same_as)
    return Mimic(change, SimpleNamespace(), 100.0 + over, 94.0 + over, over)


def entry(*names):
    return SimpleNamespace(refit=SimpleNamespace(names=names, wanted=names))


def test_what_explains_far_more_and_is_of_an_effects_kind_is_its_other_form():
    weighed = [entry('board_rigging'), entry('net_drag', 'heave'), drag := entry('net_drag')]
    twine, larger = mimic(25.0), mimic(10.0, ('board.area_m2',), ('board_damage',))
    assert in_another_form(weighed, (larger, twine)) == (drag, twine)
    assert in_another_form(weighed, (twine, mimic(20.0, ('board.area_m2',)))) is None
    assert in_another_form(weighed, (mimic(9.0),)) is None
    assert in_another_form(weighed, (mimic(25.0, same_as=()),)) is None
    assert in_another_form(weighed, (mimic(25.0, keys=()),)) is None
    assert in_another_form(weighed[:2], (twine,)) is None
    assert in_another_form(weighed, ()) is None
