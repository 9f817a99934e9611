"""Advice on a refused tow: its least speed and its remedies hold when solved from nothing."""

import doctest
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.advising.advice import advice
from trawl_ros.solver.advising.rig_changes import rig_changes
from trawl_ros.solver.equilibrium import steady_state


@pytest.fixture(scope='module')
def coarse() -> GearModel:
    return build_model(load_gear('kaifuha').refined(net=0.25))


def with_heavy_boards(times: float) -> GearModel:
    """The coarse gear with boards so many times as heavy, which sink in a slow tow."""
    gear = load_gear('kaifuha')
    board = gear.board.model_copy(update={'mass_kg': times * gear.board.mass_kg})
    return build_model(gear.model_copy(update={'board': board}).refined(net=0.25))


def test_a_tow_that_is_fine_needs_none(coarse: GearModel) -> None:
    assert advice(coarse, 500.0, 2.1) is None


def test_remedies_of_an_unstable_tow_are_stable_from_nothing(coarse: GearModel) -> None:
    turned = coarse.with_board(installation=(np.radians(12.0), 0.0, 0.0))
    found = advice(turned, 500.0, 2.1)
    assert found is not None
    assert found.refusal.reason == 'unstable'
    assert found.remedies
    for remedy in found.remedies:
        changed, length = remedy.change.applied(turned, 500.0, remedy.amount)
        steady = steady_state(changed, length, 2.1)
        assert steady.stability.growth == pytest.approx(remedy.growth, rel=0.05)
        # Half as much, the other way round, does not help.
        worse, length = remedy.change.applied(turned, 500.0, -0.5 * remedy.amount)
        with pytest.raises(NoSteadyState):
            steady_state(worse, length, 2.1)
    assert 'one board against' in found.lines[0]
    assert all(any(remedy.what in line for line in found.lines) for remedy in found.remedies)


def test_the_least_speed_is_where_steady_states_end() -> None:
    heavy = with_heavy_boards(2.5)
    found = advice(heavy, 500.0, 1.4)
    assert found is not None
    assert found.refusal.reason == 'collapsed'
    assert found.limit_speed is not None
    near = steady_state(heavy, 500.0, found.limit_speed)
    with pytest.raises(NoSteadyState):
        steady_state(heavy, 500.0, 0.98 * found.limit_speed, start=near.equilibrium)
    assert found.eased is not None
    assert found.eased[1] < 0.95 * found.limit_speed
    assert found.eased[0] in found.lines[-1]


def test_examples_hold() -> None:
    results = doctest.testmod(sys.modules[advice.__module__])
    assert results.attempted > 0
    assert results.failed == 0


def test_gear_that_breaks_the_surface_is_told_its_highest_speed(coarse: GearModel) -> None:
    found = advice(coarse, 200.0, 3.5)
    assert found is not None
    assert found.limit_speed is not None
    assert found.limit_speed < 3.5
    assert any(f'{found.limit_speed:.2f} m/s' in line for line in found.lines)


@pytest.mark.parametrize('name', ['krill_800', 'four_seam', 'pair_368', 'kaifuha'])
def test_changes_are_those_of_the_gear_and_keep_its_nodes(name: str) -> None:
    gear: GearRecord = load_gear(name).refined(net=0.5)
    model = build_model(gear)
    changes = rig_changes(gear)
    told = ' '.join(change.told(change.step) for change in changes)
    assert all(f"'{item.name}'" in told for item in gear.hung)
    assert ('board' in told) == (gear.pair is None)
    for change in changes:
        changed, length = change.applied(model, 100.0, change.step)
        assert changed.nodes == model.nodes
        assert changed.pattern is model.pattern
        assert length != 100.0 or changed is not model


def test_the_command_tells_a_state_or_what_would_help(coarse_gear: Path, tmp_path: Path) -> None:
    data = yaml.safe_load(coarse_gear.read_text())
    data['board']['mass_kg'] *= 3.0
    heavy = tmp_path / 'heavy.yaml'
    heavy.write_text(yaml.safe_dump(data))
    options = ['gear', 'state', str(heavy), '--warp', '500', '--speed']
    usable = CliRunner().invoke(trawl, [*options, '3.0'])
    assert usable.exit_code == 0, usable.output
    assert 'doors ' in usable.stdout
    assert ' kN ' in usable.stdout
    refused = CliRunner().invoke(trawl, [*options, '2.0'])
    assert refused.exit_code == 1
    assert refused.stdout.count(' 2.') >= 2
    assert ': usable' in refused.stdout
