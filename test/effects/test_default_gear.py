"""A gear file with effects, its net as fine as it ships."""

from pathlib import Path

import pytest

from trawl_ros.diagnosis.repair import gear_text
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import EffectRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.equilibrium import steady_state


@pytest.fixture(scope='module')
def affected(gear, tmp_path_factory):
    path: Path = tmp_path_factory.mktemp('gear') / 'affected.yaml'
    drag = EffectRecord(name='net_drag', values={'factor': 1.5})
    path.write_text(gear_text(gear.model_copy(update={'effects': (drag,)})))
    return load_gear(path)


def test_its_steady_state_has_the_effect(gear, affected):
    without = steady_state(build_model(gear), 500.0, 2.1).observables
    there = steady_state(build_model(affected), 500.0, 2.1).observables
    assert there.warp_tension > 1.1 * without.warp_tension


def test_it_is_towed_with_the_effect(gear, affected):
    command = Command(500.0, 500.0, 2.1)
    without = Simulation(build_model(gear), command).truth()
    there = Simulation(build_model(affected), command, effect_set=effects_of(affected)).truth()
    assert there.winches[0].tension > 1.1 * without.winches[0].tension
