"""Boards of a gear file: laws from tables and foils, and what is derived from the plate."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import share_path
from trawl_ros.gear.board_parameters import CORRECTIONS
from trawl_ros.gear.boards import plate_added_mass
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.polars import UPRIGHT, load_door, polar_of
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.board import hydrodynamics
from trawl_ros.model.board_law import LAW_RANGE
from trawl_ros.model.gear_model import build_board

DOORS = sorted(path.stem for path in share_path('config', 'doors').iterdir())
FOIL = {'kind': 'foil', 'max_lift': 1.68, 'stall_deg': 20.0, 'camber': 0.15}


def with_law(folder: Path, law: dict[str, Any], **changes: object) -> GearRecord:
    """The default gear with a law, and without what can be derived."""
    data = yaml.safe_load(share_path('config', 'gear', 'kaifuha.yaml').read_text())
    for key in ('coefficients', 'inertia', 'added_mass_kg'):
        del data['board'][key]
    del data['identification']
    data['board'] |= {'law': law, **changes}
    path = folder / 'own.yaml'
    path.write_text(yaml.safe_dump(data))
    return load_gear(path)


@pytest.mark.parametrize('name', DOORS)
def test_a_door_of_the_catalogue_has_its_published_points(tmp_path: Path, name: str) -> None:
    door = load_door(name)
    assert len(door.source) > 40
    law = build_board(with_law(tmp_path, {'kind': 'table', 'door': name})).law
    assert law is not None
    attack = np.radians([point.attack_deg for point in door.points])
    found = law(np.zeros(12), attack, np.zeros(len(attack)))
    np.testing.assert_allclose(found[:, 0], [point.drag for point in door.points], rtol=1e-12)
    np.testing.assert_allclose(found[:, 1], [point.lift for point in door.points], rtol=1e-12)


def test_a_law_may_replace_the_heel_of_its_door(tmp_path: Path) -> None:
    law = {'kind': 'table', 'door': 'low_aspect_cambered'}
    polar = polar_of(with_law(tmp_path, law).board)
    own = polar_of(with_law(tmp_path, law | {'heel': [{'tilt_deg': 0.0, 'upward': 0.1}]}).board)
    assert polar is not None
    assert own is not None
    np.testing.assert_allclose(np.degrees(np.arcsin(polar.heel.sine)), [0.0, 5.0, 10.0])
    assert polar.heel.upward.tolist() == [0.0, 0.16, 0.25]
    assert own.heel.upward.tolist() == [0.1]
    assert polar.trim is own.trim is UPRIGHT


def test_between_its_points_a_table_has_no_peak_of_its_own(tmp_path: Path) -> None:
    law = build_board(with_law(tmp_path, {'kind': 'table', 'door': 'flat_wooden'})).law
    assert law is not None
    lift = law(np.zeros(12), np.radians(np.linspace(25.0, 45.0, 400)), np.zeros(400))[:, 1]
    assert lift.max() == pytest.approx(0.93, abs=1e-3)
    assert lift.min() == pytest.approx(0.76, abs=1e-3)
    assert np.count_nonzero(np.diff(np.sign(np.diff(lift)))) == 1


@pytest.mark.parametrize(
    'law',
    [
        {'kind': 'table', 'door': 'flat_wooden'},
        {'kind': 'table', 'door': 'low_aspect_cambered'},
        FOIL,
    ],
)
def test_a_law_has_its_derivative_everywhere(tmp_path: Path, law: dict[str, Any]) -> None:
    table = build_board(with_law(tmp_path, law)).law
    assert table is not None
    values = np.array([0.2, 0.01, -0.3, 0.05, -0.3, 0.01, -0.1, 0.02, 0.1, 0.01, 0.2, -0.05])
    attack = np.radians(np.linspace(-88.0, 100.0, 377) + 0.123)
    slip = np.radians(np.linspace(-60.0, 60.0, 377))
    exact = table(values, attack + 1e-30j, slip + 0j).imag / 1e-30
    step = 1e-6
    upper, lower = (table(values, attack + sign * step, slip) for sign in (1, -1))
    np.testing.assert_allclose(exact, (upper - lower) / (2 * step), atol=2e-5)
    # No jumps: neighbouring angles have neighbouring coefficients.
    assert np.abs(np.diff(table(values, attack, 0 * slip), axis=0)).max() < 0.06


def test_a_foil_rises_to_its_stall_and_falls_behind_it(tmp_path: Path) -> None:
    gear = with_law(tmp_path, FOIL)
    polar = polar_of(gear.board)
    assert polar is not None
    top = int(polar.lift.argmax())
    assert np.degrees(polar.attack[top]) == pytest.approx(20.0)
    assert polar.lift[top] == pytest.approx(1.68)
    assert np.all(np.diff(polar.lift[: top + 1]) > 0)
    assert np.all(np.diff(polar.lift[top:]) < 0)
    assert np.all(np.diff(polar.drag) > 0)
    assert build_board(gear).law.range == (0.0, pytest.approx(np.radians(45.0)))
    assert build_board(load_gear('kaifuha')).law.range == LAW_RANGE


def test_the_centre_of_pressure_turns_the_board_as_its_force_does(
    tmp_path: Path, flow_at_twenty: Any
) -> None:
    points = [
        {'attack_deg': 0.0, 'lift': 0.5, 'drag': 0.1, 'ahead_chords': 0.2},
        {'attack_deg': 20.0, 'lift': 1.5, 'drag': 0.4, 'ahead_chords': 0.1},
        {'attack_deg': 40.0, 'lift': 1.0, 'drag': 0.9, 'ahead_chords': -0.1},
    ]
    gear = with_law(tmp_path, {'kind': 'table', 'points': points})
    board = build_board(gear)
    force, moment = hydrodynamics(board, np.zeros(12), flow_at_twenty)
    # Ahead of the centre of gravity by a tenth of the chord, the outward force turns the nose out.
    assert moment[0, 2] == pytest.approx(0.1 * board.chord * force[0, 1], rel=1e-12)


@pytest.mark.parametrize(
    ('key', 'value'), [('force_axes', 'flow'), ('moment_signs', [-1, 1, 1]), ('slip_sign', -1)]
)
def test_keys_of_0_1_are_refused_with_what_to_change(
    tmp_path: Path, key: str, value: object
) -> None:
    with pytest.raises(GearError, match=rf'board: .*found {key}.*trawl trim.*c3, b5, a6 and c6'):
        with_law(tmp_path, FOIL, **{key: value})


def test_what_is_not_given_is_that_of_a_plate(tmp_path: Path) -> None:
    board = with_law(tmp_path, FOIL).board
    assert board.inertia.xx_kg_m2 == pytest.approx(2600.0 / 12 * 5.63**2, rel=1e-3)
    assert board.inertia.zz_kg_m2 == pytest.approx(2600.0 / 12 * 2.13**2, rel=1e-3)
    assert board.added_mass_kg == (0.0, plate_added_mass(5.63, 2.13), 0.0)
    # Strips alone are 20.6 t.
    assert 15e3 < plate_added_mass(5.63, 2.13) < 17e3
    assert not board.coefficients.array().any()


def test_corrections_to_a_law_have_a_prior(tmp_path: Path) -> None:
    assert with_law(tmp_path, FOIL).identification == CORRECTIONS


@pytest.mark.parametrize(
    ('law', 'part'),
    [
        ({'kind': 'table'}, 'board.law: found 0'),
        ({'kind': 'table', 'door': 'nothing_like_it'}, 'no such file'),
        ({'kind': 'foil', 'max_lift': 1.5}, 'stall_deg'),
        (
            {'kind': 'table', 'door': 'flat_wooden', 'heel': [{'tilt_deg': 5.0, 'upward': 0.2}]},
            'board.law.heel: found tilt_deg [5.0]',
        ),
        (FOIL | {'trim': [{'tilt_deg': 0.0, 'upward': 0.0}]}, 'board.law: found door, '),
        ({'kind': 'spline'}, "board.law.kind: found 'spline'"),
        (
            {
                'kind': 'table',
                'points': [
                    {'attack_deg': 20.0, 'lift': 1.0, 'drag': 0.3},
                    {'attack_deg': 10.0, 'lift': 0.5, 'drag': 0.2},
                ],
            },
            '[20.0, 10.0]',
        ),
    ],
)
def test_a_law_that_cannot_be_is_refused(tmp_path: Path, law: dict[str, Any], part: str) -> None:
    with pytest.raises(GearError) as caught:
        build_board(with_law(tmp_path, law))
    assert part in str(caught.value)


def test_straight_lines_need_their_coefficients(tmp_path: Path) -> None:
    data = yaml.safe_load(share_path('config', 'gear', 'kaifuha.yaml').read_text())
    del data['board']['coefficients']
    path = tmp_path / 'own.yaml'
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(GearError, match=r'board\.coefficients: missing'):
        load_gear(path)


@pytest.fixture
def flow_at_twenty() -> Any:
    from trawl_ros.model.board import BoardFlow

    attack = np.radians([20.0])
    flow = 2.0 * np.stack([-np.cos(attack), np.sin(attack), 0 * attack], 1)
    return BoardFlow(attack, 0 * attack, flow, np.array([1025.0]), 0 * attack, 0 * attack)
