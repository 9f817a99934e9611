"""Two ships in place of boards in a gear file."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from trawl_ros.api.gear_check import check_gear, drag_of_model
from trawl_ros.core.errors import GearError
from trawl_ros.diagnosis.repair import gear_text
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord


def complaint(folder: Path, source: Path, change: Any) -> str:
    data = yaml.safe_load(source.read_text())
    change(data)
    path = folder / 'own.yaml'
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(GearError) as caught:
        load_gear(path)
    return str(caught.value)


def test_ships_are_as_far_apart_as_the_file_says(pair_gear: GearRecord) -> None:
    assert pair_gear.block_distance == 200.0
    # A plate of 60 kg stands where a board would, which the water does not push.
    assert pair_gear.board.mass_kg == 60.0
    assert not pair_gear.board.coefficients.array().any()


def test_the_record_is_its_own_file(pair_gear: GearRecord) -> None:
    assert GearRecord.model_validate(pair_gear.model_dump()) == pair_gear


def test_boards_beside_a_pair_are_refused(tmp_path: Path, pair_file: Path) -> None:
    def boards(data: Any) -> None:
        data['board'] = load_gear('kaifuha').board.model_dump(mode='json')

    assert 'board: found' in complaint(tmp_path, pair_file, boards)


@pytest.mark.parametrize(
    ('change', 'expected'),
    [
        (lambda d: d['ship'].update(block_spacing_m=7.0), 'ship.block_spacing_m: found 7'),
        (lambda d: d['pair'].update(distance_m=5000.0), 'pair.distance_m: found 5000'),
        (lambda d: d.pop('pair'), 'board: missing'),
    ],
)
def test_what_does_not_fit_a_pair_is_told(
    change: Any, expected: str, tmp_path: Path, pair_file: Path
) -> None:
    assert expected in complaint(tmp_path, pair_file, change)


def test_one_ship_needs_the_spacing_of_its_blocks(tmp_path: Path, pair_file: Path) -> None:
    def alone(data: Any) -> None:
        del data['pair']
        data['board'] = load_gear('krill_800').board.model_dump(mode='json')

    assert 'ship.block_spacing_m: missing' in complaint(tmp_path, pair_file, alone)


def test_it_is_checked_and_its_plates_are_told_by_their_mass(pair_file: Path) -> None:
    check = check_gear(pair_file)
    assert check.findings == ()
    assert check.derived['pair.plate_mass_kg'] == '60'
    assert not any(key.startswith('board') for key in check.derived)
    assert 1000.0 < check.weights['plates'] < 1100.0
    assert drag_of_model(check.model, 2.0) > 0.0


def test_a_repaired_file_loads(tmp_path: Path, pair_file: Path, pair_gear: GearRecord) -> None:
    path = tmp_path / 'again.yaml'
    path.write_text(gear_text(pair_gear))
    assert load_gear(path) == pair_gear
