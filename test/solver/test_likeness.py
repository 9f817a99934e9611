"""What two gears are said to share they share to the last bit, whatever has changed in one."""

from collections.abc import Iterator

import numpy as np

from trawl_ros.diagnosis.library.gear_file_change import changes_of
from trawl_ros.effects.base.effect import Effect, Situation
from trawl_ros.effects.registry import catalogue
from trawl_ros.model.assembly import forces, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.solver.equilibrium import SteadyState
from trawl_ros.solver.model_equality import same_forces, same_mass, same_observables

AT = Situation((500.0, 500.0, 2.1), hours=1.0)


def changed(model: GearModel) -> Iterator[tuple[Effect, GearModel, GearModel]]:
    """Each effect and change of the gear file, with both gears of a derivative by its values."""
    for effect in (*catalogue().values(), *changes_of(model.gear)):
        for index, parameter in enumerate(effect.parameters):
            step = 1e-4 * parameter.std * np.eye(len(effect.parameters))[index]
            up, down = (effect.gear(effect.neutral + sign * step, model, AT) for sign in (1, -1))
            yield effect, up, down


def test_what_is_said_to_be_the_same_is_the_same(model: GearModel, steady: SteadyState) -> None:
    found, left_out, seen, heavy = steady.equilibrium, 0, 0, 0
    for effect, up, down in changed(model):
        if same_forces(up, down):
            left_out += 1
            pulls = [forces(gear, found.state, found.tow) for gear in (up, down)]
            assert np.array_equal(*pulls), effect.name
        if same_forces(up, down) or same_observables(up, down):
            seen += 1
            both = [observe(gear, found.state, found.tow).array() for gear in (up, down)]
            assert np.array_equal(*both), effect.name
        if same_mass(up, down):
            heavy += 1
            both = [mass(gear, found.state, found.tow) for gear in (up, down)]
            assert np.array_equal(*both), effect.name
    assert left_out >= 15
    assert heavy >= 20
    assert seen >= 60


def test_a_gear_built_anew_is_the_same_and_one_that_differs_is_not(model: GearModel) -> None:
    assert same_forces(model, model.with_coefficients(model.coefficients.copy()))
    assert not same_forces(model, model.with_net(1.001, 1.0))
    assert not same_forces(model, model.with_coefficients(model.coefficients + 1e-9))
    assert same_observables(model, model.with_net(1.001, 1.0))
