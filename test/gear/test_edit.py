"""Copies of gear files with changed numbers: all else stays as it was written."""

import difflib
from pathlib import Path

import pytest
import yaml

from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import share_path
from trawl_ros.gear.edit import changed_values, edited, write_changed
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.solver.advising.rig_changes import KINDS, changes_of, rig_changes

FLEET = sorted(path.stem for path in share_path('config', 'gear').glob('*.yaml'))


def changed(gear: GearRecord) -> GearRecord:
    """The gear with all that a trim may change changed."""
    for change in rig_changes(gear):
        if change.kind in KINDS:
            gear = change.recorded(gear, 3 * change.step)
    return gear


@pytest.mark.parametrize('name', FLEET)
def test_a_copy_loads_as_the_changed_gear_and_keeps_its_comments(name: str, tmp_path: Path) -> None:
    gear = load_gear(name)
    new = changed(gear)
    out = tmp_path / 'copy.yaml'
    write_changed(name, out, new)
    wanted = changed_values(gear, new)
    assert len(wanted) >= 3
    there = changed_values(gear, load_gear(out))
    for key, value in wanted.items():
        assert there[key] == pytest.approx(value, abs=1e-3 * abs(value) + 1e-3)
    # A plate that weighs more has more inertia, where the file does not give it.
    assert {key[:2] for key in there} - {key[:2] for key in wanted} <= {('board', 'inertia')}
    old = share_path('config', 'gear', f'{name}.yaml').read_text().splitlines()
    lines = list(difflib.ndiff(old, out.read_text().splitlines()))
    gone = [line for line in lines if line.startswith('- ')]
    assert len(gone) <= len(wanted)
    assert sum('#' in line for line in out.read_text().splitlines()) == 1 + sum(
        '#' in line for line in old
    )


def test_a_file_that_is_there_is_not_written_over(tmp_path: Path) -> None:
    out = tmp_path / 'mine.yaml'
    out.write_text('mine')
    with pytest.raises(GearError, match=r'mine\.yaml: found a file'):
        write_changed('krill_800', out, changed(load_gear('krill_800')))
    assert out.read_text() == 'mine'


def test_numbers_keep_their_millimetres_and_millinewtons_however_large(tmp_path: Path) -> None:
    gear = load_gear('krill_800')
    front, *others = gear.hung
    heavy = front.model_copy(update={'weight_in_water_n': 1234567.891})
    out = tmp_path / 'heavy.yaml'
    write_changed('krill_800', out, gear.model_copy(update={'hung': (heavy, *others)}))
    assert load_gear(out).hung[0].weight_in_water_n == 1234567.891


def test_a_gear_that_no_file_may_have_leaves_no_file(tmp_path: Path) -> None:
    gear = load_gear('krill_800')
    light = gear.model_copy(update={'board': gear.board.model_copy(update={'mass_kg': -1.0})})
    out = tmp_path / 'light.yaml'
    with pytest.raises(GearError, match=r'^\S*/light\.yaml: board\.mass_kg: ') as told:
        write_changed('krill_800', out, light)
    assert f'{out}: ' in str(told.value)
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_written_leaves_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr('trawl_ros.gear.edit.edited', lambda text, values: text)
    with pytest.raises(GearError, match=r'copy\.yaml: '):
        write_changed('krill_800', tmp_path / 'copy.yaml', changed(load_gear('krill_800')))
    assert list(tmp_path.iterdir()) == []


def test_numbers_that_are_left_out_are_put_in_block_and_flow_records() -> None:
    text = 'a:\n  b: 1.0  # kept\nc: {d: 2.0}\nf: [1.0, 2.0]\n'
    new = edited(text, {('a', 'e'): 5.0, ('c', 'e'): 6.0, ('f', 1): 3.5})
    assert yaml.safe_load(new) == {
        'a': {'e': 5.0, 'b': 1.0},
        'c': {'e': 6.0, 'd': 2.0},
        'f': [1.0, 3.5],
    }
    assert '# kept' in new
    with pytest.raises(GearError, match=r'g\.h: missing'):
        edited(text, {('g', 'h'): 1.0})


def test_bridles_behind_a_sweep_get_no_place_at_the_board() -> None:
    text = edited('sweep: {length_m: 50.0}\n', {('bridles', 1, 'length_m'): 60.0})
    rows = yaml.safe_load(text)['bridles']
    assert rows == [
        {'name': 'upper', 'at_net': 'upper'},
        {'name': 'lower', 'at_net': 'lower', 'length_m': 60.0},
    ]


def test_what_a_gear_has_not_cannot_be_changed() -> None:
    with pytest.raises(GearError, match="'krill_800' has no clump"):
        changes_of(load_gear('krill_800'), ('clump',))
