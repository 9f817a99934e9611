"""Catch in the codend: its body, its lumps on the net, and the net that it is drawn in."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from trawl_ros.api.gear_check import check_gear, draw_gear
from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import share_path
from trawl_ros.gear.catch import OPEN_SHARE, CatchRecord, catch_body
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.validation.sea.quantities import net_drag
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.trimming.held_boards import rope_pulls

CIRCUMFERENCE = 8.0


@pytest.fixture(scope='module')
def gear() -> GearRecord:
    return load_gear('krill_1600').refined(net=0.4)


def with_catch(gear: GearRecord, **values: float) -> GearRecord:
    return gear.model_copy(update={'catch': CatchRecord.model_validate(values)})


def test_meshes_around_a_catch_open_to_the_angle_of_braided_hoses() -> None:
    angle = np.arcsin(OPEN_SHARE)
    assert np.degrees(angle) == pytest.approx(54.7356, abs=1e-4)
    # Bars bear twice as much around as along, as the wall of a closed tube does.
    assert np.tan(angle) ** 2 == pytest.approx(2.0)


@pytest.mark.parametrize('mass', [50.0, 500.0, 5000.0, 50000.0])
def test_the_body_of_a_catch_has_its_volume_and_no_more_than_the_width_of_the_codend(
    mass: float,
) -> None:
    body = catch_body(CatchRecord(mass_kg=mass), CIRCUMFERENCE)
    straight = body.length - 2 * body.radius
    volume = 4 / 3 * np.pi * body.radius**3 + straight * body.cross_section
    assert volume == pytest.approx(mass / 800.0)
    assert straight >= 0.0
    assert 2 * np.pi * body.radius <= OPEN_SHARE * CIRCUMFERENCE * (1 + 1e-12)


def test_square_meshes_open_no_further_than_their_bars() -> None:
    full = CatchRecord(mass_kg=50000.0)
    square = catch_body(full, CIRCUMFERENCE, square=True)
    assert 2 * np.pi * square.radius == pytest.approx(CIRCUMFERENCE)
    assert square.length < catch_body(full, CIRCUMFERENCE).length


@pytest.mark.parametrize('mass', [100.0, 20000.0])
def test_a_catch_has_its_weight_in_water_wherever_it_lies(gear: GearRecord, mass: float) -> None:
    empty, model = build_model(gear), build_model(with_catch(gear, mass_kg=mass))
    more = model.lump_mass - empty.lump_mass, model.lump_volume - empty.lump_volume
    water = model.water.density
    assert (more[0] - water * more[1]).sum() == pytest.approx(mass * (1 - water / 1050.0))
    assert more[1].sum() == pytest.approx(mass / 800.0)
    codend = model.layout.net[-gear.netting.codend_segments :]
    np.testing.assert_allclose(np.delete(more[0], codend), 0.0, atol=1e-9)
    # It lies at the very end.
    assert more[0][codend[-1]] > 0.0
    assert more[0][codend[0]] == pytest.approx(0.0, abs=1e-9)


def test_an_empty_codend_is_built_as_without_the_key(gear: GearRecord) -> None:
    tiny, empty = build_model(with_catch(gear, mass_kg=1e-9)), build_model(gear)
    np.testing.assert_allclose(tiny.lump_drag_area, empty.lump_drag_area, atol=1e-4)
    assert empty.catch is None


def test_a_catch_that_the_codend_cannot_hold_is_refused(gear: GearRecord) -> None:
    with pytest.raises(GearError, match=r'catch\.mass_kg: found 900000 kg'):
        build_model(with_catch(gear, mass_kg=9e5))
    with pytest.raises(ValidationError, match='mass_kg'):
        CatchRecord(mass_kg=0.0)
    with pytest.raises(ValidationError, match=r'found 1000, .*density_kg_m3, 950'):
        CatchRecord(mass_kg=1.0, density_kg_m3=950.0, bulk_kg_m3=1000.0)


def test_a_catch_adds_its_drag_less_that_of_the_netting_that_it_fills(gear: GearRecord) -> None:
    # Fish as heavy as water: their weight would pull the net into another shape.
    empty = build_model(gear)
    full = build_model(with_catch(gear, mass_kg=20000.0, density_kg_m3=1025.0))
    light, heavy = (steady_state(model, 250.0, 1.08) for model in (empty, full))
    drags = [
        net_drag(
            rope_pulls(model, steady.equilibrium.state, steady.equilibrium.tow),
            steady.equilibrium.tow,
        )
        for model, steady in ((empty, light), (full, heavy))
    ]
    area = (full.lump_drag_area - empty.lump_drag_area).sum()
    assert full.catch is not None
    assert 0.0 < area < 1.4 * full.catch.body.cross_section
    head = 0.5 * full.water.density * 1.08**2
    # The mouth closes a little, so that the rest of the net has less.
    assert 0.75 * head * area < drags[1] - drags[0] < head * area
    assert heavy.observables.net_depth < light.observables.net_depth


def test_a_gear_with_a_catch_is_checked_and_drawn(tmp_path: Path) -> None:
    text = share_path('config', 'gear', 'krill_1600.yaml').read_text(encoding='utf-8')
    file = tmp_path / 'full.yaml'
    file.write_text(f'{text}\ncatch: {{mass_kg: 5000.0}}\n', encoding='utf-8')
    check = check_gear(file)
    assert check.weights['catch'] == pytest.approx(9.80665 * 5000.0 * (1 - 1025 / 1050), rel=1e-3)
    assert check.derived['catch.bulk_kg_m3'] == '800'
    assert all(picture.stat().st_size > 10_000 for picture in draw_gear(check, tmp_path / 'drawn'))
