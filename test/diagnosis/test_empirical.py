"""What no effect explains gets an empirical term, which is called so and closes the gap."""

import json

import numpy as np
import pytest

from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.diagnosis.report.sentences import headline, sentences
from trawl_ros.diagnosis.report.writing import write_diagnosis
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.effect_set import ActiveEffect, effects_of
from trawl_ros.effects.empirical import dictionary
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import EffectRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

INPUTS = np.array([451.0, 449.0, 2.2])
AT = Situation((451.0, 449.0, 2.2), hours=1.5)
NAMES = sorted(dictionary())


def one_sided(values):
    """A depth sensor of one board alone, which the catalogue does not have."""
    return values | {'port_door_depth': 1.12 * values['port_door_depth']}


@pytest.fixture(scope='module')
def windows(coarse, hide):
    return hide.trial(coarse, hide.Hidden(shown=one_sided), 7, tows=4)


@pytest.fixture(scope='module')
def found(coarse, hide, windows):
    return diagnose_windows(coarse, windows, hide.names[:4])


@pytest.mark.slow
def test_it_is_unknown_and_the_term_is_called_empirical(found):
    assert found.verdict == 'UNKNOWN', found.reason
    assert found.empirical.term.name.startswith('empirical_port_door_depth')
    assert found.empirical.weighed.delta_chi2 > found.empirical.placebo
    assert 'no effect' in headline(found)
    (said,) = [sentence for sentence in sentences(found) if 'Empirical' in sentence]
    assert 'not a cause' in said
    assert 'port door depth' in said


@pytest.mark.slow
def test_it_closes_the_gap_from_the_gear_file(found, windows, hide, tmp_path):
    assert found.holdout.removed > 0.5
    write_diagnosis(found, [], tmp_path)
    numbers = json.loads((tmp_path / 'diagnosis.json').read_text())
    assert numbers['effects'] == []
    assert numbers['empirical']['label'] == 'empirical'
    assert numbers['empirical']['placebo_chi2'] < numbers['empirical']['delta_chi2']
    gear = load_gear(tmp_path / 'model.yaml')
    (effect,) = gear.effects
    assert effect.name == found.empirical.term.name
    again = diagnose_windows(gear, windows, hide.names[:4])
    assert again.verdict == 'NO_DISCREPANCY', again.reason


def test_terms_and_effects_have_names_of_their_own():
    assert not set(dictionary()) & set(catalogue())
    assert all(name.startswith('empirical_') for name in dictionary())
    assert all(term.reading and term.sentence.endswith('.') for term in dictionary().values())


def test_a_gear_file_may_have_a_term(coarse):
    record = EffectRecord(name='empirical_net_weight', values={'size': 0.3})
    (active,) = effects_of(coarse.model_copy(update={'effects': (record,)})).effects
    assert active.values == [0.3]


@pytest.fixture(scope='module')
def model(coarse):
    return build_model(coarse)


@pytest.fixture(scope='module')
def plain(model, coarse):
    start = np.array(board_prior(coarse).start)
    return start, Predictor(model).predict(start, *INPUTS)


@pytest.mark.slow
def test_terms_do_nothing_at_nought_and_have_the_derivatives_they_claim(model, plain):
    start, clean = plain
    terms = [dictionary()[name] for name in NAMES]
    wanted = [ActiveEffect(term, term.neutral) for term in terms]
    claimed = Predictor(model, at=AT).signatures(start, INPUTS, clean.state, wanted)
    assert np.all(np.abs(claimed).max(axis=0) > 0.0), 'every term shows'
    for place, term in enumerate(terms):
        if place % 5:
            continue
        (parameter,) = term.parameters
        step = 0.02 * parameter.std
        predictor = Predictor(model, free=(term,), at=AT)
        there, back = (
            predictor.predict(np.append(start, size), *INPUTS, start=clean.state).values
            for size in (step, -step)
        )
        slope = (there - back) / (2.0 * step)
        scale = np.abs(slope).max()
        np.testing.assert_allclose(claimed[:, place], slope, rtol=2e-3, atol=2e-3 * scale)
