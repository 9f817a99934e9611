"""Trials with causes on deck: a sample is drawn beforehand, and what was said is counted."""

from dataclasses import replace

import numpy as np
import pytest

from studies.discrepancy.deck import cause_rows, deck_rows
from studies.discrepancy.figure import verdicts_figure
from studies.discrepancy.plan import DECK_STRENGTHS, BlindStudyPlan
from trawl_ros.effects.base.effect import Situation
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.trials.hidden_effects.other_keys import CAUSES
from trawl_ros.lab.trials.trial import Scored
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

DECK = BlindStudyPlan(clean=0, inside=0, outside=0, pairs=0, poor=0, dynamic=0, triples=0)


def said(
    cause: str, verdict: str, *names: str, beside: tuple[str, ...] = (), strength: float = 3.0
) -> Scored:
    """A trial with a cause on deck, and what was said of it."""
    spec = {'series': 'deck', 'form': 'windows', 'effects': [cause], 'strength': strength}
    effects = [{'name': name, 'class': [name]} for name in names]
    found = {'verdict': verdict, 'effects': effects, 'ambiguous_with': list(beside)}
    return Scored({'spec': spec}, found)


def test_a_sample_has_trials_of_the_whole_study_and_no_bags():
    whole = {spec.number: spec for spec in DECK.specs() if spec.form == 'windows'}
    assert len(whole) == len(CAUSES) * len(DECK_STRENGTHS)
    some = replace(DECK, sample=18).specs()
    assert len(some) == 18
    assert all(spec == whole[spec.number] for spec in some)
    assert some == replace(DECK, sample=18).specs()
    assert some != replace(DECK, sample=18, seed=DECK.seed + 1).specs()
    assert set(replace(DECK, sample=1000).specs()) == set(whole.values())


def test_verdicts_on_causes_on_deck_are_counted_as_fair_or_wrong():
    trials = [
        said('rigging_epsilon', 'NAMED', 'board_rigging'),
        said('rigging_epsilon', 'NAMED', 'net_drag', strength=6.0),
        said('rigging_zeta', 'AMBIGUOUS', 'net_drag', beside=('board_rigging',)),
        said('rigging_eta', 'AMBIGUOUS', 'net_drag', beside=('board_rigging', 'kite', 'floats')),
        said('rigging_eta', 'UNKNOWN', 'net_drag', strength=6.0),
        said('kite_gone', 'NO_DISCREPANCY'),
    ]
    rows = {row.what: row.value for row in deck_rows(trials, {})}
    assert rows['causes detected at 3 times'] == pytest.approx(75.0)
    assert rows['right single name or class at 3 times'] == pytest.approx(25.0)
    assert rows['right, or in a set of at most 3, or UNKNOWN, at 3 times'] == pytest.approx(50.0)
    assert rows['wrong confident name at 3 times'] == 0.0
    assert rows['wrong confident name at 6 times'] == pytest.approx(50.0)
    assert rows['causes UNKNOWN at 6 times'] == pytest.approx(50.0)
    notes = [row.note for row in cause_rows(trials, {})]
    assert notes == [
        '0 of 1; 3 times NO_DISCREPANCY',
        '1 of 2; 3 times NAMED board_rigging; 6 times NAMED net_drag',
        '1 of 2; 3 times AMBIGUOUS net_drag or board_rigging, floats, kite; 6 times UNKNOWN',
        '1 of 1; 3 times AMBIGUOUS net_drag or board_rigging',
    ]


def test_the_picture_of_causes_on_deck_has_them_and_its_caption_says_so():
    trials = [
        said('rigging_epsilon', 'NAMED', 'board_rigging'),
        said('kite_gone', 'UNKNOWN', strength=6.0),
    ]
    drawing = verdicts_figure(trials, {})
    above, below = drawing.figure.axes
    assert [tick.get_text() for tick in above.get_yticklabels()] == [
        'on deck, 3 ×: 1 trials', 'on deck, 6 ×: 1 trials'
    ]  # fmt: skip
    assert [tick.get_text() for tick in below.get_yticklabels()] == ['kite gone', 'rigging epsilon']
    assert 'cause on deck' in drawing.caption
    assert 'catalogue' not in drawing.caption


def test_a_board_that_drags_something_along_pulls_the_more_on_its_warp():
    gear = load_gear('kaifuha')
    few = gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 12})})
    model = build_model(few).with_coefficients(board_prior(few).start)
    hidden = CAUSES['starboard_board_drag'](np.random.default_rng(0))
    point = OperatingPoint(500.0, 500.0, 2.2)
    fouled = hidden.gear(0.4, model, Situation((500.0, 500.0, 2.2)))
    clean, seen = (find_equilibrium(own, point).observables for own in (model, fouled))
    assert seen.starboard_tension > 1.01 * clean.starboard_tension
    assert seen.starboard_tension > 1.01 * seen.port_tension
