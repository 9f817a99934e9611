"""Blind trials in bags, in time, towed on, and without errors."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.effects.base.effect import Situation
from trawl_ros.lab.missing_effect.trials_folder import read_bags
from trawl_ros.lab.trials.hidden_effects.inside import INSIDE
from trawl_ros.lab.trials.making import make
from trawl_ros.lab.trials.plant import FINER_MESH, draw_plant
from trawl_ros.lab.trials.readings import AS_STATED
from trawl_ros.lab.trials.recording import record_tows
from trawl_ros.lab.trials.towing import (
    hidden_effect_set,
    quasi_steady,
    settling_time,
    towed_in_time,
)
from trawl_ros.lab.trials.tows import FULL_PLAN, PlannedTow
from trawl_ros.lab.trials.trial import Spec
from trawl_ros.records.channels import MEASURED
from trawl_ros.records.observables import OBSERVABLES

GEAR, SEED = 'kaifuha', 5


@pytest.fixture(scope='module')
def plant():
    return draw_plant(GEAR, FINER_MESH, SEED, 0)


@pytest.fixture(scope='module')
def poor():
    spec = Spec('poor', 1, ('counter_offset',), 2.0, (1.0,), 0, 'poor')
    key, made = make(spec, GEAR, FINER_MESH, SEED)
    assert key.testable, key.why_not
    return spec, made


def test_states_follow_each_other_and_are_held_until_they_are_steady(plant):
    tow, looks = FULL_PLAN.tows[1], plant.towed((), FULL_PLAN)[1]
    course = quasi_steady(tow, looks)
    assert np.all(np.diff(course.times) > 0.0)
    assert course.heading == pytest.approx(np.pi)
    for moment, look in zip(course.moments, looks, strict=True):
        for time in (moment - settling_time(*look.state), moment, moment + 60.0):
            inputs, values = course.at(np.array([time]))
            np.testing.assert_allclose(inputs[0], look.inputs)
            np.testing.assert_allclose(values[0], look.values)


@pytest.mark.slow
def test_what_is_found_in_a_bag_is_what_was_towed(plant, tmp_path):
    looks = plant.towed((), FULL_PLAN)[:2]
    courses = [quasi_steady(tow, own) for tow, own in zip(FULL_PLAN.tows, looks, strict=False)]
    rng = np.random.default_rng(1)
    record_tows(tmp_path / 'bags', courses, plant.model.water, AS_STATED, 0.0, rng)
    windows = read_bags(sorted((tmp_path / 'bags').iterdir()), FINER_MESH.model(GEAR))
    assert {window.tow for window in windows} == {0, 1}
    found = set()
    for window in windows:
        # As at sea, the noise of the log hides that some states are steady.
        (look,) = (
            own
            for own in looks[window.tow]
            if abs(window.means['port_length'] - own.inputs[0]) < 5.0
            and abs(window.means['speed'] - own.inputs[2]) < 0.08
        )
        found.add((window.tow, look.state))
        shown = [name for name in MEASURED if name in window.means]
        assert {'port_tension', 'starboard_roll', 'net_depth'} <= set(shown)
        for name in shown:
            error = window.means[name] - look[name]
            assert abs(error) < 6.0 * window.std(name), name
        assert window.sense == (1.0 if FULL_PLAN.tows[window.tow].eastward else -1.0)
    assert len(found) >= 7


@pytest.mark.slow
def test_channels_that_need_not_be_there_fall_silent(plant, tmp_path):
    courses = [quasi_steady(FULL_PLAN.tows[0], plant.towed((), FULL_PLAN)[0])]
    rng = np.random.default_rng(2)
    record_tows(tmp_path / 'bags', courses, plant.model.water, AS_STATED, 1.0, rng)
    windows = read_bags([tmp_path / 'bags' / 'tow_01'], FINER_MESH.model(GEAR))
    assert windows
    assert all('port_pitch' not in window.means for window in windows)
    assert all('net_depth' in window.means for window in windows)


@pytest.mark.slow
def test_towed_in_time_the_plant_comes_to_rest_where_its_steady_states_are(plant):
    effects = [
        (INSIDE['counter_offset'](np.random.default_rng(0)), 10.0),
        (INSIDE['spread_sensor'](np.random.default_rng(0)), 0.05),
    ]
    tow = PlannedTow(((300.0, 2.4),), eastward=False)
    course = towed_in_time(plant.model, tow, effects)
    inputs, values = course.at(np.array(course.moments))
    np.testing.assert_allclose(inputs[0], (300.0, 300.0, 2.4), rtol=1e-6)
    steady = plant.towed(effects, replace(FULL_PLAN, tows=(tow,), baseline=0))[0][0]
    rows = [OBSERVABLES.index(name) for name in MEASURED]
    np.testing.assert_allclose(values[0][rows], steady.values[rows], rtol=0.01, atol=0.01)


def test_what_is_hidden_acts_in_time_as_in_steady_states(plant):
    hidden = INSIDE['current_shear'](np.random.default_rng(0))
    there = hidden_effect_set([(hidden, 0.05)])
    at = Situation((300.0, 300.0, 2.4), sense=-1.0)
    depth = np.array([-100.0])
    np.testing.assert_allclose(
        there.gear(plant.model, at).water.current(depth),
        hidden.gear(0.05, plant.model, at).water.current(depth),
    )
    # In the axes of the model she always heads east; in time she turns round, and the sea does not.
    back = Situation((300.0, 300.0, 2.4), heading=np.pi, sense=-1.0)
    east = there.gear(plant.model, back).water.current(depth)
    np.testing.assert_allclose(east, -there.gear(plant.model, at).water.current(depth), atol=1e-12)
