"""Derivatives of F - M a by the values of effects against central differences of all of it."""

import numpy as np
import pytest

from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.model.assembly import forces, mass
from trawl_ros.solver.model_equality import same_observables
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.partials import GearAtPoint, StepEnd, effect_pushes
from trawl_ros.solver.motion.tow import DifferentiatedTow

ON_GEAR = tuple(one for one in catalogue().values() if type(one).gear is not Effect.gear)
PARAMETERS = MotionParameters(effects=ON_GEAR)
PART = 1e-3
"""Part of each value's std over which central differences are taken."""


def hauling(time):
    lengths = 420.0 - 0.5 * time
    return InputPoint(
        inputs=np.array([lengths, lengths + 5.0, 2.2]),
        rates=np.array([-0.5, -0.5, 0.0]),
        hours=1.0 + time / 3600.0,
    )


@pytest.fixture(scope='module', params=[(), ('board_added_mass', 'board_damage')])
def hauled(request, model):
    """Gear, with or without effects that act, at the end of a step of hauling."""
    acting = EffectSet(
        tuple(
            ActiveEffect(one, one.neutral + 0.2 * np.array([own.std for own in one.parameters]))
            for one in map(catalogue().get, request.param)
        )
    )
    tow = DifferentiatedTow(model, MotionParameters(), hauling, acting)
    for _ in range(5):
        tow.advance(2.0)
    motion = tow.motion
    end = StepEnd(motion.state, motion.acceleration, tow.course.tow, motion.state)
    return GearAtPoint(model, acting, hauling(tow.time)), end


def left(gear, acting, end):
    model = gear.model(acting)
    inertia = mass(model, end.predicted, end.tow)
    return forces(model, end.state, end.tow) - model.pattern.times(inertia, end.acceleration)


def beside(gear, effect, number):
    """Gears with one value of an effect a little larger and smaller, and that difference."""
    values, size = gear.acting.of(effect).values, PART * effect.parameters[number].std
    step = size * np.eye(len(values))[number]
    both = [gear.acting.having(ActiveEffect(effect, values + sign * step)) for sign in (1, -1)]
    return *both, 2.0 * size


def test_every_effect_pushes_as_central_differences_of_all_forces_and_masses_say(hauled):
    gear, end = hauled
    found, column = effect_pushes(gear, PARAMETERS, end).push, 0
    for effect in ON_GEAR:
        for number in range(len(effect.parameters)):
            up, down, size = beside(gear, effect, number)
            slope = (left(gear, up, end) - left(gear, down, end)) / size
            worst = np.abs(found[:, column] - slope).max()
            assert worst <= 1e-5 * np.abs(slope).max(), f'{effect.name} {number}'
            column += 1
    assert column == found.shape[1]


def test_those_that_change_what_a_gear_shows_where_it_stays_are_told(hauled):
    gear, end = hauled
    showing = set()
    for effect in ON_GEAR:
        for number in range(len(effect.parameters)):
            up, down, _ = beside(gear, effect, number)
            if not same_observables(gear.model(up), gear.model(down)):
                showing.add(effect.name)
    assert effect_pushes(gear, PARAMETERS, end).showing == showing
    assert 'other_wire' in showing
