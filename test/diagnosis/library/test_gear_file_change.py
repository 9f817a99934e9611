"""Changes of a gear file: their keys, their sizes, and what they do to first order."""

import re

import numpy as np
import pytest
from pydantic import BaseModel

from trawl_ros.diagnosis.library.gear_file_change import changed, changes_of
from trawl_ros.diagnosis.library.table import EntryRecord, hypothesis_table
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.gear.rigging import SweepRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.predict import Predictor

GEARS = ('kaifuha', 'four_seam', 'pair_368')


def record(name):
    (found,) = [own for own in hypothesis_table().entries if own.name == name]
    return found


def has_key(model, key):
    """True if gear files may have a key."""
    own = model
    for name in re.sub(r'\[\d*\]', '', key).split('.'):
        fields = [kind.model_fields for kind in kinds(own) if name in kind.model_fields]
        if not fields:
            return False
        own = fields[0][name].annotation
    return True


def kinds(annotation):
    """Records that an annotation allows."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [kind for part in getattr(annotation, '__args__', ()) for kind in kinds(part)]


def test_every_key_is_one_of_a_gear_file():
    unknown = [
        key
        for own in hypothesis_table().entries
        for key in own.keys
        if not has_key(GearRecord, key)
    ]
    assert not unknown
    assert not has_key(GearRecord, 'warp.colour')


def test_what_a_gear_does_not_have_is_passed_over():
    by_gear = {name: {own.name for own in changes_of(load_gear(name))} for name in GEARS}
    assert {'board_area', 'twine', 'kite_setting', 'block_spacing'} <= by_gear['kaifuha']
    assert not by_gear['kaifuha'] & {'hung_weights', 'pair_distance', 'sweep_length', 'catch'}
    assert {'hung_weights', 'hung_floats', 'twine_number'} <= by_gear['four_seam']
    assert not by_gear['four_seam'] & {'kite_setting', 'clump_drag'}
    assert 'pair_distance' in by_gear['pair_368']
    swept = load_gear('kaifuha').model_copy(
        update={'sweep': SweepRecord(length_m=50.0, upper_backstrop_m=5.0, lower_backstrop_m=5.0)}
    )
    assert 'upper_backstrop' in {own.name for own in changes_of(swept)}


def test_ropes_change_on_one_side_alone_and_say_so():
    gear = load_gear('kaifuha').refined(net=0.25)
    by_name = {own.name: own for own in changes_of(gear)}
    assert {'port_warp_weight', 'starboard_bridle_diameter'} <= set(by_name)
    assert 'port_board_area' not in by_name
    change, model = by_name['starboard_bridle_diameter'], build_model(gear)
    there = change.gear(np.array([0.5]), model, Situation((500.0, 500.0, 2.0)))
    thicker = np.flatnonzero(there.bars.normal_area != model.bars.normal_area)
    own = [
        bars
        for name, _, bars in model.layout.lines
        if name.startswith('starboard') and name.endswith('bridle')
    ]
    np.testing.assert_array_equal(thicker, np.sort(np.concatenate(own)))
    assert all(part in change.words(0.5) for part in ('bridles', 'starboard', '50 %'))


def test_a_change_on_one_side_is_made_of_the_gear_with_that_on_both(monkeypatch):
    gear = load_gear('kaifuha').refined(net=0.25)
    by_name = {own.name: own for own in changes_of(gear)}
    model, at, built = build_model(gear), Situation((500.0, 500.0, 2.0)), []
    monkeypatch.setattr(
        'trawl_ros.diagnosis.library.gear_file_change.build_model',
        lambda own: built.append(own) or build_model(own),
    )
    names = 'bridle_diameter', 'port_bridle_diameter', 'starboard_bridle_diameter'
    both, port, starboard = (by_name[name].gear(np.array([0.5]), model, at) for name in names)
    assert len(built) == 1
    own = port.bars.normal_area != model.bars.normal_area
    other = starboard.bars.normal_area != model.bars.normal_area
    assert own.any()
    assert other.any()
    assert not (own & other).any()
    np.testing.assert_array_equal(own | other, both.bars.normal_area != model.bars.normal_area)


def test_only_the_numbers_at_the_keys_change():
    gear = load_gear('kaifuha')
    thicker = changed(gear, record('front_twine'), 0.5)
    before, after = (
        [section.twine_diameter_m for section in own.netting.body] for own in (gear, thicker)
    )
    assert after == pytest.approx([1.5 * before[0], 1.5 * before[1], *before[2:]])
    body = gear.netting.body
    netting = thicker.netting.model_copy(update={'body': body})
    assert thicker.model_copy(update={'netting': netting}) == gear
    ahead = changed(gear, record('warp_hole_ahead'), 0.1).board.fastening.warp_m
    assert ahead == pytest.approx(np.add(gear.board.fastening.warp_m, (0.1, 0.0, 0.0)))


def test_a_change_is_told_in_words_with_its_size():
    assert record('warp_diameter').words(0.247) == 'thicker warps, by about 25 %'
    assert record('warp_diameter').words(3.07) == 'thicker warps, by about 310 %'
    assert record('block_spacing').words(-1.5) == 'towing blocks closer together, by about 1.5 m'


@pytest.mark.parametrize(
    ('change', 'found'),
    [
        ({'low': 0.0, 'high': 0.0}, 'found 0, .*low'),
        ({'low': -1.5}, 'found -1.5'),
        ({'unit': 'm'}, 'without a unit'),
    ],
)
def test_a_size_that_cannot_be_is_refused(change, found):
    with pytest.raises(ValueError, match=found):
        EntryRecord.model_validate(record('warp_diameter').model_dump() | change)


def test_it_is_carried_through_the_solver_to_first_order(coarse):
    (change,) = [own for own in changes_of(coarse) if own.name == 'board_area']
    model = build_model(coarse)
    point, inputs = OperatingPoint(500.0, 500.0, 2.1), np.array([500.0, 500.0, 2.1])
    here = find_equilibrium(model, point)
    predictor = Predictor(
        model, EffectSet((ActiveEffect(change, change.neutral),)), at=Situation((0.0, 0.0, 0.0))
    )
    active = [ActiveEffect(change, change.neutral)]
    (slopes,) = predictor.signatures(model.coefficients, inputs, here, active).T
    size = 1e-3
    there = [
        find_equilibrium(
            build_model(changed(coarse, change.record, sign * size)), point, here
        ).observables.array()
        for sign in (1.0, -1.0)
    ]
    differences = (there[0] - there[1]) / (2.0 * size)
    for name in ('door_spread', 'net_depth', 'port_tension'):
        place = OBSERVABLES.index(name)
        assert slopes[place] == pytest.approx(differences[place], rel=1e-3), name


def test_it_acts_ahead_of_the_effects_of_the_gear_file(coarse):
    (change,) = [own for own in changes_of(coarse) if own.name == 'clump_drag']
    model = build_model(coarse)
    floats = catalogue()['floats']
    acting = EffectSet((ActiveEffect(change, np.array([1.0])), ActiveEffect(floats, np.ones(1))))
    both = acting.gear(model, Situation((0.0, 0.0, 0.0)))
    alone = build_model(changed(coarse, change.record, 1.0))
    assert np.allclose(both.lump_drag_area, alone.lump_drag_area - alone.floats[2])
