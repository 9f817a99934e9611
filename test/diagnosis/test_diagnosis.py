"""What is hidden in a trial is found, named, added to the gear, and the gap shrinks."""

import json
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.diagnosis import fit_beside, naming, procedure, several
from trawl_ros.diagnosis import refit as refits
from trawl_ros.diagnosis.changes import changes
from trawl_ros.diagnosis.diagnosis import unread, values_of
from trawl_ros.diagnosis.next_tow import propose
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.refit import refit, was_in_order
from trawl_ros.diagnosis.repair import repaired, source
from trawl_ros.diagnosis.report.result import result
from trawl_ros.diagnosis.report.sentences import headline, sentences
from trawl_ros.diagnosis.report.writing import write_diagnosis
from trawl_ros.estimation.fit.estimator import POOR
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor


@pytest.fixture(scope='module')
def clean(coarse, hide):
    return diagnose_windows(coarse, hide.trial(coarse, hide.nothing, 1), hide.names[:3])


@pytest.fixture(scope='module')
def with_catch(coarse, hide):
    return hide.trial(coarse, hide.catch, 2)


@pytest.fixture(scope='module')
def caught(coarse, hide, with_catch):
    return diagnose_windows(coarse, with_catch, hide.names[:3])


def test_nothing_is_found_where_nothing_is(clean):
    assert clean.verdict == 'NO_DISCREPANCY', clean.reason
    assert clean.score_test.strongest < clean.score_test.limit
    assert clean.holdout.after is None
    assert repaired(clean, []) is None
    assert headline(clean).startswith('No discrepancy')


def test_floats_are_not_told_of_a_gear_that_has_none(clean):
    test = clean.score_test
    (floats,) = [one for one in test.wanted if one.name == 'floats']
    assert clean.gear.floats.buoyancy_n == 0.0
    assert test.strength(floats) == 0.0
    assert np.isposinf(test.detectable(floats)).all()
    told = result(clean, [])
    json.dumps(told, allow_nan=False)
    assert told['smallest_detectable']['floats']['lost']['size'] is None


def test_a_catch_that_comes_in_steps_is_named(caught):
    assert caught.verdict == 'NAMED', caught.reason
    assert caught.best.refit.names == ('catch_build_up',)
    value, low, high, unit = values_of(caught.best.refit)['catch_build_up']['drag_area']
    # Six square metres in two hours.
    assert low < 3.0 < high
    assert low < value < high
    assert unit == 'm² per h'
    assert {where.variable for where in caught.where} & {'time in tow', 'warp length'}


def test_a_sensor_that_jumps_is_seen_to_do_so(coarse, clean):
    late = [
        part.window
        for part in clean.score_test.fit.windows
        if (part.window.tow, part.window.hours) >= (2, 1.0)
    ]
    assert late
    assert changes(clean.score_test) == ()
    parts = tuple(
        replace(part, measured=part.measured + 6.0 * (np.array(part.channels) == 'net_depth'))
        if part.window in late
        else part
        for part in clean.score_test.fit.windows
    )
    found, *_ = changes(replace(clean.score_test, fit=replace(clean.score_test.fit, windows=parts)))
    assert (found.channel, found.variable) == ('net_depth', 'time')
    assert re.findall(r'up|\d\S*', found.region) == ['up', '3', '1.0']
    assert found.z > 5.0


def test_the_gap_shrinks_on_a_tow_that_decided_nothing(caught):
    assert caught.split.by == 'tow'
    deciding = {window.tow for window in caught.split.deciding}
    assert not deciding & {window.tow for window in caught.split.kept_back}
    # One tow of five windows, whose depths are off as one tow's may be: a study asks for more.
    assert caught.holdout.removed > 0.2
    assert caught.holdout.removed_by_placebo < caught.holdout.removed
    before, after = caught.holdout.before, caught.holdout.after
    assert after.rms['door_spread'] < before.rms['door_spread']


@pytest.mark.usefixtures('rough_pictures')
def test_the_repaired_gear_leaves_no_discrepancy(caught, with_catch, hide, tmp_path):
    write_diagnosis(caught, [], tmp_path)
    gear = load_gear(tmp_path / 'model.yaml')
    (effect,) = gear.effects
    assert effect.name == 'catch_build_up'
    assert effect.provenance.evidence['delta_bic'] > 10.0
    again = diagnose_windows(gear, with_catch, hide.names[:3])
    assert again.verdict == 'NO_DISCREPANCY', again.reason


def test_all_is_written(caught, tmp_path):
    bag = tmp_path / 'bag'
    bag.mkdir()
    (bag / 'bag_0.mcap').write_bytes(b'not much')
    named = caught.gear.model_copy(update={'name': '<script>|*'})
    write_diagnosis(
        replace(caught, checks=('Tow on.',), gear=named), [source(bag)], tmp_path / 'out'
    )
    found = json.loads((tmp_path / 'out' / 'diagnosis.json').read_text())
    assert {
        'verdict', 'reason', 'effects', 'ambiguous_with', 'where', 'evidence', 'channels',
        'excess_removed', 'coefficients', 'smallest_detectable', 'next_tow', 'bags', 'version',
    } <= set(found)  # fmt: skip
    (effect,) = found['effects']
    assert effect['class'][0] == effect['name'] == 'catch_build_up'
    assert set(effect['parameters']['drag_area']) == {'value', 'low', 'high', 'unit'}
    assert set(found['channels']['door_spread']) >= {'unit', 'before', 'after', 'placebo'}
    assert found['bags'][0]['bag'] == 'bag'
    assert len(found['bags'][0]['sha256']) == 64
    page = (tmp_path / 'out' / 'report.html').read_text()
    assert 'NAMED' in page
    assert 'Tow on.' in page
    assert 'src="http' not in page
    assert page.count('data:image/png') == 5
    assert '<script' not in page
    heading = '# Diagnosis of the gear \\<script\\>\\|\\*'
    assert (tmp_path / 'out' / 'report.md').read_text().startswith(heading)


@pytest.fixture(scope='module')
def with_cells(coarse, hide):
    """Tows before and after the cells began to show too much."""
    before = hide.trial(coarse, hide.nothing, 3, tows=3)
    after = hide.trial(coarse, hide.cells, 4, tows=3, first=3)
    after = [
        replace(window, index=window.index + 100, state=window.state + 100) for window in after
    ]
    return [*before, *after]


BEFORE = frozenset({0, 1, 2})


@pytest.fixture(scope='module')
def beside_baseline(coarse, with_cells, hide):
    return diagnose_windows(coarse, with_cells, hide.names[:6], BEFORE)


def test_a_baseline_keeps_the_boards_out_of_it(beside_baseline):
    found = beside_baseline
    assert found.verdict == 'NAMED', found.reason
    values = values_of(found.best.refit)['tension_cell']
    _, low, high, _ = values['scale']
    assert low < 0.15 < high or np.isclose(values['scale'][0], 0.15, atol=0.03)


@pytest.mark.parametrize('poor', [POOR, pytest.param(0.0, marks=pytest.mark.slow)])
def test_what_was_found_is_not_in_the_baseline(
    beside_baseline, with_cells, hide, poor, monkeypatch
):
    # However good the first fit is, with 0 the boards are fitted without the effect, which then
    # comes in.
    monkeypatch.setattr(fit_beside, 'POOR', poor)
    gear = repaired(beside_baseline, [])
    again = diagnose_windows(gear, with_cells, hide.names[:6], BEFORE)
    assert again.verdict == 'NO_DISCREPANCY', again.reason


def test_what_does_not_vary_tells_nothing(coarse, hide):
    windows = hide.trial(coarse, hide.nothing, 5, tows=1)[:2]
    found = diagnose_windows(coarse, windows, hide.names[:1])
    assert found.verdict == 'NOT_TESTABLE'
    assert 'found 2 steady states' in headline(found)
    json.dumps(result(found, []), allow_nan=False)


def test_recordings_without_a_window_tell_nothing(coarse, tmp_path):
    found = unread(coarse, ['bag'], 'bag: no readings')
    assert headline(found).endswith('bag: no readings.')
    assert sentences(found) == ()
    write_diagnosis(found, [], tmp_path)
    assert not (tmp_path / 'model.yaml').exists()


@pytest.mark.slow
def test_another_gear_is_not_diagnosed(coarse, hide):
    def other(values):
        return {name: value * (1.6 if 'depth' in name else 0.5) for name, value in values.items()}

    windows = hide.trial(coarse, hide.Hidden(shown=other), 6, tows=1)
    found = diagnose_windows(coarse, windows, hide.names[:1])
    assert found.verdict == 'NOT_TESTABLE', found.reason
    assert 'another gear' in found.reason


def test_the_next_tow_tells_an_effect_from_its_rival(coarse, caught):
    seen = caught.score_test
    best = caught.best.refit.wanted[0]
    (rival,) = [one for one in seen.wanted if one.name == 'spread_sensor']
    predictor = Predictor(build_model(coarse))
    proposals = propose(predictor, seen, best, np.array([2.0]), [rival])
    assert proposals
    first = proposals[0]
    assert first.after > first.before > 0.0
    assert first.per_hour == pytest.approx(first.after - first.before)
    assert all(first.per_hour >= other.per_hour for other in proposals)
    assert 'nearest rival (χ² ' in str(first)
    assert propose(predictor, seen, best, np.array([2.0]), []) == ()


def test_what_leaves_a_towed_state_without_steady_state_explains_nothing(
    coarse, caught, monkeypatch
):
    def lossy(*args):
        found = refit(*args)
        fewer = replace(found.fit, windows=found.fit.windows[:-1])
        return replace(found, estimator=SimpleNamespace(fit=fewer))

    monkeypatch.setattr(refits, 'refit', lossy)
    wanted = caught.best.refit.wanted
    predictor = Predictor(build_model(coarse))
    assert refits.refitted(predictor, caught.base, caught.score_test, wanted) is None


def test_a_window_that_the_likeliest_effect_loses_is_told(coarse, caught, monkeypatch):
    """What explains most of its own windows is not passed over for one state out of many."""
    base, last = caught.base, caught.base.fit.windows[-1].window.index

    def lossy(*args):
        found = refit(*args)
        fewer = replace(found.fit, windows=found.fit.windows[:-1])
        return replace(found, estimator=SimpleNamespace(fit=fewer))

    monkeypatch.setattr(refits, 'refit', lossy)
    monkeypatch.setattr(naming, 'OPTIONS', replace(naming.OPTIONS, set_aside=0.2))
    named = naming.name(Predictor(build_model(coarse)), base, caught.score_test)
    assert named.lost == {last}
    assert named.weighed == ()
    monkeypatch.setattr(naming, 'OPTIONS', replace(naming.OPTIONS, set_aside=0.0))
    monkeypatch.setattr(naming, 'SCREENED', 1)
    assert naming.name(Predictor(build_model(coarse)), base, caught.score_test).lost == frozenset()


def test_a_baseline_that_looks_like_the_gear_shows_that_it_is_the_same(coarse, hide, with_catch):
    def other(values):
        return {name: value * (1.6 if 'depth' in name else 0.5) for name, value in values.items()}

    predictor, prior = Predictor(build_model(coarse)), board_prior(coarse)
    assert was_in_order(predictor, prior, with_catch, frozenset({0}))
    assert not was_in_order(predictor, prior, with_catch, frozenset())
    windows = hide.trial(coarse, hide.Hidden(shown=other), 6, tows=1)
    assert not was_in_order(predictor, prior, windows, frozenset({0}))


def test_another_error_of_the_same_instrument_is_looked_for_too(caught):
    """Whatever else looks like the best."""

    def of_one(candidate):
        same = candidate.name in ('catch_build_up', 'spread_sensor')
        effect = replace(candidate.effect, instrument='one' if same else '')
        return replace(candidate, effect=effect)

    before, best = caught.score_test, caught.best
    seen = replace(before, wanted=tuple(of_one(one) for one in before.wanted))
    (place,) = (n for n, one in enumerate(before.wanted) if one is best.refit.wanted[0])
    told = replace(best, refit=replace(best.refit, wanted=(seen.wanted[place],)))
    without, with_it = (
        [one.name for one in several._like_the_best(looks, [weighed])]
        for looks, weighed in ((before, best), (seen, told))
    )
    assert 'spread_sensor' not in without
    assert with_it == [*without, 'spread_sensor']


def test_where_no_effect_could_be_refitted_there_is_no_placebo(coarse, caught):
    nothing = replace(caught.named, verdict='UNKNOWN', weighed=(), alike=())
    predictor = Predictor(build_model(coarse))
    assert procedure._placebo(predictor, caught.base, caught.score_test, nothing) is None
