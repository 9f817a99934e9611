"""Each effect does nothing where it is neutral, and what it does has the derivatives it claims."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.effect_set import NO_EFFECTS, ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.records import FloatRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

INPUTS = np.array([451.0, 449.0, 2.2])
AT = Situation((451.0, 449.0, 2.2), sense=-1.0, hours=1.5)
NAMES = sorted(catalogue())


def strong(effect):
    """Values at which the effect is there."""
    values = effect.neutral + np.array([0.5 * parameter.std for parameter in effect.parameters])
    # The ground lies where the footrope is.
    return np.array([2000.0, 95.0]) if effect.name == 'bottom_contact' else values


@pytest.fixture(scope='module')
def with_floats(gear):
    """The coarse gear with floats along its headrope, of which some may be lost."""
    floats = FloatRecord(buoyancy_n=14000.0, density_kg_m3=300.0, drag_area_m2=1.4)
    netting = gear.netting.model_copy(update={'around': 12})
    return build_model(gear.model_copy(update={'netting': netting, 'floats': floats}))


@pytest.fixture(scope='module')
def coefficients(gear):
    return board_prior(gear).start


@pytest.fixture(scope='module')
def plain(model, coefficients):
    return Predictor(model).predict(coefficients, *INPUTS)


@pytest.mark.parametrize('name', [name for name in NAMES if catalogue()[name].parameters])
def test_where_it_is_neutral_it_does_nothing(model, coefficients, plain, name):
    effect = catalogue()[name]
    predictor = Predictor(model, free=(effect,), at=AT)
    values = np.concatenate((coefficients, effect.neutral))
    found = predictor.predict(values, *INPUTS, start=plain.state)
    np.testing.assert_allclose(found.values, plain.values, rtol=1e-7, atol=1e-9)
    same = np.hstack((found.jacobian[:, :12], found.jacobian[:, -3:]))
    np.testing.assert_allclose(same, plain.jacobian, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize('name', [name for name in NAMES if catalogue()[name].fitted])
def test_it_has_the_derivatives_it_claims(model, with_floats, coefficients, plain, name):
    effect = catalogue()[name]
    if name == 'floats':
        model = with_floats
        plain = Predictor(model).predict(coefficients, *INPUTS, start=plain.state)
    predictor = Predictor(model, free=(effect,), at=AT)
    here = np.concatenate((coefficients, strong(effect), INPUTS))

    def predicted(at):
        return predictor.predict(at[:-3], *at[-3:], start=plain.state)

    found = predicted(here)
    assert np.max(np.abs(found.values / plain.values - 1.0)) > 1e-4
    place = len(coefficients)
    for index in (1, *range(place, len(here))):
        std = [parameter.std for parameter in effect.parameters]
        size = 0.001 * std[index - place] if place <= index < len(here) - 3 else 0.01
        step = size * np.eye(len(here))[index]
        slope = (predicted(here + step).values - predicted(here - step).values) / (2.0 * size)
        scale = 1e-3 * np.abs(slope).max()
        claimed = found.jacobian[:, index]
        np.testing.assert_allclose(claimed, slope, rtol=2e-2, atol=scale, err_msg=str(index))


@pytest.mark.parametrize('name', [name for name in NAMES if catalogue()[name].dynamic])
def test_what_shows_in_motion_alone_does_not_show_in_steady_tows(model, coefficients, plain, name):
    effect = catalogue()[name]
    values = np.concatenate((coefficients, strong(effect)))
    found = Predictor(model, free=(effect,)).predict(values, *INPUTS, start=plain.state)
    np.testing.assert_allclose(found.values, plain.values, rtol=1e-7, atol=1e-9)


def test_signatures_of_all_at_once_are_those_of_each(model, coefficients, plain):
    effects = [effect for effect in catalogue().values() if effect.fitted]
    predictor = Predictor(model, at=AT)
    wanted = [ActiveEffect(effect, effect.neutral) for effect in effects]
    together = predictor.signatures(coefficients, INPUTS, plain.state, wanted)
    assert together.shape == (len(OBSERVABLES), sum(len(one.values) for one in wanted))
    column = 0
    for effect in effects:
        alone = Predictor(model, free=(effect,), at=AT).predict(
            np.concatenate((coefficients, effect.neutral)), *INPUTS, start=plain.state
        )
        number = len(effect.parameters)
        expected = alone.jacobian[:, 12:-3]
        scale = 1e-6 * max(np.abs(expected).max(), 1.0)
        found = together[:, column : column + number]
        np.testing.assert_allclose(found, expected, rtol=1e-4, atol=scale, err_msg=effect.name)
        column += number


def test_a_shear_turns_round_with_the_ship(model, coefficients, plain):
    effect = catalogue()['current_shear']
    values = np.concatenate((coefficients, [0.03]))
    ahead, back = (
        Predictor(model, free=(effect,), at=replace(AT, sense=sense)).predict(
            values, *INPUTS, start=plain.state
        )
        for sense in (1.0, -1.0)
    )
    tension = OBSERVABLES.index('port_tension')
    # Water that runs away ahead of the gear below leaves it less to pull through.
    assert ahead.values[tension] < plain.values[tension] < back.values[tension]


def test_free_effects_are_not_there_in_tows_without_them(model, coefficients, plain):
    effect = catalogue()['tension_cell']
    predictor = Predictor(model, free=(effect,), absent=True)
    values = np.concatenate((coefficients, [5e3, 0.1]))
    found = predictor.predict(values, *INPUTS, start=plain.state)
    np.testing.assert_allclose(found.values, plain.values, rtol=1e-9)
    np.testing.assert_array_equal(found.jacobian[:, 12:14], 0.0)


def test_fixed_effects_act_on_what_is_shown(model, coefficients, plain):
    fixed = EffectSet((ActiveEffect(catalogue()['tension_cell'], np.array([1e3, 0.1])),))
    found = Predictor(model, fixed).predict(coefficients, *INPUTS, start=plain.state)
    tension = OBSERVABLES.index('port_tension')
    assert found.values[tension] == pytest.approx(1.1 * plain.values[tension] + 1e3)
    np.testing.assert_allclose(found.jacobian[tension], 1.1 * plain.jacobian[tension], rtol=1e-6)


def test_one_of_the_same_name_takes_its_place(gear):
    effects = catalogue()
    first = ActiveEffect(effects['heave'], np.array([0.1]))
    other = ActiveEffect(effects['counter_offset'], np.array([5.0]))
    both = NO_EFFECTS.having(first).having(other)
    changed = both.having(ActiveEffect(effects['heave'], np.array([0.3])))
    assert [active.name for active in changed.effects] == ['heave', 'counter_offset']
    assert changed.of(effects['heave']).values == pytest.approx([0.3])
    assert changed.of(effects['counter_scale']).values == pytest.approx([0.0, 0.0])


def test_the_net_is_estimated_along_beside_effects(model, coefficients, plain):
    fixed = EffectSet((ActiveEffect(catalogue()['tension_cell'], np.array([1e3, 0.1])),))
    predictor = Predictor(model, fixed)
    found = predictor.predict(coefficients, *INPUTS, start=plain.state)
    size = 1e-3
    up, down = (
        predictor.with_net(1.0 + sign * size, 1.0).predict(coefficients, *INPUTS, found.state)
        for sign in (1.0, -1.0)
    )
    slope = (up.values - down.values) / (2.0 * size)
    claimed = predictor.by_net(coefficients, np.array(INPUTS), found.state)[:, 0]
    np.testing.assert_allclose(claimed, slope, rtol=1e-3, atol=1e-3 * np.abs(slope).max())


def test_a_gear_without_effects_is_the_same_in_every_window(model):
    predictor = Predictor(model)
    assert predictor.in_window(SimpleNamespace(tow=3, hours=2.0, sense=-1.0)) is predictor
