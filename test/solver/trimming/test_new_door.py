"""A door of the catalogue on a gear: shackle points are found, or what is needed is said."""

import dataclasses
from pathlib import Path

import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import GearError, NoSteadyState
from trawl_ros.core.resources import share_path
from trawl_ros.gear.door_text import copy_gear
from trawl_ros.gear.findings import findings
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.trim import trim
from trawl_ros.solver.trimming import new_door
from trawl_ros.solver.trimming.new_door import fit_door, gear_with_door


def run(*words: str) -> str:
    done = CliRunner().invoke(trawl, [*words])
    assert done.exit_code == 0, done.output
    return done.output


def coarse(path: Path) -> None:
    path.write_text(path.read_text().replace('around: 48', 'around: 12'))


def test_a_copy_with_another_door_loads_as_a_usable_gear(tmp_path: Path) -> None:
    mine = tmp_path / 'mine.yaml'
    run('gear', 'copy', 'kaifuha', str(mine))
    coarse(mine)
    old = load_gear(mine)
    assert old.name == 'mine'
    place = '--warp', '500', '--speed', '2.1'
    told = run('gear', 'set-door', str(mine), 'low_aspect_cambered', *place)
    new = load_gear(mine)
    assert new.board.law is not None
    assert new.board.law.door == 'low_aspect_cambered'
    assert not new.board.coefficients.array().any()
    assert new.identification.start == (0.0,) * 12
    assert new.board.fastening != old.board.fastening
    assert (new.board.area_m2, new.board.inertia) == (old.board.area_m2, old.board.inertia)
    assert new.netting == old.netting
    assert findings(new) == ()
    found = steady_state(build_model(new), 500.0, 2.1).observables
    now = told.split('now:')[1]
    spread = float(now.split('spread ')[1].split(' m')[0])
    assert found.door_spread == pytest.approx(spread, abs=0.5)
    with pytest.raises(GearError, match=r'mine\.yaml: found a file'):
        copy_gear('kaifuha', mine)


def test_a_larger_plate_grows_in_all_directions(tmp_path: Path) -> None:
    gear = load_gear('kaifuha')
    board = gear_with_door(gear, 'high_lift', 48.0).board
    assert board.span_m == pytest.approx(2 * gear.board.span_m)
    assert board.fastening.warp_m[2] == pytest.approx(2 * gear.board.fastening.warp_m[2])
    assert board.mass_kg == gear.board.mass_kg


def test_a_refused_door_says_what_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    few = dataclasses.replace(new_door.OPTIONS, range_fractions=(0.9,), inclinations_deg=(4.0,))
    monkeypatch.setattr(new_door, 'OPTIONS', few)
    gear = load_gear('kaifuha').refined(net=0.25)
    with pytest.raises(
        NoSteadyState, match=r'times the lift of the old boards; .*plates? of [\d.]+'
    ):
        fit_door(gear, 'high_lift', warp_length=500.0, speed=2.1)


def test_a_wanted_attack_outside_the_law_is_refused_with_both_limits() -> None:
    model = build_model(gear_with_door(load_gear('kaifuha').refined(net=0.25), 'oval_polyvalent'))
    with pytest.raises(NoSteadyState, match='27 to 45°'):
        trim(model, attack=0.35, inclination=0.2, warp_length=500.0, speed=2.1)


def test_a_law_beside_whole_coefficients_is_refused(tmp_path: Path) -> None:
    text = share_path('config', 'gear', 'kaifuha.yaml').read_text()
    both = tmp_path / 'both.yaml'
    both.write_text(
        text.replace('board:\n', 'board:\n  law: {kind: table, door: oval_polyvalent}\n')
    )
    with pytest.raises(GearError, match=r'coefficients\.a2: found 2\.47 with a law'):
        load_gear(both)
    both.write_text(both.read_text().replace('a2: 2.47', 'a2: 1.9'))
    keys = {finding.key for finding in findings(load_gear(both))}
    assert keys == {'board.coefficients', 'identification.start'}
