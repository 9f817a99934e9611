"""A gear file is checked on load: what is wrong is said with file, key, found and expected."""

import pickle
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import share_path
from trawl_ros.diagnosis.repair import gear_text
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord


@pytest.fixture
def data() -> dict[str, Any]:
    return yaml.safe_load(share_path('config', 'gear', 'kaifuha.yaml').read_text())


def complaint(folder: Path, data: dict[str, Any]) -> str:
    path = folder / 'own.yaml'
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(GearError) as caught:
        load_gear(path)
    text = str(caught.value)
    assert text.startswith(f'{path}: ')
    return text.removeprefix(f'{path}: ')


def test_the_gear_that_comes_along_loads_by_name_and_by_path() -> None:
    by_name = load_gear('kaifuha')
    assert by_name.name == 'kaifuha'
    assert load_gear(share_path('config', 'gear', 'kaifuha.yaml')) == by_name


def test_a_gear_of_ones_own_loads_by_path(tmp_path: Path, data: dict[str, Any]) -> None:
    data['name'] = 'own'
    path = tmp_path / 'own.yaml'
    path.write_text(yaml.safe_dump(data))
    assert load_gear(path).name == 'own'


@pytest.mark.parametrize('path', ['no_such_gear', 'no/such/gear.yaml'])
def test_a_missing_file_is_named(path: str) -> None:
    with pytest.raises(GearError, match=rf'^{path}: .*no such file'):
        load_gear(path)


@pytest.mark.parametrize(
    ('key', 'values'),
    [
        ('warp.diameter_m', ['thick', '0.032', True, None, [0.032]]),
        ('clump.weight_in_water_n', [float('nan'), float('inf')]),
        ('netting.around', [6, 20, 12.5]),
        ('headrope.length_m', [-387.0]),
        ('kite.colour', ['orange']),
    ],
)
def test_what_a_key_cannot_be_is_refused(
    tmp_path: Path, data: dict[str, Any], key: str, values: list[object]
) -> None:
    section, name = key.split('.')
    for value in values:
        data[section][name] = value
        assert complaint(tmp_path, data).startswith(f'{key}: ')


def test_a_missing_key_is_named(tmp_path: Path, data: dict[str, Any]) -> None:
    del data['board']['mass_kg']
    assert complaint(tmp_path, data).startswith('board.mass_kg: missing')


def test_a_wrong_unit_is_named_with_the_right_one(tmp_path: Path, data: dict[str, Any]) -> None:
    data['bridle']['length_ft'] = 3.28 * data['bridle'].pop('length_m')
    assert re.match(r'bridle\.length_ft: .*bridle\.length_m', complaint(tmp_path, data))


def test_a_start_value_outside_its_bounds_is_refused(tmp_path: Path, data: dict[str, Any]) -> None:
    record = data['identification']
    record['start'][2] = record['high'][2] + 1.0
    found = complaint(tmp_path, data)
    assert 'identification' in found
    assert 'number 3: ' in found


def test_too_few_start_values_are_refused(tmp_path: Path, data: dict[str, Any]) -> None:
    data['identification']['std'].pop()
    assert 'std: found 11' in complaint(tmp_path, data)


def test_current_depths_must_rise(tmp_path: Path, data: dict[str, Any]) -> None:
    data['water']['current'] = [
        {'depth_m': 50.0, 'east_m_s': 0.1, 'north_m_s': 0.0},
        {'depth_m': 10.0, 'east_m_s': 0.2, 'north_m_s': 0.0},
    ]
    assert '[50.0, 10.0]' in complaint(tmp_path, data)


def test_every_mistake_is_told_at_once(tmp_path: Path, data: dict[str, Any]) -> None:
    data['board']['area_m2'] = 0.0
    data['ship']['block_spacing_m'] = 'wide'
    found = complaint(tmp_path, data)
    assert 'board.area_m2' in found
    assert 'ship.block_spacing_m' in found


def test_refining_multiplies_the_numbers_of_pieces_and_nothing_else() -> None:
    gear = load_gear('kaifuha')
    fine = gear.refined(warp=2, bridle=3, net=2)
    assert fine.warp.segments == 2 * gear.warp.segments
    assert fine.bridle.segments == 3 * gear.bridle.segments
    assert fine.netting.around == 2 * gear.netting.around
    assert fine.netting.codend_segments == 2 * gear.netting.codend_segments
    assert gear.refined() == gear
    assert isinstance(fine, GearRecord)


def test_a_gear_with_effects_can_be_hashed_but_not_changed(
    tmp_path: Path, data: dict[str, Any]
) -> None:
    data['effects'] = [
        {
            'name': 'warp_strumming',
            'values': {'factor': 1.4},
            'provenance': {'found_by': 'trawl diagnose', 'evidence': {'delta_chi2': 91.0}},
        }
    ]
    path = tmp_path / 'gear.yaml'
    path.write_text(yaml.safe_dump(data))
    gear = load_gear(path)
    assert hash(gear) == hash(load_gear(path))
    assert pickle.loads(pickle.dumps(gear)) == gear
    with pytest.raises(TypeError, match='frozen'):
        gear.effects[0].values['factor'] = 2.0
    path.write_text(gear_text(gear))
    assert load_gear(path) == gear


def test_every_value_says_where_it_comes_from() -> None:
    """Beside it, above it, or beside or above the key it stands under."""
    words = ('[paper]', '[source]', '[assumed]', '[derived]', 'refinement')
    told: dict[int, bool] = {}
    above, silent = False, []
    lines = share_path('config', 'gear', 'kaifuha.yaml').read_text().splitlines()
    for line in lines[lines.index('') :]:
        text, _, comment = line.partition('#')
        here = any(word in comment for word in words)
        if not text.strip():
            above = (above or here) and bool(comment)
            continue
        indent = len(text) - len(text.lstrip(' -'))
        told = {depth: known for depth, known in told.items() if depth < indent}
        told[indent] = here or above
        above = False
        if text.partition(':')[2].strip() and not any(told.values()):
            silent.append(line)
    assert silent == []
