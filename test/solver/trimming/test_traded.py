"""Trims that may change the rigging where fastening points do not meet a wish."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.advising.rig_changes import changes_of
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.trimming.measured import angles_from
from trawl_ros.solver.trimming.over_range import trim_over_range
from trawl_ros.solver.trimming.traded import trade_for_place, trade_for_range

PLACE = {'warp_length': 400.0, 'speed': 2.1}


@pytest.mark.slow
def test_a_spread_that_boards_alone_do_not_reach_is_met_with_other_bridles(
    model: GearModel,
) -> None:
    near = angles_from(model, spread=195.0, depth=80.0, **PLACE)
    assert not near.met
    assert near.missed.startswith('the spread by -')
    found, traded = trade_for_place(model, changes_of(model.gear, ('bridles',)), near, **PLACE)
    assert found.met
    assert 'longer lower bridles' in traded.told
    # The boards held at the same angles, in the changed gear, from nothing.
    again = angles_from(traded.model(model), spread=195.0, depth=80.0, **PLACE)
    assert again.met


@pytest.mark.slow
def test_what_no_change_reaches_is_told_with_the_nearest(model: GearModel) -> None:
    near = angles_from(model, spread=250.0, depth=80.0, **PLACE)
    found, _ = trade_for_place(model, changes_of(model.gear, ('bridles', 'clump')), near, **PLACE)
    assert not found.met
    assert near.observables.door_spread < found.observables.door_spread < 250.0
    assert 'the spread by -' in found.told()


@pytest.mark.slow
def test_a_range_that_is_not_usable_as_it_is_becomes_so(model: GearModel) -> None:
    wish = {'attack': np.radians(20.0), 'inclination': np.radians(12.0)}
    found = trim_over_range(model, **wish, warp_lengths=(300.0,), speeds=(1.2,))
    better, traded = trade_for_range(model, changes_of(model.gear, ('boards',)), found, **wish)
    assert found.usable < better.usable
    assert 'board' in traded.told


@pytest.mark.parametrize(
    ('options', 'told'),
    [
        (['--warp', '400', '--warps', '300', '600'], '--warps'),
        (['--speed', '1.5', '--speeds', '1.3', '1.7'], '--speeds'),
        (['--free', 'kites'], "found 'kites'"),
    ],
)
def test_options_that_would_be_ignored_are_refused(options: list[str], told: str) -> None:
    wish = ['trim', 'krill_800', '--attack', '20', '--inclination', '10']
    result = CliRunner().invoke(trawl, [*wish, *options])
    assert result.exit_code == 2
    assert told in result.output


def test_a_copy_of_the_gear_file_has_what_was_found(coarse_gear: Path, tmp_path: Path) -> None:
    out = tmp_path / 'trimmed.yaml'
    command = ['trim', str(coarse_gear), '--spread', '195', '--depth', '80', '--warp', '400']
    result = CliRunner().invoke(trawl, [*command, '--free', 'bridles', '--out', str(out)])
    assert '# with ' in result.output, result.output
    assert f'# written: {out}' in result.output
    gear = load_gear(out)
    assert any(bridle.length_m is not None for bridle in gear.bridles)
    if result.exit_code == 0:
        seen = steady_state(build_model(gear), 400.0, 2.1).observables
        assert seen.door_spread == pytest.approx(195.0, rel=0.03)
    again = CliRunner().invoke(trawl, [*command, '--out', str(out)])
    assert again.exit_code == 1
    assert str(out) in again.output
